#!/usr/bin/env bash
# Builds with warnings as errors and tests everything; .ci/run is this and no more. Arguments go to
# ctest: tests/run.sh -R horizon. Logs are in build/. The last line: N passed, N failed, N skipped;
# the exit status is 0 only where none failed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
exec </dev/null # nothing here may wait for an answer
root=$PWD
mkdir -p build

passed=0 failed=0 skipped=0

# step NAME COMMAND...: quiet where it works; else the errors, and the end of the log.
step()
{
  local name=$1 log=$root/build/$1.log start=$SECONDS
  shift
  if "$@" >"$log" 2>&1; then
    echo "$name: ok, $((SECONDS - start)) s"
    return 0
  fi
  failed=$((failed + 1))
  echo "======== $name FAILED ========"
  if [[ $(wc -l <"$log") -gt 60 ]]; then # the first errors are often above the end
    grep -E -m 20 '(error|Error|FAILED):' "$log" || true
    echo "-------- end of build/$name.log --------"
  fi
  tail -n 60 "$log"
  echo "======== $name FAILED ========"
  return 1
}

# check NAME COMMAND...: a step that counts as one test.
check() { if step "$@"; then passed=$((passed + 1)); fi; }

# build NAME FOLDER [TARGET...] -- CMAKE_ARGUMENT...
build()
{
  local name=$1 folder=$2 targets=() generator=()
  shift 2
  while [[ $1 != -- ]]; do targets+=("$1"); shift; done
  shift
  [[ -f $folder/CMakeCache.txt ]] || generator=(-G Ninja) # keep what a developer chose
  step "$name-configure" cmake -S . -B "$folder" "${generator[@]}" \
    -DOSGTERRAINLIGHT_TESTS=ON -DOSGTERRAINLIGHT_WERROR=ON "$@" || return 1
  step "$name-build" cmake --build "$folder" --parallel "$(nproc)" \
    ${targets:+--target "${targets[@]}"}
}

# run_ctest NAME FOLDER CTEST_ARGUMENT...: adds to the counts what the JUnit file says.
run_ctest()
{
  local name=$1 folder=$2 status=0 start=$SECONDS counts
  shift 2
  local junit=$root/build/$name.xml
  rm -f "$junit"
  ctest --test-dir "$folder" -j2 --output-on-failure --output-junit "$junit" "$@" \
    >"build/$name.log" 2>&1 || status=$?
  ctest --test-dir "$folder" --show-only=json-v1 >"build/$name.json" 2>/dev/null || true
  counts=$(python3 - "$junit" "$root/build/$name.json" "$status" "${CI:-}" <<'PYTHON'
import json
import os
import sys
import xml.etree.ElementTree as ElementTree

junit, listing, status, ci = sys.argv[1:]


def say(text):
    print(text, file=sys.stderr)


def of_gpu(test):
    return any(p["name"] == "LABELS" and "gpu" in p["value"] for p in test.get("properties", []))


cases = ElementTree.parse(junit).getroot().findall("testcase") if os.path.isfile(junit) else []
gpu = set()
if os.path.getsize(listing):
    with open(listing, encoding="utf-8") as file:
        gpu = {test["name"] for test in json.load(file)["tests"] if of_gpu(test)}
passed, failed, skipped = [], [], []
for case in cases:
    reason = case.find("skipped")
    # A program that is not there is "notrun" too: only what a test says of itself is a skip.
    skip = case.get("status") == "disabled" or (
        reason is not None and reason.get("message", "").startswith("SKIP_"))
    (passed if case.get("status") == "run" else skipped if skip else failed).append(case)

for case in failed[:20]:
    say(f"-------- FAILED {case.get('name')}, {float(case.get('time')):.1f} s --------")
    lines = case.findtext("system-out", "").strip().split("\n")
    say("\n".join(lines if len(lines) <= 60 else lines[:30] + ["[...]"] + lines[-30:]))
for case in failed:
    say(f"FAILED {case.get('name')}")
count = len(failed)
if int(status) and not failed:
    count = 1
    say(f"FAILED: ctest ended with status {status} and names no failed test")

gpu_cases = {case.get("name") for case in cases} & gpu
gpu_skipped = {case.get("name") for case in skipped} & gpu
if gpu_cases and gpu_cases == gpu_skipped:
    say("All tests labelled gpu were skipped: no OpenGL 4.3 context here.")
    if ci:
        count += 1
        say("FAILED: CI needs a context; Mesa's software OpenGL will do.")
print(len(passed), count, len(skipped))
PYTHON
) || counts="0 1 0"
  local p f s
  read -r p f s <<<"$counts"
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  if [[ $f -gt 0 ]]; then
    # Where ctest itself went wrong there is no test to show.
    [[ $((p + s)) -gt 0 ]] || tail -n 40 "build/$name.log"
    echo "======== $name: $f FAILED; all output is in build/$name.log ========"
  else
    echo "$name: $p passed, $s skipped, $((SECONDS - start)) s"
  fi
}

# Sanitizers, with assertions on, over what needs no GL: drivers are not clean under them.
sanitize()
{
  local programs=() folder labels
  for folder in core io reference glsl; do
    ! compgen -G "tests/$folder/*_test.cpp" >/dev/null || programs+=("$folder")
  done
  [[ ${#programs[@]} -gt 0 ]] || return 0
  build sanitize build-sanitize "${programs[@]/%/_tests}" environment_fuzz -- -DOSGTERRAINLIGHT_SANITIZE=ON \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g -D_GLIBCXX_ASSERTIONS" || return 0
  labels=$(IFS='|'; echo "${programs[*]}|fuzz")
  ASAN_OPTIONS=print_legend=0 UBSAN_OPTIONS=print_stacktrace=1 \
    run_ctest sanitize-ctest build-sanitize --no-tests=ignore "$@" -L "^($labels)\$"
}

step dependencies .ci/install_deps.sh || true # where they do not suffice, the build says so
if build all build -- -DCMAKE_BUILD_TYPE=RelWithDebInfo -DOSGTERRAINLIGHT_SANITIZE=OFF; then
  run_ctest ctest build --no-tests=error "$@"
  sanitize "$@"
fi
check lint .ci/lint.sh
check lint-self-test .ci/lint.sh --self-test
check includes .ci/check_includes.py
check includes-self-test .ci/check_includes.py --self-test

echo "$passed passed, $failed failed, $skipped skipped"
[[ $failed -eq 0 ]]
