#!/usr/bin/env bash
# Writes docs/measurements/SPEED_AGAINST_ERROR.md and its pictures from runs of `terrainlight bench`.
# Usage: speed_against_error.sh [TERRAINLIGHT [RESULTS]]: the program to measure, and a folder for its
# CSV, JSON and pictures. What RESULTS holds already is not measured again: remove it to do so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tool=${1:-build/bin/terrainlight}
results=${2:-build/speed_against_error}
dems=../shared/data/dem
sun=315,15
mkdir -p "$results" docs/measurements/images
document=docs/measurements/SPEED_AGAINST_ERROR.md

measured=()

# measure NAME TITLE ARGUMENT...: one terrain.
measure()
{
  local name=$1 title=$2 files=$results/$1
  shift 2
  if [[ ! -f $files.svg ]]; then
    echo "measuring $name"
    "$tool" bench "$@" --sun "$sun" --repeats 3 --csv "$files.csv" --json "$files.json" \
      --plot "$files.svg" >"$files.txt"
  fi
  cp "$files.svg" "docs/measurements/images/speed_against_error_$name.svg"
  measured+=("$name:$title")
}

measure jacksboro "Jacksboro, 90 m (hills)" samples/data/jacksboro_90m.tif
[[ ! -f $dems/halfdome_1s.tif ]] ||
  measure halfdome "Half Dome and Yosemite Valley, 30 m (cliffs of 900 m)" \
    "$dems/halfdome_1s.tif" -srcwin 300 200 512 512
[[ ! -f $dems/mt_rainier_90m.tif ]] ||
  measure rainier "Mount Rainier, 90 m" "$dems/mt_rainier_90m.tif" -srcwin 32 0 512 512
measure fractal "Generated fractal, 30 m" --generate fractal --size 512
measure cliffs "Generated cliffs, walls and one-post spikes, 30 m" --generate cliffs --size 512

# table CSV: the columns that matter for a choice; * on the front of that error.
table()
{
  awk -F, '
    NR == 1 {
      for (i = 1; i <= NF; ++i) column[$i] = i
      print "| method | azimuths | GPU ms | MiB | horizon, mean ° | horizon, p99 ° | sky, relative RMS | sun, RMS | light, relative RMS |"
      print "|---|---|---|---|---|---|---|---|---|"
      next
    }
    function value(name) { return $column[name] }
    function star(name) { return value(name "_front") == 1 ? " *" : "" }
    {
      printf "| `%s` | %s | %.0f | %.0f | %.4f%s | %.3f | %.4f %%%s | %.4f%s | %.3f %%%s |\n",
        value("method"), value("azimuths"), value("gpu_ms"), value("memory_bytes") / 1048576,
        value("horizon_mean_deg"), star("horizon"), value("horizon_p99_deg"),
        100 * value("sky_relative_rms"), star("sky"), value("sun_rms_fraction"), star("sun"),
        100 * value("light_relative_rms"), star("light")
    }' "$1"
}

# fact KEY: a line of the head that every run prints.
fact() { sed -n "s/^$1: *//p" "$results/jacksboro.txt"; }

{
  cat <<'MARKDOWN'
# Speed against error

This page is written by `tests/bench/speed_against_error.sh`. It has the time and the error of each method and number of azimuths, as
`terrainlight bench` measures them. [TOOL](../TOOL.md#bench) explains the columns. `*` marks the Pareto front of GPU time against that error.

MARKDOWN
  echo "Device: $(fact Device). Processor: $(nproc) cores of $(
    sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1). Date: $(
    sed -n '/^terrainlight/s/.*, \(....-..-..\)T.*/\1/p' "$results/jacksboro.txt")."
  echo "Sun: $(fact Sun). Times: $(fact Times). Reference: $(fact Reference)."
  [[ $(fact Device) != *"(software)"* ]] ||
    echo "This is software OpenGL. Read times as ratios within one table, not as the times of a GPU."
  cat <<'MARKDOWN'
Errors do not depend on the machine, except for its rounding.

## What to choose

**More azimuths make the sky more exact. A higher quality makes horizons and shadows more exact. Neither replaces the other.** On
mountains, the error of the sky-view factor is 0.5 to 0.7 % with 8 azimuths, 0.2 % with 16, 0.06 % with 32 and 0.025 % with 64. It falls to
about a third with each doubling, and it is the same for all three qualities. The cheapest good sky is therefore many azimuths with `draft`.
The error of the horizons themselves depends on the quality. With few azimuths it only seems smaller, because these lie on axes and
diagonals, which are easiest. Time is proportional to the number of azimuths. `normal` takes 15 to 45 % more time than `draft`. The
difference is largest with few azimuths, because of the sun's finer horizon. `best` takes 2 to 2.5 times as long as `draft`.

**In the light that one sees, the sun limits `draft`, and the sky limits `normal`.** With `draft`, a few posts on the wrong side of a
shadow's edge keep the error of the shading at 0.1 % on hills and 0.3 % on mountains, whatever the number of azimuths. With `normal` the error
continues to fall: it is 0.04 to 0.15 % with 16 azimuths and 0.02 to 0.11 % with 32, the default. `best` removes up to half of that at nearly
twice the time; use it for horizon maps and cliffs. Start with `normal` and 16 azimuths, and use `draft` with 8 while something moves. On
cliffs, walls and one-post spikes the error of the shading is 0.65 % with 16 azimuths and 0.4 % with 32. The last 0.02 % is the rounding of the
shading texture's 16-bit floats, and no setting changes it. A lower sun makes more shadows and so a greater error; a plain has a smaller one.
Measure your own terrain and machine with `terrainlight bench`, or let `--max-error` and `--max-ms` choose.

MARKDOWN
  for entry in "${measured[@]}"; do
    name=${entry%%:*}
    echo "## ${entry#*:}"
    echo
    echo "$(sed -n 's/^Terrain: *//p' "$results/$name.txt")."
    echo
    echo "![GPU time against error, ${entry#*:}](images/speed_against_error_$name.svg)"
    echo
    table "$results/$name.csv"
    echo
  done
} | sed '$ d' >"$document"
echo "wrote $document"
