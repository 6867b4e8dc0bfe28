#!/usr/bin/env bash
# Runs the viewers of tests/scene/viewer_program.cpp, whose tiles, levels, edits, objects and clock change while they are
# drawn, in each of osgViewer's threading models under ThreadSanitizer. Fails where it finds a data race, or an order of
# locks that may hang, in code of the library above OSG's own traversals. OpenSceneGraph, GDAL and the OpenGL driver are not compiled for it: what
# they do among themselves is left out (tests/bench/threads.supp). tests/bench/threads.sh FOLDER: where it builds, about
# ten minutes the first time. Needs xvfb-run where there is no display.
set -euo pipefail
folder=$(realpath -m "${1:?needs a folder to build in}")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS=-fsanitize=thread \
  -DOSGTERRAINLIGHT_TESTS=ON >/dev/null
cmake --build "$folder" --target viewer_program >"$folder/threads_build.log"
display=()
[[ -n ${DISPLAY:-} ]] || display=(xvfb-run -a)
failed=0
for model in SingleThreaded CullDrawThreadPerContext DrawThreadPerContext CullThreadPerCameraDrawThreadPerContext; do
  report=$folder/threads_$model
  rm -f "$report".*
  status=0
  TSAN_OPTIONS="halt_on_error=0 history_size=4 suppressions=$PWD/tests/bench/threads.supp log_path=$report" \
    "${display[@]}" "$folder/bin/viewer_program" "$model" 2 >/dev/null 2>&1 || status=$?
  found=$(cat "$report".* 2>/dev/null | grep -c '^SUMMARY: ThreadSanitizer' || true)
  echo "threading model $model: exit status $status, $found reports"
  [[ $status -eq 0 && $found -eq 0 ]] || failed=1
done
exit $failed
