#!/usr/bin/env bash
# Plays a day as pictures: the sample map from midnight to midnight, the sun by time and place, and
# all of them on one sheet. Installs what is missing and builds. samples/day.sh [FOLDER [YYYY-MM-DD]]
# COUNT=24: so many pictures. SKY=uniform: another sky (terrainlight render --help lists them).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-out/day}
date=${2:-2024-06-20}
count=${COUNT:-24}
sky=(--sky "${SKY:-clear}")
mkdir -p "$out" build

.ci/install_deps.sh
log=build/day-build.log
echo "building (log: $log)"
generator=()
[[ -f build/CMakeCache.txt ]] || generator=(-G Ninja)
if ! { cmake -S . -B build "${generator[@]}" &&
       cmake --build build --parallel "$(nproc)" --target terrainlight osgdb_terrainlight; } \
     >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "samples/day.sh: the build failed; all of it is in $log" >&2
  exit 1
fi

# Midnight where the map lies, 84.25 degrees west: 05:37 UTC by the mean sun.
map=earth_files/jacksboro.earth
light=build/bin/terrainlight
rm -f "$out"/[0-9][0-9]h[0-9][0-9].png # of an earlier run
for ((i = 0; i < count; ++i)); do
  minutes=$(((2 * i + 1) * 1440 / (2 * count)))
  time=$(date -u -d "$date 05:37 UTC + $minutes minutes" +%Y-%m-%dT%H:%MZ)
  picture=$out/$(printf '%02dh%02d' $((minutes / 60)) $((minutes % 60))).png
  echo "$picture: $time"
  "$light" render "$map" "$picture" --time "$time" --size 640,400 --camera 160,30,1 \
    "${sky[@]}" -q
done

# One sheet of six columns: GDAL lays the pictures side by side, since world files say where each one lies.
i=0
pictures=("$out"/[0-9][0-9]h[0-9][0-9].png)
for picture in "${pictures[@]}"; do
  printf '%s\n' 1 0 0 -1 $((i % 6 * 640)).5 $((-(i / 6) * 400)).5 >"${picture%.png}.wld"
  i=$((i + 1))
done
gdalbuildvrt -q "$out/sheet.vrt" "${pictures[@]}"
gdal_translate -q -of PNG -outsize 33.3% 33.3% -r average "$out/sheet.vrt" "$out/sheet.png"
rm -f "${pictures[@]/%.png/.wld}" "$out/sheet.vrt" "$out/sheet.png.aux.xml"
echo
echo "pictures: $out, named by mean solar time; all of them: $out/sheet.png"
