#!/usr/bin/env bash
# Writes docs/BOUNCES.md and its pictures: time of one bounce against its error, from runs of `terrainlight
# bench`. Usage: bounces.sh [TERRAINLIGHT [RESULTS]]: the program to measure, and a folder for its CSV and
# pictures. What RESULTS holds already is not measured again: remove it to do so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tool=${1:-build/bin/terrainlight}
results=${2:-build/bounces}
mkdir -p "$results" docs/images
document=docs/BOUNCES.md
measured=()

# measure NAME TITLE ARGUMENT...: one terrain.
measure()
{
  local name=$1 title=$2 files=$results/$1
  shift 2
  if [[ ! -f $files.svg ]]; then
    echo "measuring $name"
    "$tool" bench "$@" --bounces 1 --sun 315,25 --azimuths 16,32,64 --posts 2000 --paths 65536 --repeats 2 \
      --methods sweep-draft,sweep-normal,sweep-best,subsampled-2,subsampled-4,legendre \
      --csv "$files.csv" --plot "$files.svg" -q >"$files.txt"
  fi
  cp "$files.svg" "docs/images/bounces_$name.svg"
  measured+=("$name:$title")
}
measure fractal "Generated fractal, 30 m" --generate fractal --size 128
measure crater "Generated crater, 30 m" --generate crater --size 128

fact() { sed -n "s/^$1: *//p" "$results/fractal.txt"; }
{
  cat <<'MARKDOWN'
# Bounces: speed against error

One bounce of sky and sun, albedo 0.5: time of everything against the error of the bounce, as `terrainlight bench` measures it with the path
tracer as truth. `sweep-…` are the three qualities by exact slices, `subsampled-2` and `subsampled-4` the default with far terrain looked at from every second and fourth post, `legendre` the scheme of
Nowrouzezahrai and Snyder 2009, whole (direct light, too), in the quality `normal`, which is finer than its own k = 4, o = 2. `*` marks the
Pareto front. `legendre` alone is the front before; [ARCHITECTURE](ARCHITECTURE.md) has the steps between. Written by `tests/bench/bounces.sh`.

MARKDOWN
  echo "Device: $(fact Device). Processor: $(nproc) cores of $(
    sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1). Date: $(
    sed -n '/^terrainlight/s/.*, \(....-..-..\)T.*/\1/p' "$results/fractal.txt"). Sun: $(fact Sun)."
  [[ $(fact Device) != *"(software)"* ]] ||
    echo "The GPU is a program here: read times as ratios within one table, not as what a GPU takes."
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
