#!/usr/bin/env bash
# Rasters of any size: kills a run ten times with -9, goes on each time, and compares the bytes with
# those of a run that nobody disturbed; then time and peak memory at several sizes of generated
# terrain, and the rate of lighting 2048, 8192 and 32,768 posts a side, the last as a part of a
# mosaic. Usage: any_raster.sh TERRAINLIGHT [FOLDER [SIDE ...]], by default 1000 2000 4000 posts;
# SIDE 0: only the kills and the rates. Needs gdalbuildvrt and 2 GB of disk.
set -euo pipefail
tool=$(realpath "${1:?needs the path of terrainlight}")
work=${2:-$(mktemp -d)}
[[ $# -lt 3 ]] && sides=(1000 2000 4000) || sides=("${@:3}")
mkdir -p "$work"
cd "$work"
export OSGTERRAINLIGHT_CACHE=$PWD/levels
svf=(svf --azimuths 32 --quality normal)

echo "Kills, 1500 x 1500 posts in windows of 256"
"$tool" generate fractal kill.tif --size 1500 --spacing 30 --seed 1 -q
lit=("${svf[@]}" kill.tif)
"$tool" "${lit[@]}" whole.tif --window-size 256 -q 2>/dev/null
RANDOM=14
kills=0
while [[ $kills -lt 10 ]]; do
  rm -f killed.tif # where a run was quicker than its end
  "$tool" "${lit[@]}" killed.tif --window-size 256 >out.txt 2>/dev/null &
  process=$!
  sleep "$((RANDOM % 2)).$((3 + RANDOM % 7))"
  if kill -KILL "$process" 2>/dev/null; then
    kills=$((kills + 1))
  fi
  wait "$process" 2>/dev/null || true
  head -n 1 out.txt
done
"$tool" "${lit[@]}" killed.tif --window-size 256 >out.txt 2>/dev/null
head -n 1 out.txt
cmp whole.tif killed.tif
echo "killed $kills times: equal byte for byte"
[[ $(find . -maxdepth 1 -name '.*windows*' | wc -l) -eq 0 ]]

echo
echo "| posts a side | mode | seconds | peak MiB | million pixel-azimuths/s |"
echo "|---|---|---|---|---|"
for side in "${sides[@]}"; do
  [[ $side -gt 0 ]] || continue
  [[ -e $side.tif ]] || "$tool" generate fractal "$side.tif" --size "$side" --spacing 30 --seed 1 -q
  for way in "" "--memory 600" "--memory 100000"; do
    # In one piece up to a size that the machine surely has memory for.
    [[ $way != "--memory 100000" || $side -le 4000 ]] || continue
    # shellcheck disable=SC2086
    python3 - "$side" "$way" "$tool" "${svf[@]}" "$side.tif" lit.tif -q $way <<'PYTHON'
import resource
import subprocess
import sys
import time

side, way, *command = sys.argv[1:]
start = time.monotonic()
subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
seconds = time.monotonic() - start
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
print(f"| {side} | {way or 'default'} | {seconds:.1f} | {peak:.0f} | "
      f"{int(side) ** 2 * 32 / seconds * 1e-6:.1f} |")
PYTHON
    rm -f lit.tif
  done
done

echo
echo "Rates of light alone, sky-view factor, 32 azimuths:"
[[ -e 8192.tif ]] || "$tool" generate fractal 8192.tif --size 8192 --spacing 30 --seed 1 -q
if [[ ! -e 32768.vrt ]]; then
  tiles=()
  for i in $(seq 0 15); do
    x=$((i % 4 * 245760)) y=$((i / 4 * 245760))
    gdal_translate -q -of VRT -a_ullr $x $((y + 245760)) $((x + 245760)) $y 8192.tif "m$i.vrt"
    tiles+=("m$i.vrt")
  done
  gdalbuildvrt -q 32768.vrt "${tiles[@]}"
fi
rate()
{
  local name=$1
  shift
  rm -f rate.tif
  "$tool" "${svf[@]}" "$@" rate.tif 2>/dev/null | sed -n "s/.*azimuths, \\(.*azimuths.s\\).*/$name: \\1/p"
}
for turn in 1 2 3; do
  rate "2048 posts, whole" 8192.tif -srcwin 3000 3000 2048 2048 --isolated
  rate "2048 posts of 8192" 8192.tif -srcwin 3000 3000 2048 2048
  rate "2048 posts of 32768" 32768.vrt -srcwin 15000 15000 2048 2048
done
rate "8192 posts, whole" 8192.tif
