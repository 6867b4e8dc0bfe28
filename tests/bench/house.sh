#!/usr/bin/env bash
# Counts the house, as tables in Markdown for docs/measurements: longest functions, longest files, edges between
# packages, and files that a commit touched. Usage: house.sh [COMMIT[=TITLE] ...], a commit for each kind of change,
# such as house.sh abc123="a setting". Files of tests and documents are counted apart.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

echo "Written by \`tests/bench/house.sh\`, commit $(git rev-parse --short HEAD)."
python3 - <<'PYTHON'
import re
import subprocess
from collections import Counter

names = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split("\n")
sources = [n for n in names if re.search(r"\.(h|cpp|glsl|comp|vert|frag)$", n)]
texts = {}
for name in sources:
    with open(name, encoding="utf-8") as file:
        texts[name] = file.read().split("\n")


def part(name):
    return "tests" if name.startswith("tests/") else "shaders" if name.startswith("shaders/") else "code"


def functions(lines):
    """(lines, first line) of each function: from a brace alone in its column to the one that closes it there."""
    indents = {}
    for number, line in enumerate(lines, 1):
        brace = re.fullmatch(r"( *)([{}]);?", line)
        if not brace:
            continue
        if brace[2] == "{":
            head = number - 1
            while head > 1 and re.match(r" {%d}\s" % len(brace[1]), lines[head - 1]):
                head -= 1
            indents[brace[1]] = (number, head)
        elif brace[1] in indents:
            start, head = indents.pop(brace[1])
            title = lines[head - 1].strip()
            if re.match(r"(for|while|if|switch|else|do|catch|try)\b", title) or "[" in title.split("(")[0]:
                continue
            if "(" in " ".join(lines[head - 1:start - 1]) and not re.match(r"(namespace|struct|class|enum|union)\b", title):
                yield number - start + 1, head, title


print("\n## Longest functions\n\nFrom brace to brace, with both.\n\n| part | lines | function | place |\n|---|---|---|---|")
found = {"code": [], "shaders": [], "tests": []}
for name, lines in texts.items():
    found[part(name)] += [(length, name, line, title) for length, line, title in functions(lines)]
for title, rows in found.items():
    rows.sort(reverse=True)
    for length, name, line, head in rows[:5]:
        print(f"| {title} | {length} | `{head.split('(')[0]}` | `{name}:{line}` |")
for title, rows in found.items():
    print(f"\nAbove 80 lines in {title}: {sum(row[0] > 80 for row in rows)} of {len(rows)}.")

print("\n## Longest files\n\n| part | lines | file |\n|---|---|---|")
for title in found:
    rows = sorted(((len(lines) - 1, name) for name, lines in texts.items() if part(name) == title), reverse=True)
    for length, name in rows[:5]:
        print(f"| {title} | {length} | `{name}` |")


def package(name):
    parts = name.split("/")
    if parts[:2] == ["plugin", "src"]:
        return parts[2]
    if parts[:2] == ["plugin", "include"]:
        return "public"
    if parts[:2] == ["tools", "reference"]:
        return "reference"
    return parts[0]


print("\n## Include edges\n\nHow many files of a package (row) include a file of another (column).\n")
edges, packages = Counter(), set()
for name, lines in texts.items():
    if not name.endswith((".h", ".cpp")) or name.startswith("tests/"):
        continue
    targets = set()
    for line in lines:
        include = re.match(r'\s*#\s*include\s+["<]([^">]+)[">]', line)
        if not include:
            continue
        path = include[1]
        for candidate in (f"plugin/src/{path}", f"plugin/include/{path}", f"tools/{path}", f"shaders/{path}"):
            if candidate in texts:
                targets.add(package(candidate))
    packages.add(package(name))
    for target in targets - {package(name)}:
        edges[package(name), target] += 1
columns = sorted({target for _, target in edges})
print("| | " + " | ".join(columns) + " |\n|---|" + "---|" * len(columns))
for row in sorted(packages):
    print(f"| {row} | " + " | ".join(str(edges[row, column] or "") for column in columns) + " |")
PYTHON

[[ $# -gt 0 ]] || exit 0
printf '\n## Files touched by a change\n\n| change | commit | code and shaders | tests | documents and scripts |\n|---|---|---|---|---|\n'
for change in "$@"; do
  commit=${change%%=*} title=${change#*=}
  [[ $change == *=* ]] || title=$(git log -1 --format=%s "$commit")
  files=$(git show --format= --name-only "$commit")
  tests=$(grep -c '^tests/' <<<"$files" || true)
  code=$(grep -c -E '^(plugin|shaders|tools|samples)/' <<<"$files" || true)
  all=$(grep -c . <<<"$files" || true)
  echo "| $title | $(git rev-parse --short "$commit") | $code | $tests | $((all - tests - code)) |"
done
