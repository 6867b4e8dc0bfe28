#!/usr/bin/env bash
# Builds with warnings as errors and tests everything; .ci/run is this and no more. With --quick: builds what
# changed, runs the tests that take less than a second each, and lints. Other arguments go to ctest:
# tests/run.sh -R gpu.Horizon. Logs are in build/, the time of each test in build/test_results/times.txt. The last
# line: N passed, N failed, N skipped; the exit status is 0 only where none failed.
set -euo pipefail
quick=
if [[ ${1:-} == --quick ]]; then
  quick=yes
  export OTL_QUICK=1 # tests/Suites.cmake.in leaves out tests/slow_tests.txt
  shift
fi
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
    -DOSGTERRAINLIGHT_TOOLS=ON -DOSGTERRAINLIGHT_TESTS=ON -DOSGTERRAINLIGHT_WERROR=ON "$@" || return 1
  step "$name-build" cmake --build "$folder" --parallel "$(nproc)" \
    ${targets:+--target "${targets[@]}"}
}

# run_ctest NAME FOLDER CTEST_ARGUMENT...: adds to the counts what gtest's files and ctest's say.
run_ctest()
{
  local name=$1 folder=$2 status=0 start=$SECONDS counts
  shift 2
  local junit=$root/build/$name.xml results=$root/$folder/test_results
  rm -rf "$junit" "$results"
  mkdir -p "$results"
  # Software OpenGL takes all cores for each context: two tests at a time share them.
  LP_NUM_THREADS=${LP_NUM_THREADS:-$(((($(nproc) + 1)) / 2))} \
    ctest --test-dir "$folder" -j2 --output-on-failure --output-junit "$junit" "$@" \
    >"build/$name.log" 2>&1 || status=$?
  counts=$(tests/count_results.py "$junit" "$results" "$status" "${CI:-}") || counts="0 1 0"
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
  for folder in core io fields reference glsl; do
    ! compgen -G "tests/$folder/*_test.cpp" >/dev/null || programs+=("$folder")
  done
  [[ ${#programs[@]} -gt 0 ]] || return 0
  build sanitize build-sanitize "${programs[@]/%/_tests}" environment_fuzz map_fuzz -- -DOSGTERRAINLIGHT_SANITIZE=ON \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1 -D_GLIBCXX_ASSERTIONS" || return 0
  labels=$(IFS='|'; echo "${programs[*]}|fuzz")
  ASAN_OPTIONS=print_legend=0 UBSAN_OPTIONS=print_stacktrace=1 \
    run_ctest sanitize-ctest build-sanitize --no-tests=ignore "$@" -L "^($labels)\$"
}

step dependencies .ci/install_deps.sh || true # where they do not suffice, the build says so
# -O1: a third less to compile than -O2, and tests that take about as long.
if build all build -- -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" \
  -DOSGTERRAINLIGHT_SANITIZE=OFF; then
  if [[ -n $quick ]]; then
    run_ctest ctest build --no-tests=error -LE '^(fuzz|package)$' "$@"
  else
    run_ctest ctest build --no-tests=error "$@"
    sanitize "$@"
  fi
fi
check lint .ci/lint.sh
check includes .ci/check_includes.py
if [[ -z $quick ]]; then
  check lint-self-test .ci/lint.sh --self-test
  check includes-self-test .ci/check_includes.py --self-test
  check count-self-test tests/count_results.py --self-test
fi

echo "$passed passed, $failed failed, $skipped skipped"
[[ $failed -eq 0 ]]
