#!/usr/bin/env bash
# Flies in and out over paged terrain 200 times and prints what the program holds afterwards: OpenGL textures and buffers,
# memory of light on the graphics card, resident memory. Fails where one of them grows by more than 2 % between cycle 20
# and cycle 200. tests/bench/paging_cycles.sh BUILD; it takes some minutes with software OpenGL.
set -euo pipefail
build=${1:?needs the build folder}
"$build/bin/scene_tests" --gtest_also_run_disabled_tests --gtest_filter='PagedTerrain.DISABLED_CyclesLeaveNothing'
