#!/usr/bin/env bash
# Usage: run.sh BUILD_FOLDER [CMAKE [COMPILER]]. Installs the build below itself, then configures,
# builds and runs consumer/ against that prefix alone.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(realpath "$1")
cmake=${2:-cmake}
compiler=${3:-c++}
work=$build/package-test
prefix=$work/prefix

fail() { echo "package: $*" >&2; exit 1; }

rm -rf "$work"
"$cmake" --install "$build" --prefix "$prefix" >/dev/null

plugins=("$prefix"/lib*/osgPlugins-*/osgdb_terrainlight.so)
[[ -f ${plugins[0]} ]] || plugins=("$prefix"/lib*/*/osgPlugins-*/osgdb_terrainlight.so)
[[ -f ${plugins[0]} ]] || fail "the plugin is not where OSG looks for it"
strangers=$(find "$prefix/include" -type f ! -path "$prefix/include/osgTerrainLight/*.h")
[[ -z $strangers ]] || fail "installed besides the public headers: $strangers"
# A path of the folder that built it would break the package once that folder is gone.
if grep -r -F -l -e "$build/" --include='*.cmake' "$prefix"; then
  fail "the package names its build folder"
fi

libraries=("$prefix"/lib*/libosgTerrainLight.so "$prefix"/lib*/*/libosgTerrainLight.so)
for library in "${libraries[@]}"; do
  [[ ! -f $library ]] || "$here/check_exports.py" "$library" "$prefix/include"
done

"$cmake" -S "$here/consumer" -B "$work/consumer" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
"$cmake" --build "$work/consumer" --parallel 2
"$work/consumer/consumer"
