#!/usr/bin/env bash
# Do two programs compute the same light? Usage: same_light.sh OLD_TOOL NEW_TOOL [FOLDER]. Makes a set of
# scenes with both and compares every value: a line per scene, equal to the last bit or how many values differ
# by how many half-float steps (light is stored in half floats). The exit status is 0 only where all are equal.
# --steps N: differences of up to N half-float steps are allowed, and pictures may differ by N grey levels.
# --only WORD: only scenes whose name contains it. FOLDER, by default build/same_light, keeps terrains and results.
set -euo pipefail
steps=0 only=
while [[ ${1:-} == --* ]]; do
  case $1 in
    --steps) steps=$2 ;;
    --only) only=$2 ;;
    *) sed -n '2,/^set/{/^set/d;s/^# //;p}' "$0" >&2; exit 2 ;;
  esac
  shift 2
done
[[ $# -ge 2 ]] || { sed -n '2,/^set/{/^set/d;s/^# //;p}' "$0" >&2; exit 2; }
old=$(realpath "$1") new=$(realpath "$2")
folder=${3:-$(dirname "${BASH_SOURCE[0]}")/../../build/same_light}
mkdir -p "$folder"
cd "$folder"
mkdir -p old new terrains

# Terrains by OLD alone, so that both light the same heights.
terrain() { [[ -f terrains/$1.tif ]] || "$old" generate "${@:2}" "terrains/$1.tif" -q; }
terrain fractal fractal --size 128
terrain crater crater --size 128 --spacing 10
terrain cliffs cliffs --size 97,61 --spacing 10 --seed 7
terrain spikes spikes --size 64,200
terrain row fractal --size 50,1
# A square of voids, a single one and a column of them.
if [[ ! -f terrains/voids.tif ]]; then
  gdal_translate -q -of ENVI terrains/fractal.tif terrains/voids.raw
  python3 - terrains/voids.raw <<'PYTHON'
import array
import sys

heights = array.array("f")
with open(sys.argv[1], "rb") as file:
    heights.frombytes(file.read())
for row in range(128):
    for column in range(128):
        if (40 <= row < 60 and 30 <= column < 50) or (row, column) == (100, 90) or column == 110:
            heights[row * 128 + column] = -9999.0
with open(sys.argv[1], "wb") as file:
    heights.tofile(file)
PYTHON
  gdal_translate -q -a_nodata -9999 terrains/voids.raw terrains/voids.tif
fi
[[ -f terrains/utm.tif ]] ||
  gdal_translate -q -a_srs EPSG:32632 -a_ullr 400000 5103840 403840 5100000 terrains/fractal.tif terrains/utm.tif
[[ -f terrains/degrees.tif ]] || # a second of arc between posts, 60 degrees north
  gdal_translate -q -a_srs EPSG:4326 -a_ullr 7 60.0355556 7.0355556 60 terrains/fractal.tif terrains/degrees.tif
# An albedo per post: heights of another terrain, stretched to bytes.
[[ -f terrains/albedo.tif ]] || { terrain other fractal --size 128 --seed 3
  gdal_translate -q -ot Byte -a_nodata none -scale terrains/other.tif terrains/albedo.tif; }
# A panorama of 64 x 32 in Radiance's format without compression: a sky that is bluer above, warm ground, and a
# bright sun of one pixel.
if [[ ! -f terrains/panorama.hdr ]]; then
  python3 - terrains/panorama.hdr <<'PYTHON'
import math
import sys


def rgbe(colour):
    mantissa, exponent = math.frexp(max(colour))
    scale = mantissa * 256.0 / max(colour)
    return bytes([int(value * scale) for value in colour] + [exponent + 128])


with open(sys.argv[1], "wb") as file:
    file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 64\n")
    for row in range(32):
        for column in range(64):
            up = 1.0 - row / 16.0
            sky = (0.3 - 0.1 * up, 0.3, 0.3 + 0.3 * up) if row < 16 else (0.12, 0.1, 0.08)
            file.write(rgbe((4000.0, 3800.0, 3400.0) if (row, column) == (10, 50) else sky))
PYTHON
fi
blender=/usr/share/blender/datafiles/studiolights/world/sunset.exr

# compare NAME: how results of the two programs differ.
compare()
{
  python3 - "$steps" "old/$1.raw" "new/$1.raw" <<'PYTHON'
import re
import struct
import sys

allowed, before, after = int(sys.argv[1]), sys.argv[2], sys.argv[3]
contents, headers = [], []
for name in (before, after):
    with open(name, "rb") as file:
        contents.append(file.read())
    with open(re.sub("raw$", "hdr", name), encoding="utf-8") as file:
        headers.append({key: value for key, value in re.findall(r"^([a-z ]+?) *= *(\d+)", file.read(), re.M)})
shape = [[header[key] for key in ("samples", "lines", "bands", "data type")] for header in headers]
if shape[0] != shape[1] or len(contents[0]) != len(contents[1]):
    print(f"differs in size or type: {' x '.join(shape[0])} and {' x '.join(shape[1])}")
    sys.exit(1)
if contents[0] == contents[1]:
    print(f"equal, {len(contents[0])} bytes")
    sys.exit(0)
floats = shape[0][3] == "4"
count = len(contents[0]) // (4 if floats else 1)
values = [struct.unpack(f"<{count}f", content) if floats else content for content in contents]


def code(value):
    """Place of a value among all half floats in order; NaN: after all."""
    if value != value:
        return 1 << 16
    bits = struct.unpack("<H", struct.pack("<e", max(-65504.0, min(65504.0, value))))[0]
    return bits if bits < 0x8000 else 0x8000 - bits


differ, most, worst = 0, 0, 0.0
for a, b in zip(*values):
    if a == b or (a != a and b != b):
        continue
    differ += 1
    most = max(most, abs(code(a) - code(b)) if floats else abs(a - b))
    worst = max(worst, abs(a - b)) if a == a and b == b else float("inf")
unit = "half-float steps" if floats else "grey levels"
print(f"differs: {differ} of {count} values, by up to {most} {unit}, {worst:.3g}")
sys.exit(0 if most <= allowed else 1)
PYTHON
}

same=0 different=0
# scene NAME MODE TERRAIN ARGUMENT...
scene()
{
  local name=$1 mode=$2 terrain=$3 which said
  shift 3
  [[ -z $only || $name == *"$only"* ]] || return 0
  for which in old new; do
    if ! "${!which}" "$mode" "$terrain" "$which/$name.raw" -of ENVI -q "$@" 2>"$which/$name.log"; then
      printf '%-28s %s fails: %s\n' "$name" "$which" "$(tail -n 1 "$which/$name.log")"
      different=$((different + 1))
      return 0
    fi
  done
  if said=$(compare "$name"); then same=$((same + 1)); else different=$((different + 1)); fi
  printf '%-28s %s\n' "$name" "$said"
}
shade() { scene "$1" shade "terrains/$2" "${@:3}"; }
sun=(--sun 300,25)
key=(--key-light 300,30,20,50,6,4,2 --key-light 100,180,-5,40,0.2,0.3,0.5)
harmonics=(--sky-harmonics 1,0.1,0.3,-0.2,0.05,0.02,0.1,-0.03,0.04)

shade sky fractal.tif --no-sun
shade sun fractal.tif --sky none "${sun[@]}"
shade sky-and-sun fractal.tif "${sun[@]}"
shade clear-sky fractal.tif --sky clear "${sun[@]}"
shade overcast-sky fractal.tif --sky overcast "${sun[@]}"
shade sky-harmonics fractal.tif --no-sun "${harmonics[@]}"
shade key-lights fractal.tif --no-sun --sky none "${key[@]}"
shade all-lights crater.tif "${sun[@]}" "${key[@]}"
shade panorama fractal.tif --sky terrains/panorama.hdr --sky-heading 40
shade panorama-bounces fractal.tif --sky terrains/panorama.hdr --bounces 1
[[ ! -f $blender ]] || shade panorama-blender fractal.tif --sky "$blender" --bounces 1
for bounces in 1 3; do
  shade "bounces-$bounces" fractal.tif "${sun[@]}" --bounces "$bounces"
  shade "bounces-$bounces-legendre" fractal.tif "${sun[@]}" --bounces "$bounces" --bounce-method legendre
done
shade bounces-key-lights crater.tif "${sun[@]}" "${key[@]}" --bounces 2 --albedo 0.7,0.5,0.3
shade bounces-harmonics crater.tif --no-sun "${harmonics[@]}" --bounces 1
for subsampling in 2 4; do
  shade "subsampled-$subsampling-legendre" fractal.tif "${sun[@]}" --bounces 1 --subsampling "$subsampling" \
    --bounce-method legendre
done
shade legendre-bspline crater.tif "${sun[@]}" --bounces 1 --bounce-method legendre-bspline
shade legendre-key-lights crater.tif "${key[@]}" --bounces 1 --bounce-method legendre
shade non-square cliffs.tif "${sun[@]}" --bounces 2
shade non-square-legendre cliffs.tif "${sun[@]}" --bounces 1 --bounce-method legendre
shade tall spikes.tif "${sun[@]}" --bounces 1
shade one-row row.tif "${sun[@]}" --bounces 1
shade voids voids.tif "${sun[@]}" --bounces 2
shade voids-legendre voids.tif "${sun[@]}" --bounces 1 --bounce-method legendre
shade utm utm.tif --time 2024-06-21T15:00Z --sky clear --bounces 1
shade degrees degrees.tif "${sun[@]}" --bounces 2
shade curved fractal.tif "${sun[@]}" --body-radius 60000 --bounces 1
for quality in draft best; do
  shade "$quality" crater.tif "${sun[@]}" --quality "$quality" --bounces 1
done
shade many-azimuths fractal.tif "${sun[@]}" --azimuths 64 --bounces 1
shade albedo-of-a-raster fractal.tif "${sun[@]}" --bounces 1 --albedo terrains/albedo.tif
scene horizons horizon terrains/crater.tif --azimuths 16
scene sky-view svf terrains/voids.tif
scene shadow shadow terrains/crater.tif "${sun[@]}"
render() { scene "$1" render "terrains/$2" --size 160,120 "${@:3}"; }
render picture fractal.tif "${sun[@]}" --bounces 1
render gloss fractal.tif "${sun[@]}" --gloss 0.4
render gloss-bounces crater.tif "${sun[@]}" --gloss 0.4 --gloss-exponent 32 --bounces 2
render gloss-scalar crater.tif "${sun[@]}" --gloss 0.4 --gloss-transfer scalar --bounces 1
render gloss-panorama crater.tif --sky terrains/panorama.hdr --gloss 0.4

echo "$same equal$([[ $steps -eq 0 ]] || echo " within $steps steps"), $different not"
[[ $different -eq 0 && $same -gt 0 ]]
