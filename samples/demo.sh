#!/usr/bin/env bash
# Installs what is missing, builds, lights a real DEM and leaves pictures and GeoTIFFs in out/demo.
# Opens osgviewer where there is a display. samples/demo.sh [FOLDER]: pictures go to FOLDER.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-out/demo}
mkdir -p "$out" build

.ci/install_deps.sh
log=build/demo-build.log
echo "building (log: $log)"
generator=()
[[ -f build/CMakeCache.txt ]] || generator=(-G Ninja)
if ! { cmake -S . -B build "${generator[@]}" &&
       cmake --build build --parallel "$(nproc)" --target terrainlight osgdb_terrainlight; } \
     >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "samples/demo.sh: the build failed; all of it is in $log" >&2
  exit 1
fi

dem=samples/data/jacksboro_90m.tif
light=build/bin/terrainlight
run() { echo "terrainlight $*"; "$light" "$@"; }
run info "$dem"
run svf "$dem" "$out/sky_view.tif"
run horizon "$dem" "$out/horizons.tif" --azimuths 16 -co COMPRESS=DEFLATE
run shadow "$dem" "$out/shadow.tif" --sun 120,12
run shade "$dem" "$out/shading.tif" --sun 315,35
run shade "$dem" "$out/morning.png" --sun 95,14 -co WORLDFILE=YES
run render earth_files/jacksboro.earth "$out/valley.png" --size 1280,720 --sun 300,18
run render "$dem" "$out/map.png" --top --size 1000,1000 --sun 315,30 --exposure -0.3
run generate fractal "$out/fractal.tif" --size 1024 --seed 4
run shade "$out/fractal.tif" "$out/fractal.png" --sun 315,20 --quality best --exposure -0.3

echo
echo "pictures and GeoTIFFs: $out"
ls -1 "$out"
if [[ -n ${DISPLAY:-} ]] && command -v osgviewer >/dev/null; then
  echo "opening osgviewer: press h for its keys"
  LD_LIBRARY_PATH=$PWD/build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} \
    osgviewer --window 50 50 1280 720 "$dem.terrainlight"
fi
