#!/usr/bin/env bash
# Draws docs/measurements/images/path_tracer_convergence.svg: the path tracer's error against its paths. Needs
# gnuplot. Usage: plot_convergence.sh [BUILD_FOLDER].
set -euo pipefail
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
build=${1:-$root/build}
csv=$(mktemp)
trap 'rm -f "$csv"' EXIT
OTL_CONVERGENCE_CSV=$csv "$build/bin/reference_tests" \
  --gtest_filter=PathTracerErrors.FallWithTheSamples
gnuplot <<GNUPLOT
set terminal svg size 640,420 font "sans,13" background "white"
set output "$root/docs/measurements/images/path_tracer_convergence.svg"
set datafile separator ","
set logscale xy
set format x "2^{%L}"
set logscale x 2
set format y "%g %%"
set xlabel "paths per receiver"
set ylabel "root mean square error"
set grid
set key top right
# Through the point of 1024 paths, where nets are in their stride.
first = system("sed -n 6p '$csv' | cut -d, -f2") * 100
second = system("sed -n 6p '$csv' | cut -d, -f3") * 100
plot "$csv" using 1:(\$2*100) with points pt 7 lc rgb "#1f77b4" title "direct sky, ramp of 45°", \
  first * (x / 1024)**-0.75 lc rgb "#1f77b4" title "paths^{-3/4}", \
  "$csv" using 1:(\$3*100) with points pt 5 lc rgb "#d62728" title "first bounce, valley", \
  second * (x / 1024)**-0.5 lc rgb "#d62728" dt 2 title "paths^{-1/2}"
GNUPLOT
