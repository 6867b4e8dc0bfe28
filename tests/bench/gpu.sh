#!/usr/bin/env bash
# What a GPU makes of every stage: checks the plan of docs/PERFORMANCE.md, "On a GPU", in less than an hour. Writes a
# page in Markdown, and what each command printed beside it. Usage: gpu.sh [--quick] [BUILD [RESULTS]]: the build folder
# (build) and a folder for the results (build/gpu). --quick: small sizes only, to see that the script runs. Works
# without a display: set EGL_PLATFORM=surfaceless where there is none.
set -euo pipefail
quick=
if [[ ${1:-} == --quick ]]; then quick=yes; shift; fi
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build}
results=${2:-$build/gpu}
tool=$build/bin/terrainlight
mkdir -p "$results"
rm -f "$results"/*.csv "$results"/*.txt # of an earlier run
page=$results/gpu.md
sizes=(256 512 1024 2048 4096)
[[ -z $quick ]] || sizes=(64 128)

# kept NAME COMMAND...: runs it, keeps what it prints; a failure is told, and the next part goes on.
kept()
{
  local name=$1
  shift
  echo "gpu.sh: $name" >&2
  "$@" >"$results/$name.txt" 2>&1 || { echo "gpu.sh: $name failed: $results/$name.txt" >&2; failed=yes; }
}
# value FILE NAME: the CSV's only row.
value() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next } { print $at[name] }' "$1"; }
failed=

kept info "$tool" info
{
  echo "# Figures of a GPU"
  echo
  sed -n 's/^OpenGL \(renderer\|version\): */- /p' "$results/info.txt"
  echo "Date: $(date -u +%F). Commit: $(git rev-parse --short HEAD 2>/dev/null || echo unknown)."
} >"$page"

# 1. The same light as software OpenGL: all GPU tests, whose expected values are closed forms and the path tracer.
if [[ -z $quick ]]; then
  kept gpu_tests "$build/bin/gpu_tests" --gtest_brief=1
  { echo; echo "## Tests"; echo; echo '```'; tail -n 12 "$results/gpu_tests.txt"; echo '```'; } >>"$page"
fi

# 2. Rates of horizons: the goal is the latency of dependent reads (the hull) against that of neighbours (near field).
if [[ -z $quick ]]; then
  kept rate "$tool" info --rate
  { echo; echo "## Horizons"; echo; echo '```'; grep -E '^(quality|draft|normal|best) ' "$results/rate.txt" || true; echo '```'; } >>"$page"
fi

# 3. How each stage grows with the tile. A stage that fills the GPU takes four times as long per row; one whose
# dispatches are too small, as a sweep of bounces is, about twice.
{
  echo
  echo "## Milliseconds by size"
  echo
  echo "| posts | horizon | sun | 1 bounce | 3 bounces | MiB |"
  echo "|---|---|---|---|---|---|"
} >>"$page"
for size in "${sizes[@]}"; do
  for bounces in 1 3; do
    kept "size_${size}_$bounces" "$tool" bench --generate fractal --size "$size" --posts 0 --azimuths 32 \
      --methods sweep-normal --bounces "$bounces" --sun 315,25 --csv "$results/size_${size}_$bounces.csv" -q
  done
  one=$results/size_${size}_1.csv three=$results/size_${size}_3.csv
  [[ -f $one && -f $three ]] || continue
  echo "| $size² | $(value "$one" gpu_horizon_ms) | $(value "$one" gpu_sun_ms) | $(value "$one" gpu_bounce_ms) | $(
    value "$three" gpu_bounce_ms) | $(awk -v b="$(value "$three" memory_bytes)" 'BEGIN { printf "%.1f", b / 1048576 }') |" >>"$page"
done

# 4. Every stage alone, at several sizes.
if [[ -z $quick ]]; then
  kept stages "$build/bin/terrainlight_benchmarks" --benchmark_min_time=0.2
  { echo; echo "## Stages"; echo; echo '```'; grep -E '/' "$results/stages.txt" || true; echo '```'; } >>"$page"
fi
echo "$page"
[[ -z $failed ]]
