#!/usr/bin/env bash
# Are two programs equally fast, and do they take as much memory? Usage: same_speed.sh [--size N] [--rounds N]
# [--within PERCENT] OLD_TOOL NEW_TOOL [FOLDER]. Runs both in turn, ROUNDS times (3) each: horizons of `info --rate`, and
# all light with 1 and 3 bounces by the default, on a generated fractal of SIZE x SIZE posts (512). Prints a
# table in Markdown with medians and their ratio: milliseconds of the GPU, and seconds of the processor, which say
# more with software OpenGL on a shared machine; then memory by stage. The exit status is 1 where a ratio of
# milliseconds is above 1 + PERCENT / 100 (3).
set -euo pipefail
size=512 rounds=3 within=3
while [[ ${1:-} == --* ]]; do
  case $1 in
    --size) size=$2 ;;
    --rounds) rounds=$2 ;;
    --within) within=$2 ;;
    *) sed -n '2,/^set/{/^set/d;s/^# //;p}' "$0" >&2; exit 2 ;;
  esac
  shift 2
done
[[ $# -ge 2 ]] || { sed -n '2,/^set/{/^set/d;s/^# //;p}' "$0" >&2; exit 2; }
old=$(realpath "$1") new=$(realpath "$2")
folder=${3:-$(dirname "${BASH_SOURCE[0]}")/../../build/same_speed}
mkdir -p "$folder"
cd "$folder"
rm -f old.* new.*
"$old" generate fractal terrain.tif --size "$size" -q

# timed WHICH NAME COMMAND...: appends seconds of the processor, user and system.
timed()
{
  local which=$1 name=$2 TIMEFORMAT='%U %S'
  shift 2
  { time "$@" >"$which.out" 2>"$which.err" || { cat "$which.err" >&3; exit 1; }; } 3>&2 2>"$which.time"
  awk '{ print $1 + $2 }' "$which.time" >>"$which.$name.cpu"
}

# column FILE NAME: of a CSV's only row.
column() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next } { print $at[name] }' "$1"; }

for ((round = 0; round < rounds; ++round)); do
  for which in old new; do
    timed $which rate "${!which}" info terrain.tif --rate
    for quality in draft normal best; do
      awk -v quality="$quality" '$1 == quality { print $2 }' $which.out >>"$which.horizons-$quality.gpu"
    done
    for bounces in 1 3; do
      timed $which "bounces-$bounces" "${!which}" bench terrain.tif --methods sweep-normal --azimuths 32 --posts 0 \
        --repeats 1 --bounces "$bounces" -q --csv $which.csv
      column $which.csv gpu_ms >>"$which.bounces-$bounces.gpu"
      column $which.csv memory_bytes >"$which.bounces-$bounces.bytes"
    done
  done
done

median() { sort -n "$1" | awk '{ value[NR] = $1 } END { print (value[int((NR + 1) / 2)] + value[int(NR / 2) + 1]) / 2 }'; }
status=0
# row TITLE FILE: medians of old and new, and new over old.
row()
{
  local a b
  a=$(median "old.$2") b=$(median "new.$2")
  awk -v title="$1" -v a="$a" -v b="$b" \
    'BEGIN { printf "| %s | %.4g | %.4g | %.3f |\n", title, a, b, (a > 0 ? b / a : 1) }'
  [[ $2 != *.gpu ]] || awk -v a="$a" -v b="$b" -v within="$within" 'BEGIN { exit b > a * (1 + within / 100) }' || status=1
}
echo "$size x $size posts, 32 azimuths, quality normal, median of $rounds rounds in turn"
echo
echo "| | old | new | new / old |"
echo "|---|---|---|---|"
for quality in draft normal best; do row "horizons, $quality, ms" "horizons-$quality.gpu"; done
row "info --rate, processor s" rate.cpu
for bounces in 1 3; do
  row "all light, bounces $bounces, ms" "bounces-$bounces.gpu"
  row "all light, bounces $bounces, processor s" "bounces-$bounces.cpu"
  row "all light, bounces $bounces, bytes" "bounces-$bounces.bytes"
done
for which in old new; do "${!which}" info terrain.tif 2>/dev/null | awk -F': *' -v OFS='\t' '/MiB$/ { sub(/ MiB/, "", $2); print $1, $2 }' \
  >"$which.memory"; done
# Stages that only one of the two has stand there, too.
awk -F'\t' 'NR == FNR { old[$1] = $2; order[++n] = $1; next } { if (!($1 in old)) order[++n] = $1; new[$1] = $2 }
  END { for (i = 1; i <= n; ++i) { k = order[i]
    printf "| memory: %s, MiB | %s | %s | %s |\n", k, (k in old ? old[k] : "–"), (k in new ? new[k] : "–"),
      ((k in old) && (k in new) && old[k] > 0 ? sprintf("%.3f", new[k] / old[k]) : "–") } }' old.memory new.memory
exit "$status"
