#!/usr/bin/env bash
# Writes docs/measurements/BOUNCES.md and its pictures: time of one bounce against its error, from runs of `terrainlight
# bench`. Usage: bounces.sh [TERRAINLIGHT [RESULTS]]: the program to measure, and a folder for its CSV and
# pictures. What RESULTS holds already is not measured again: remove it to do so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tool=${1:-build/bin/terrainlight}
results=${2:-build/bounces}
mkdir -p "$results" docs/measurements/images
document=docs/measurements/BOUNCES.md
measured=()

# measure NAME TITLE ARGUMENT...: one terrain.
measure()
{
  local name=$1 title=$2 files=$results/$1
  shift 2
  if [[ ! -f $files.svg ]]; then
    echo "measuring $name"
    "$tool" bench "$@" --bounces 1 --sun 315,25 --azimuths 16,32,64 --posts 2000 --paths 65536 --repeats 2 \
      --methods sweep-draft,sweep-normal,sweep-best,legendre \
      --csv "$files.csv" --plot "$files.svg" -q >"$files.txt"
  fi
  cp "$files.svg" "docs/measurements/images/bounces_$name.svg"
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
