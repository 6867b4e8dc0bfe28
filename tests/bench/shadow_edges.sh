#!/usr/bin/env bash
# Draws the shadow of a wall and of a tower at 10 degrees, magnified, without and with shadow edges:
# docs/measurements/images/shadow_edges_off.png and _on.png. Usage: shadow_edges.sh [TERRAINLIGHT]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tool=${1:-build/bin/terrainlight}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Level ground, posts 4 m apart; a wall 12 m high that ends in the middle, a tower 24 m high.
awk 'BEGIN {
  print "ncols 97\nnrows 97\nxllcorner 0\nyllcorner 0\ncellsize 4"
  for (y = 0; y < 97; ++y) {
    for (x = 0; x < 97; ++x) {
      height = 0
      if (y >= 20 && y < 60 && x >= 60 && x < 63) height = 12
      if (y >= 70 && y < 74 && x >= 50 && x < 54) height = 24
      printf "%d ", height
    }
    print ""
  }
}' >"$folder/wall.asc"
mkdir -p docs/measurements/images
for edges in off on; do
  "$tool" render "$folder/wall.asc" "docs/measurements/images/shadow_edges_$edges.png" --top --sun 100,10 \
    --shadow-edges "$edges" --size 640,640 -q
done
