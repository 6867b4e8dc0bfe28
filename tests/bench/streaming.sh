#!/usr/bin/env bash
# A flight over 16, 256 and 4,096 files of 1024 x 1024 posts, each a raster of its own size (up to 65,536 x 65,536)
# that is paged in and lit on the way: time to the first lit picture, time per frame, memory.
# tests/bench/streaming.sh BUILD [FRAMES]; needs gdal_translate. The files are one generated tile, over and over, in VRTs.
set -euo pipefail
build=$(cd "${1:?needs the build folder}" && pwd)
frames=${2:-300}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$build/bin/terrainlight" generate fractal t0.tif --size 1024 --seed 5 -q
for level in 1 2 3 4 5 6 7 8; do
  gdal_translate -q -r nearest -outsize $((1024 >> level)) $((1024 >> level)) t0.tif "t$level.tif"
done

# vrt NAME COUNT LEVEL [OVERVIEW...]
vrt()
{
  local name=$1 count=$2 level=$3
  shift 3
  awk -v count="$count" -v level="$level" -v overviews="$*" 'BEGIN {
    side = 1024 / 2 ^ level
    printf "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\"><SRS>EPSG:32632</SRS>", side * count, side * count
    printf "<GeoTransform>300000,%d,0,5000000,0,-%d</GeoTransform>", 30 * 2 ^ level, 30 * 2 ^ level
    printf "<VRTRasterBand dataType=\"Float32\" band=\"1\"><UnitType>m</UnitType>"
    for (y = 0; y < count; ++y)
      for (x = 0; x < count; ++x) {
        printf "<SimpleSource><SourceFilename relativeToVRT=\"1\">t%d.tif</SourceFilename><SourceBand>1</SourceBand>", level
        printf "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"%d\" ySize=\"%d\"/>", side, side
        printf "<DstRect xOff=\"%d\" yOff=\"%d\" xSize=\"%d\" ySize=\"%d\"/></SimpleSource>\n", x * side, y * side, side, side
      }
    n = split(overviews, each, " ")
    for (i = 1; i <= n; ++i)
      printf "<Overview><SourceFilename relativeToVRT=\"1\">%s</SourceFilename><SourceBand>1</SourceBand></Overview>", each[i]
    print "</VRTRasterBand></VRTDataset>"
  }' >"$name"
}

for count in 4 16 64; do
  names=()
  for level in 1 2 3 4 5 6 7 8; do
    vrt "o${count}_$level.vrt" "$count" "$level"
    names+=("o${count}_$level.vrt")
  done
  vrt "$count.vrt" "$count" 0 "${names[@]}"
  echo "== $((count * count)) files, $((1024 * count)) x $((1024 * count)) posts"
  LD_LIBRARY_PATH=$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} /usr/bin/time -f "%e s, %U s of processor time, %M KiB" \
    "$build/bin/streaming" "$count.vrt.terrainlight" --headless --frames "$frames" --report "$count.csv"
  awk -F, 'NR > 1 { light[NR] = $3; if ($3 > 60) ++over; if ($4 > most) most = $4; if ($8 > bytes) bytes = $8 }
           END { printf "frames with more than 1.2 times the budget of light: %d of %d; most tiles %d; most memory for light %.0f MiB\n",
                 over, NR - 1, most, bytes / 1048576 }' "$count.csv"
done
