#!/usr/bin/env bash
# Format, columns of shaders, file names, the dialect of shaders/lib, shell scripts, links between
# documents. Usage: lint.sh [ROOT], or lint.sh --self-test, which plants a fault per rule and must
# find each.
set -euo pipefail
self=$(realpath "${BASH_SOURCE[0]}")

self_test()
{
  root=$(mktemp -d)
  trap 'rm -rf "$root"' EXIT
  mkdir -p "$root"/{shaders/lib,plugin/src/core,tests/core}
  cp "$(dirname "$self")/../.clang-format" "$root"
  cat >"$root/shaders/lib/good.glsl" <<'GLSL'
// A double uniform float in a comment, v.xyz too, is fine.
struct Pair { real x; real y; };
real good(vec2 v, Pair flat_pair) { Pair p; p.x = v.x + real(1.5); return p.x * v.y; }
GLSL
  printf 'int main()\n{\n    return 0;\n}\n' >"$root/tests/core/good_test.cpp"
  echo '#include "good.glsl"' >"$root/shaders/lib/all.glsl"
  cat >"$root/good.md" <<'MARKDOWN'
# A page: `code` and dashes - twice
[itself](#a-page-code-and-dashes---twice), [a file](shaders/lib/good.glsl)
[elsewhere](https://example.org/no.md#x)
`[not a link](no.md)`
```
[nor this](no.md)
```
MARKDOWN
  "$self" "$root" || { echo "lint --self-test: faults found in a good tree"; exit 1; }

  cat >"$root/shaders/lib/BadName.glsl" <<'GLSL'
#include "lib/good.glsl"
#define HALF 0.5
uniform real u;
layout(std430) buffer B { real b; };
shared real s;
float f(float x) { return x; }
void g(out real x, inout real y) { barrier(); }
real h(vec4 v) { return dFdx(v.xy.x) + double(gl_FragCoord.x) + v.rgb.r; }
struct Ray { real a; };
Ray r() { return Ray(real(1)); }
real a() { return real[2](real(1), real(2))[0]; }
GLSL
  printf '//%099d\n' 0 >>"$root/shaders/lib/BadName.glsl"
  printf 'int  main( ){}\n' >"$root/plugin/src/core/bad_format.cpp"
  printf 'int camel;\n' >"$root/tests/core/Camel_test.cpp"
  printf '#!/usr/bin/env bash\nif true\n' >"$root/tests/broken.sh"
  printf '[a](no.md)\n![b](no.png)\n[c](good.md#none), [d](#none)\n' >"$root/bad.md"
  if "$self" "$root" >"$root/out" 2>&1; then
    echo "lint --self-test: the bad tree passed"
    exit 1
  fi
  local status=0 fault
  for fault in 'lib/BadName.glsl: .*snake_case' BadName.glsl:{1:.*include,2:.*define,3:.*uniform} \
    BadName.glsl:{4:.*layout,4:.*buffer,5:.*shared,6:.*float,7:.*\'out\',7:.*inout,7:.*barrier} \
    BadName.glsl:{8:.*dFdx,8:.*double,8:.*gl_FragCoord,8:.*\\.xy,8:.*\\.rgb,10:.*Ray,11:.*array,12:.*101\ columns} \
    'bad_format.cpp: .*PascalCase' 'bad_format.cpp:1:.*clang-format' \
    'bad.md:1: .*no.md' 'bad.md:2: .*no.png' 'bad.md:3: .*good.md#none' "bad.md:3: '#none" \
    'Camel_test.cpp: .*snake_case' 'broken.sh: .*run bit' 'broken.sh: line [0-9]*: syntax error'; do
    if ! grep -q -e "$fault" "$root/out"; then
      echo "lint --self-test: planted and not found: $fault"
      status=1
    fi
  done
  [[ $status -eq 0 ]] || cat "$root/out"
  exit "$status"
}

[[ ${1:-} != --self-test ]] || self_test
cd "${1:-$(dirname "$self")/..}"

if [[ -e .git ]]; then
  mapfile -d '' files < <(git ls-files -z)
else # an unpacked archive
  mapfile -d '' files < <(find . -path './build*' -prune -o -type f -printf '%P\0')
fi
[[ ${#files[@]} -gt 0 ]] || { echo "lint: no files below $PWD"; exit 1; }
sources=()
scripts=()
for file in "${files[@]}"; do
  [[ -f $file ]] || continue # tracked, and deleted here
  case $file in
    *.h | *.cpp) sources+=("$file") ;;
    *.sh | .ci/*) scripts+=("$file") ;;
  esac
done
status=0

if [[ ${#sources[@]} -gt 0 ]]; then
  clang-format --dry-run -Werror "${sources[@]}" || status=1
fi

for script in "${scripts[@]}"; do
  [[ -x $script ]] || { echo "$script: needs its run bit"; status=1; }
  [[ $(head -n 1 "$script") != *bash ]] || bash -n "$script" || status=1
done

python3 - "${files[@]}" <<'PYTHON' || status=1
import re
import sys
from pathlib import Path

status = 0


def complain(where, sentence):
    global status
    status = 1
    print(f"{where}: {sentence}")


# Words that the shared GLSL/C++ dialect leaves out, and why.
FORBIDDEN = [
    (r"\b(float|double)\b", "the dialect says real"),
    (r"\b(out|inout)\b", "return a struct"),
    (r"\b(uniform|layout|buffer|shared|varying|attribute)\b", "belongs in passes/"),
    (r"\bgl_\w+", "belongs in passes/"),
    (r"\b(barrier|memoryBarrier\w*|groupMemoryBarrier)\b", "belongs in passes/"),
    (r"\b(dFd[xy]|fwidth)(Fine|Coarse)?\b", "derivatives belong in passes/"),
    (r"(?<![\w.])[A-Za-z_]\w*(?:\.\w+|\[[^\]]*\])*(\.(?:[xyzw]{2,4}|[rgba]{2,4}|[stpq]{2,4}))\b",
     "no swizzles"),
    (r"\)(\.(?:[xyzw]{2,4}|[rgba]{2,4}|[stpq]{2,4}))\b", "no swizzles"),
    (r"\b\w+\s*\[\s*\w*\s*\]\s*\(", "no array constructors"),
    (r"^\s*#\s*include\b", "the order of composition is all.glsl"),
    (r"^\s*#\s*define\b", "the two macros are the preamble's"),
]


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), text, flags=re.S)


files = [Path(name) for name in sys.argv[1:] if Path(name).is_file()]
library = {file: without_comments(file.read_text()) for file in files
           if file.parts[:2] == ("shaders", "lib") and file.suffix == ".glsl"
           and file.name != "all.glsl"}
structs = {name for text in library.values() for name in re.findall(r"\bstruct\s+(\w+)", text)}
rules = FORBIDDEN + [(rf"\b{name}\s*\(", "no struct constructors") for name in sorted(structs)]
for file, text in library.items():
    for number, line in enumerate(text.split("\n"), 1):
        for pattern, reason in rules:
            for match in re.finditer(pattern, line):
                complain(f"{file}:{number}", f"'{match[0].strip()}': {reason}")

for file in files:
    if file.parts[0] == "shaders" and file.suffix in (".glsl", ".comp", ".vert", ".frag"):
        for number, line in enumerate(file.read_text().split("\n"), 1):
            if len(line) > 100:
                complain(f"{file}:{number}", f"{len(line)} columns, at most 100")

for file in files:
    if file.parts[0] in ("plugin", "tools", "samples") and file.suffix in (".h", ".cpp"):
        if not re.fullmatch(r"[A-Z][A-Za-z0-9]*", file.stem) and file.name != "main.cpp":
            complain(file, "file name should be PascalCase, after its type")
    elif file.parts[0] in ("shaders", "tests"):
        # A test's helper may be named after its type.
        helper = file.parts[0] == "tests" and not file.stem.endswith("_test")
        name = r"[a-z0-9]+(_[a-z0-9]+)*" + (r"|[A-Z][A-Za-z0-9]*" if helper else "")
        if file.suffix in (".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"):
            if not re.fullmatch(name, file.stem):
                complain(file, "file name should be snake_case")


def anchors(text):
    """What GitHub makes of the headings: lower case, no punctuation, blanks to hyphens."""
    prose = re.sub(r"^ *```.*?^ *```", "", text, flags=re.S | re.M)
    headings = re.findall(r"^#+ +(.*?) *$", prose, re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


for file in files:
    if file.suffix != ".md":
        continue
    text = file.read_text()
    prose = re.sub(r"^ *```.*?^ *```|`[^`\n]*`", lambda m: "\n" * m[0].count("\n"), text,
                   flags=re.S | re.M)
    for number, line in enumerate(prose.split("\n"), 1):
        for target in re.findall(r"\]\(([^)\s]+)\)", line):
            path, _, anchor = target.partition("#")
            if re.match(r"\w+:", target):
                continue  # elsewhere
            page = file.parent / path if path else file
            if not page.exists():
                complain(f"{file}:{number}", f"'{target}': no such file")
            elif anchor and anchor not in anchors(page.read_text()):
                complain(f"{file}:{number}", f"'{target}': no such heading")
sys.exit(status)
PYTHON
exit "$status"
