#!/usr/bin/env bash
# Writes docs/measurements/TABLE_1.md and its picture: table 1 of Nowrouzezahrai and Snyder 2009, row by row, from runs
# of `terrainlight bench`. Usage: table_1.sh [--quick] [TERRAINLIGHT [RESULTS]]: the program to measure,
# and a folder for its CSV. What RESULTS holds already is not measured again: remove it to do so.
# --quick: 64 and 128 posts a side, and document and picture in RESULTS.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
sizes=(256 512 1024)
quick=
if [[ ${1:-} == --quick ]]; then
  quick=yes
  sizes=(64 128)
  shift
fi
tool=${1:-build/bin/terrainlight}
results=${2:-build/table_1${quick:+_quick}}
document=${quick:+$results/TABLE_1.md}
document=${document:-docs/measurements/TABLE_1.md}
picture=$(dirname "$document")/images/table_1.svg
mkdir -p "$results" "$(dirname "$picture")"

started=$SECONDS
for size in "${sizes[@]}"; do
  for bounces in 1 2 3; do
    # Quality draft has the paper's own k = 4.
    for entry in draft:legendre,legendre-2,legendre-4 normal:sweep-normal; do
      quality=${entry%%:*}
      # The default is there to be compared; the largest would take as long as all the rest.
      [[ $quality != normal || $size -lt 1024 ]] || continue
      files=$results/${size}_${bounces}_$quality
      [[ ! -f $files.csv ]] || continue
      echo "measuring $size x $size, bounces: $bounces, methods: ${entry#*:}"
      "$tool" bench --generate fractal --size "$size" --azimuths 32 --sun 315,35 --bounces "$bounces" \
        --quality "$quality" --methods "${entry#*:}" --posts 0 --repeats 1 -q --csv "$files.part" \
        >"$files.txt"
      mv "$files.part" "$files.csv"
    done
  done
done
echo "measured in $((SECONDS - started)) s"

# method, sub-sampling, side, bounces, GPU ms, MB (10^6 bytes); a line each.
data=$results/table.txt
for size in "${sizes[@]}"; do
  for bounces in 1 2 3; do
    awk -F, -v size="$size" -v bounces="$bounces" '
      FNR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
      $column["skipped"] == "" {
        method = $1 ~ /^legendre/ ? "legendre" : "default"
        step = $1 ~ /-[24]$/ ? substr($1, length($1)) : 1
        print method, step, size, bounces, $column["gpu_ms"], $column["memory_bytes"] / 1e6
      }' "$results/${size}_$bounces"_*.csv
  done
done >"$data"

# The paper: side, sub-sampling, MB, frames per second of 1, 2, 3 bounces on a GTX 285, without its
# shading amortisation.
paper='256 1 17.4 49.5 44 40
256 2 4.5 125 107.7 101
256 4 1.65 229 198 185
512 1 76 11.6 10.5 10
512 2 20 35.5 32 30
512 4 7.1 73 65.6 62
1024 1 336 2.7 2.4 2.2
1024 2 88 8.3 7.6 7.1
1024 4 29.5 18.9 17.2 16.4'

# table METHOD: rows as in the paper, ours beside its own.
table()
{
  awk -v wanted="$1" '
    NR == FNR { paper[$1, $2] = $3 " | " $4 " | " $5 " | " $6; next }
    $1 == wanted {
      ms[$3, $2, $4] = $5
      if ($4 == 1) mb[$3, $2] = $6 # of one bounce: more need a texture of what the last one brought
      if ($4 == 1) order[++rows] = $3 SUBSEP $2
    }
    function rate(side, step, bounces) {
      return ms[side, step, bounces] > 0 ? sprintf("%.3g", 1000 / ms[side, step, bounces]) : "–"
    }
    END {
      print "| posts | sub-sampling | MB | 1 bounce, Hz | 2, Hz | 3, Hz | paper: MB | 1 bounce, Hz | 2, Hz | 3, Hz |"
      print "|---|---|---|---|---|---|---|---|---|---|"
      for (i = 1; i <= rows; ++i) {
        split(order[i], at, SUBSEP)
        theirs = (at[1], at[2]) in paper ? paper[at[1], at[2]] : "– | – | – | –"
        printf "| %d² | %d× | %.3g | %s | %s | %s | %s |\n", at[1], at[2], mb[at[1], at[2]],
          rate(at[1], at[2], 1), rate(at[1], at[2], 2), rate(at[1], at[2], 3), theirs
      }
    }' <(echo "$paper") "$data"
}

# inBounces: method, sub-sampling, side; milliseconds without bounces and per bounce by least squares;
# the greatest distance from that line, relative.
inBounces()
{
  awk '
    { key = $1 " " $2 " " $3; n[key]++; x[key, n[key]] = $4; y[key, n[key]] = $5
      if (n[key] == 1) order[++keys] = key }
    END {
      for (k = 1; k <= keys; ++k) {
        key = order[k]; count = n[key]; sx = sy = sxx = sxy = worst = 0
        for (i = 1; i <= count; ++i) {
          sx += x[key, i]; sy += y[key, i]; sxx += x[key, i] ^ 2; sxy += x[key, i] * y[key, i]
        }
        if (count < 3) continue
        slope = (count * sxy - sx * sy) / (count * sxx - sx * sx)
        start = (sy - slope * sx) / count
        for (i = 1; i <= count; ++i) {
          off = (y[key, i] - start - slope * x[key, i]) / y[key, i]
          if (off < 0) off = -off
          if (off > worst) worst = off
        }
        print key, start, slope, worst
      }
    }' "$data"
}

# inPosts: method, sub-sampling, bounces; exponent of the time in posts by least squares of logarithms;
# milliseconds per post of the best proportion; the greatest distance from that, relative.
inPosts()
{
  awk '
    { key = $1 " " $2 " " $4; n[key]++; x[key, n[key]] = log($3 * $3); y[key, n[key]] = log($5)
      if (n[key] == 1) order[++keys] = key }
    END {
      for (k = 1; k <= keys; ++k) {
        key = order[k]; count = n[key]; sx = sy = sxx = sxy = worst = 0
        for (i = 1; i <= count; ++i) {
          sx += x[key, i]; sy += y[key, i]; sxx += x[key, i] ^ 2; sxy += x[key, i] * y[key, i]
        }
        if (count < 2) continue
        slope = (count * sxy - sx * sy) / (count * sxx - sx * sx)
        level = (sy - sx) / count
        for (i = 1; i <= count; ++i) {
          off = exp(y[key, i] - level - x[key, i]) - 1
          if (off < 0) off = -off
          if (off > worst) worst = off
        }
        print key, slope, exp(level), worst
      }
    }' "$data"
}

inBounces >"$results/in_bounces.txt"
inPosts >"$results/in_posts.txt"

# series METHOD SUBSAMPLING BOUNCES|- SIDE|-: lines of the table, "-" is any.
series() { awk -v m="$1" -v s="$2" -v b="$3" -v w="$4" \
  '$1 == m && $2 == s && (b == "-" || $4 == b) && (w == "-" || $3 == w)' "$data"; }

plots=
for method in legendre default; do
  colour=$([[ $method == legendre ]] && echo '#d55e00' || echo '#0072b2')
  for size in "${sizes[@]}"; do
    series "$method" 1 - "$size" >"$results/plot_${method}_$size.txt"
    [[ -s $results/plot_${method}_$size.txt ]] || continue
    read -r start slope < <(awk -v m="$method" -v w="$size" \
      '$1 == m && $2 == 1 && $3 == w { print $4, $5 }' "$results/in_bounces.txt")
    plots+="${plots:+, }'$results/plot_${method}_$size.txt' using 4:5 with points pointtype 7 \
linecolor '$colour' notitle, $start + $slope * x linecolor '$colour' notitle, \
'$results/plot_${method}_$size.txt' using 4:(\$4 == 3 ? \$5 : NaN):3 with labels offset 2.2,0 \
textcolor '$colour' notitle"
  done
done
byPosts=
for method in legendre default; do
  for step in 1 2 4; do
    colour=$([[ $method == legendre ]] && echo '#d55e00' || echo '#0072b2')
    series "$method" "$step" 1 - >"$results/plot_${method}_by_posts_$step.txt"
    read -r slope level < <(awk -v m="$method" -v s="$step" \
      '$1 == m && $2 == s && $3 == 1 { print $4, $5 }' "$results/in_posts.txt")
    title=$(printf '%s, %s×: posts^{%.2f}' "$method" "$step" "$slope")
    byPosts+="${byPosts:+, }'$results/plot_${method}_by_posts_$step.txt' using (\$3*\$3):5 with points \
pointtype $((step == 1 ? 7 : step == 2 ? 5 : 9)) linecolor '$colour' title '$title', \
$level * x linecolor '$colour' dashtype 3 notitle"
  done
done
if [[ -z $quick ]]; then
  echo "$paper" | awk '$2 == 1' >"$results/plot_paper.txt"
  byPosts+=", '$results/plot_paper.txt' using (\$1*\$1):(1000/\$4) with points pointtype 1 \
linecolor '#888888' title 'paper, GTX 285, 1×'"
fi
gnuplot <<GNUPLOT
set encoding utf8
set terminal svg size 960,460 font 'sans-serif,12' background '#ffffff'
set output '$picture'
set multiplot layout 1,2
set grid
set logscale y
set ylabel 'GPU milliseconds'
set xlabel 'bounces'
set xrange [0.8:3.5]
set xtics 1
set title 'cost against bounces, without sub-sampling; posts a side'
plot $plots
set xlabel 'posts'
set logscale x
set xtics auto
set xrange [*:*]
set key below maxcols 2
set title 'cost against posts, one bounce'
set xrange [${sizes[0]}**2/1.5:${sizes[-1]}**2*1.5]
plot $byPosts
unset multiplot
GNUPLOT

# fact KEY: a line of the head that every run prints.
fact() { sed -n "s/^$1: *//p" "$results/${sizes[0]}_1_draft.txt"; }

{
  cat <<'MARKDOWN'
# Table 1

This page is written by `tests/bench/table_1.sh`. It repeats table 1 of Nowrouzezahrai and Snyder 2009 row by row: rate and memory against
resolution, sub-sampling and number of bounces.

The light is a sky and a sun, with 32 azimuths. The paper has an environment and a key light of three azimuths; our sun has three azimuths
too. The terrain is a generated fractal. Everything, horizons included, is computed again each time. A rate is 1000 / GPU
milliseconds of all stages. The rates of the paper were measured on a GTX 285 without shading amortisation and contain the drawing of the terrain. MB are 10⁶ bytes
of all textures and hulls.

MARKDOWN
  echo "Device: $(fact Device). Processor: $(nproc) cores of $(
    sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1). Date: $(
    sed -n '/^terrainlight/s/.*, \(....-..-..\)T.*/\1/p' "$results/${sizes[0]}_1_draft.txt")."
  [[ $(fact Device) != *"(software)"* ]] ||
    echo "This is software OpenGL. Read its rates as ratios, not beside those of the paper."
  echo
  echo "![cost against bounces and posts](images/table_1.svg)"
  echo
  echo "The lines on the left are least-squares fits. The dotted lines on the right are proportional to the number of posts."
  echo
  echo "## The paper's method: \`legendre\` at \`draft\`, which has its k = 4"
  echo
  table legendre
  echo
  echo "## The default, \`slices\` at \`normal\`"
  echo
  echo "Sub-sampling affects only the light of far terrain in bounces. Horizons, direct light and near terrain keep the full resolution."
  echo
  table default
  cat <<'MARKDOWN'

## Linear in bounces?

Least-squares fit of milliseconds = a + b · bounces. The last column is the greatest distance of the three from that line.

| method | sub-sampling | posts | a, ms | b, ms per bounce | off by |
|---|---|---|---|---|---|
MARKDOWN
  awk '{ printf "| %s | %d× | %d² | %.3g | %.3g | %.1f %% |\n", $1, $2, $3, $4, $5, 100 * $6 }' \
    "$results/in_bounces.txt"
  cat <<'MARKDOWN'

## Linear in posts?

Milliseconds of one bounce: the exponent of the number of posts from a least-squares fit of logarithms (1: linear), the best proportional
fit, and the greatest distance from it. The reach grows with the tile, and the number of samples along a ray grows with the logarithm of the reach.

| method | sub-sampling | exponent | ns per post | off by |
|---|---|---|---|---|
MARKDOWN
  awk '$3 == 1 { printf "| %s | %d× | %.3f | %.3g | %.0f %% |\n", $1, $2, $4, 1e6 * $5, 100 * $6 }' \
    "$results/in_posts.txt"
} >"$document"
echo "wrote $document and $picture"
