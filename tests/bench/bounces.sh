#!/usr/bin/env bash
# Writes docs/measurements/BOUNCES.md and its pictures: time of one bounce against its error, from runs of `terrainlight
# bench`. Usage: bounces.sh [TERRAINLIGHT [RESULTS [BEFORE]]]: the program to measure, a folder for its CSV and
# pictures, and a former program: its fronts are drawn beside the new ones. What RESULTS holds already is not measured
# again: remove it to do so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tool=${1:-build/bin/terrainlight}
results=${2:-build/bounces}
before=${3:-}
mkdir -p "$results" docs/measurements/images
document=docs/measurements/BOUNCES.md
measured=()

# run PROGRAM FILES METHODS ARGUMENT...: where it has not run yet.
run()
{
  local program=$1 files=$2 methods=$3
  shift 3
  [[ ! -f $files.svg ]] || return 0
  echo "measuring $files"
  "$program" bench "$@" --bounces 1 --sun 315,25 --azimuths 16,32,64 --posts 2000 --paths 65536 --repeats 2 \
    --methods "$methods" --csv "$files.csv" --plot "$files.svg" -q >"$files.txt"
}

# series CSV: of each quality, time of the bounce [ms] and its error [%].
series()
{
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    $column["method"] != last && NR > 2 { print "\n" }
    { last = $column["method"]
      print $column["gpu_bounce_ms"], 100 * $column["indirect_relative_rms"], last }' "$1"
}

# compare NAME TITLE: both fronts in one picture.
compare()
{
  local name=$1
  series "$results/${name}_before.csv" >"$results/$name.old.dat"
  series "$results/$name.sweeps.csv" >"$results/$name.new.dat"
  gnuplot <<GNUPLOT
set terminal svg size 720,480
set output "docs/measurements/images/bounces_${name}_before.svg"
set title "$2: one bounce, 16, 32 and 64 azimuths"
set logscale xy
set xlabel "milliseconds of the bounce"
set ylabel "relative RMS error of the bounce [%]"
set key bottom left
plot for [i=0:2] "$results/$name.old.dat" index i with linespoints lc "gray40" pt i + 4 dt 2 \
       title "gather, before: ".word("draft normal best", i + 1), \
     for [i=0:2] "$results/$name.new.dat" index i with linespoints lc "dark-orange" pt i + 4 \
       title "line sweep: ".word("draft normal best", i + 1)
GNUPLOT
}

# measure NAME TITLE ARGUMENT...: one terrain.
measure()
{
  local name=$1 title=$2 sweeps=sweep-draft,sweep-normal,sweep-best
  shift 2
  run "$tool" "$results/$name" "$sweeps,legendre" "$@"
  cp "$results/$name.svg" "docs/measurements/images/bounces_$name.svg"
  if [[ -n $before ]]; then
    run "$before" "$results/${name}_before" "$sweeps" "$@"
    grep -v '^legendre' "$results/$name.csv" >"$results/$name.sweeps.csv"
    compare "$name" "$title"
  fi
  measured+=("$name:$title")
}
measure fractal "Generated fractal, 30 m" --generate fractal --size 128
measure crater "Generated crater, 30 m" --generate crater --size 128

fact() { sed -n "s/^$1: *//p" "$results/fractal.txt"; }
{
  cat <<'MARKDOWN'
# Bounces: speed against error

This page is written by `tests/bench/bounces.sh`. It has one bounce of sky and sun with albedo 0.5. Time is that of all stages. The error is
that of the bounce, as `terrainlight bench` measures it against the path tracer. [The method](../methods/bounces.md) has its own page.

- `sweep-draft`, `sweep-normal` and `sweep-best` are the three qualities of the default method (exact slices).
- `legendre` is the scheme of Nowrouzezahrai and Snyder 2009 for all light, direct light too, in the quality `normal`. This is finer than the
  paper's own k = 4, o = 2.
- `*` marks the Pareto front.

MARKDOWN
  echo "Device: $(fact Device). Processor: $(nproc) cores of $(
    sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1). Date: $(
    sed -n '/^terrainlight/s/.*, \(....-..-..\)T.*/\1/p' "$results/fractal.txt"). Sun: $(fact Sun)."
  [[ $(fact Device) != *"(software)"* ]] ||
    echo "This is software OpenGL. Read times as ratios within one table, not as the times of a GPU."
  for entry in "${measured[@]}"; do
    name=${entry%%:*}
    printf '\n## %s\n\n![Time against error](images/bounces_%s.svg)\n\n' "${entry#*:}" "$name"
    [[ ! -f docs/measurements/images/bounces_${name}_before.svg ]] || printf '%s\n\n' \
      "![The same beside the gather that the line sweep replaced](images/bounces_${name}_before.svg)"
    awk -F, '
      NR == 1 {
        for (i = 1; i <= NF; ++i) column[$i] = i
        print "| method | azimuths | GPU ms | of it bounce | MiB | bounce, relative RMS | noise of the truth |"
        print "|---|---|---|---|---|---|---|"
        next
      }
      function value(name) { return $column[name] }
      {
        printf "| `%s` | %s | %.0f | %.0f | %.1f | %.2f %%%s | %.2f %% |\n", value("method"), value("azimuths"),
          value("gpu_ms"), value("gpu_bounce_ms"), value("memory_bytes") / 1048576,
          100 * value("indirect_relative_rms"), value("indirect_front") == 1 ? " *" : "",
          100 * value("indirect_relative_noise")
      }' "$results/$name.csv"
  done
} >"$document"
echo "wrote $document"
