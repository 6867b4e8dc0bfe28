#!/usr/bin/env bash
# What each configuration builds and leaves out. Usage: configurations.sh BUILD_FOLDER [CMAKE [COMPILER]]. By
# hand, configurations.sh --build BUILD_FOLDER also builds each of them, and with clang as well, which takes
# as long as the first build did.
set -euo pipefail
build_too=
[[ ${1:-} != --build ]] || { build_too=yes; shift; }
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$here/../..
work=$(realpath "$1")/configurations
cmake=${2:-cmake}
compiler=${3:-c++}
rm -rf "$work"
mkdir -p "$work"

fail() { echo "configurations: $*" >&2; exit 1; }

# configure NAME SOURCE ARGUMENT...
configure()
{
  local name=$1 source=$2
  shift 2
  "$cmake" -S "$source" -B "$work/$name" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release "$@" \
    >"$work/$name.log" 2>&1 || { tail -n 30 "$work/$name.log"; fail "$name: does not configure"; }
  "$cmake" --build "$work/$name" --target help >"$work/$name.targets"
}

has() { grep -q -E "(^|[ /])$2([ :]|\$)" "$work/$1.targets" || fail "$1: has no target $2"; }
hasNot() { ! grep -q -E "(^|[ /])$2([ :]|\$)" "$work/$1.targets" || fail "$1: has a target $2"; }
# flag NAME FLAG: is our code compiled with it?
flag() { grep -q -e " $2 .*plugin/src/core" "$work/$1/compile_commands.json"; }
build() { [[ -z $build_too ]] || "$cmake" --build "$work/$1" --parallel "$(nproc)"; }

# What somebody gets who builds the project as it is: everything, and a warning stays a warning.
configure users "$root"
for target in osgTerrainLight terrainlight minimal core_tests gpu_tests; do has users "$target"; done
! flag users -Werror || fail "users: -Werror without being asked for"
configure gate "$root" -DOSGTERRAINLIGHT_WERROR=ON
flag gate -Werror || fail "gate: no -Werror"
flag gate -Wall || fail "gate: no -Wall"

# A subdirectory of another project: the library, its plugins and nothing else.
configure subdirectory "$here/subdirectory" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
for target in osgTerrainLight osgdb_terrainlight consumer; do has subdirectory "$target"; done
for target in terrainlight minimal dynamic otl_reference otl_test_support core_tests terrainlight_benchmarks; do
  hasNot subdirectory "$target"
done
build subdirectory

# Without Embree: the tool and all tests but those that trace paths, which are named.
configure without-embree "$root" -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON -DOSGTERRAINLIGHT_WERROR=ON
for target in osgTerrainLight terrainlight core_tests fields_tests glsl_tests gpu_tests tool_tests hard_cases_tests; do
  has without-embree "$target"
done
grep -q 'Tests left out, since they need Embree 3: .*path_tracer_test.cpp' "$work/without-embree.log" ||
  fail "without-embree: does not say which tests are left out"
! grep -q -e 'tools/Bench' -e 'PathTracer' "$work/without-embree/compile_commands.json" ||
  fail "without-embree: builds what needs Embree"
build without-embree

# Another compiler has other warnings; none that it does not know may be passed to it.
if command -v clang++ >/dev/null; then
  compiler=clang++
  configure clang "$root"
  flag clang -Wall || fail "clang: no -Wall"
  build clang
fi
echo "configurations: all as they should be"
