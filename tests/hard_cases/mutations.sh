#!/usr/bin/env bash
# Plants one fault at a time in a copy of the shaders and expects tests to fail.
# Usage: tests/hard_cases/mutations.sh [BUILD] [NAME...], default build/ and all mutations. Prints per
# mutation the test that failed first; exits non-zero where one survives or does not compile.
# mutations.sh --check: only that every mutation changes its file; needs no build.
# A mutation is a name, a file below shaders/, a sed command that must change it, and the tests that
# catch it, PROGRAM:GTEST_FILTER; the hard cases if none are named.
set -euo pipefail
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
check=
if [[ ${1:-} == --check ]]; then
  check=1
else
  programs=$(realpath "${1:-$root/build}")/bin
fi
shift || true
wanted=("$@")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
count=0
failed=0

complain()
{
  echo "$1"
  failed=$((failed + 1))
}

# run PROGRAM:FILTER; the log goes to $folder/log. 0 where all tests pass.
run()
{
  local program=$programs/${1%%:*}
  [[ -x $program ]] || { echo "$program: not built"; exit 2; }
  OSGTERRAINLIGHT_SHADERS=$folder "$program" --gtest_fail_fast --gtest_filter="${1#*:}" \
    >"$folder/log" 2>&1
}

mutate()
{
  local name=$1 file=$2 command=$3 tests=${4:-hard_cases_tests:*} start=$SECONDS
  [[ ${#wanted[@]} -eq 0 || " ${wanted[*]} " == *" $name "* ]] || return 0
  count=$((count + 1))
  rm -rf "${folder:?}"/*
  mkdir -p "$folder/$(dirname "$file")"
  [[ -f $root/shaders/$file ]] || { complain "$name: no file shaders/$file"; return 0; }
  sed -E "$command" "$root/shaders/$file" >"$folder/$file"
  if cmp -s "$root/shaders/$file" "$folder/$file"; then
    complain "$name: the sed command changes nothing in shaders/$file"
  elif [[ -n $check ]]; then
    return 0
  elif run "$tests"; then
    complain "$name: SURVIVES"
  elif grep -q 'does not compile' "$folder/log"; then
    complain "$name: does not compile"
  else
    echo "$name: $(grep -m 1 '^\[  FAILED  \]' "$folder/log" |
      sed -E 's/.*\] ([^ ]+).*/\1/') ($((SECONDS - start)) s)"
    grep -m 1 -A 2 ': Failure' "$folder/log" | sed -n '3s/^/    /p' || true # a crash has no such line
  fi
}

mutate slope-sign lib/surface.glsl 's/vec3\(-east \*/vec3(east */'
mutate normal-spacings lib/surface.glsl \
  's/-east \* northSpacing, -north \* eastSpacing/-east * eastSpacing, -north * northSpacing/'
mutate normal-count lib/surface.glsl 's/max\(count, real\(1\.0\)\)/real(4.0)/'
mutate slice-width lib/sky.glsl 's/real\(2\.0\) \* sin\(real\(0\.5\) \* width\)/width/'
mutate slice-own-plane lib/sky.glsl 's/min\(HALF_PI - clamped, planeZenith.*\)\);/HALF_PI - clamped;/'
mutate sky-below-level lib/sky.glsl 's/max\(elevation, real\(0\.0\)\)/elevation/'
mutate disc-no-clamp lib/sky.glsl \
  's/clamp\(above \/ r, .*\);/above \/ r;/; s/max\(real\(1\.0\) - x \* x, real\(0\.0\)\)/real(1.0) - x * x/'
mutate disc-step lib/sky.glsl 's/\(arc \+ x \* root\) \/ PI/(arc + x * root)/'
mutate void-weight-one lib/surface.glsl 's/weight < real\(1\.0\) \? between : b/between/'
mutate void-in-normal lib/surface.glsl 's/ && !isVoid\(across\)//'
mutate hull-ties lib/horizon.glsl 's/\(eye\.y - nearer\.y\) >=/(eye.y - nearer.y) >/'
mutate hull-side lib/horizon.glsl 's/\(eye\.y - nearer\.y\) >=/(eye.y - nearer.y) <=/'
mutate near-reach lib/horizon.glsl 's/column <= reach;/column < reach;/'
mutate near-inside lib/horizon.glsl 's/return inside \?/return false ?/'
mutate near-own-cell lib/horizon.glsl 's/whole \? ahead\[i\] - here/false ? ahead[i] - here/'
mutate near-row-crossing lib/horizon.glsl 's/max\(slope, atRow\)/slope/'
mutate near-mirror passes/horizon_near.comp 's/drift < 0\.0 \? -1 : 1/1/'
mutate near-step-length passes/horizon_near.comp 's/found\.slopes\[i\] \/ stepLength/found.slopes[i]/'
mutate sweep-reach passes/horizon_sweep.comp 's/walked - reach - 1/walked - reach - 2/'
mutate sweep-look passes/horizon_sweep.comp 's/line\.look > 0 \? high : low/high/'
mutate sweep-exit passes/horizon_sweep.comp 's/, floor\(exit\)\);/, 1.0e9);/'
mutate shade-half preamble.glsl 's/bits \+ 0x1000u/bits/'
mutate sun-side lib/sky.glsl 's/place < real\(0\.0\) \? left : right/left/'
mutate sweep-drift passes/horizon_sweep.comp 's/float turn = line\.drift \* float\(line\.look\)/float turn = line.drift/'
mutate sweep-step-length passes/horizon_sweep.comp 's/slope \/ stepLength/slope/'
mutate sweep-thinning passes/horizon_sweep.comp 's/hull\[i\] = hull\[2 \* i\]/hull[i] = hull[i]/'
mutate sweep-overflow passes/horizon_sweep.comp 's/vertices > HULL_CAPACITY - CHUNK/false/'
mutate code-rounding lib/angle.glsl 's/ \+ real\(0\.5\)\) \+ real\(32768/) + real(32768/'
mutate code-sign lib/angle.glsl 's/slope < real\(0\.0\) \? -angle : angle/angle/'
mutate azimuth-off-by-one passes/sky_view.comp 's/float\(k\);/float(k + 1);/'
mutate sun-edge-below-level lights/sun.glsl \
  's/max\(elevationOfCode\((.*)\), 0\.0\);/elevationOfCode(\1);/'
mutate sun-behind lights/sun.glsl 's/max\(dot\(normal, sunDirection\), 0\.0\)/abs(dot(normal, sunDirection))/'
mutate shade-void passes/shade.comp 's/if \(isVoid\(postHeight\(heights, post \+ frame\)\)\)/if (false)/'
mutate compose-last-bounce passes/compose.comp 's/light\.rgb \+ bounced/bounced/' \
  'gpu_tests:BounceClosedForm.*'

# A dispatch in pieces.
mutate pieces-place pieces.glsl 's/ \+ firstGroup \* gl_WorkGroupSize//' \
  'gpu_tests:Pieces.*'

# What surrounds a tile.
mutate windows-exit lib/windows.glsl 's/return min\(x, y\);/return x;/' \
  'gpu_tests:TileWindows.Horizons*'
mutate windows-none passes/horizon_sweep.comp 's/^        pushFar\(line\);/        ;/' \
  'gpu_tests:TileWindows.Horizons*'
mutate windows-ring passes/horizon_sweep.comp 's/line\.count \+= lead;//' \
  'gpu_tests:TileWindows.Horizons*'
mutate windows-seed passes/bounce_sweep.comp 's/^        passFar\(line, stepLength\);/        ;/' \
  'gpu_tests:TileWindows.Shading*'

# The walk along a ray and the gather of a slice: against the same functions on the CPU, which
# glsl_tests hold to closed forms.
rays()
{
  mutate "$1" lib/rays.glsl "$2" \
    gpu_tests:ShaderFunctions.Rays:ShaderFunctions.Gather:ShaderFunctions.Pyramids
}
gather()
{
  mutate "$1" lib/gather.glsl "$2" gpu_tests:ShaderFunctions.Gather
}
rays ray-side 's/ray\.drift < real\(0\.0\) \? .*;/ray.minor;/'
rays ray-step 's/vec2\(ray\.drift, real\(look\)\)/vec2(real(look), ray.drift)/'
rays ray-crossing 's/offset - whole\)/real(0.0))/'
rays ray-outside 's/return inside && !isVoid/return !isVoid/'
rays own-cell-drift 's/abs\(ray\.drift\) \* \(beside/ray.drift * (beside/'
rays surface-edge 's/place\.y <= real\(size\.y - 1\) \+ room/true/'
rays pyramid-level-half 's/real\(0\.5001\)/real(0.0)/'
rays pyramid-texel-centre 's/place\.x \/ side \+ real\(0\.5\)/place.x \/ side/'
rays cell-pyramid-edge 's/clamp\(place\.x \/ side, real\(0\.5\)/clamp(place.x \/ side, real(0.0)/'
rays pyramid-void 's/read\.y > real\(0\.5\)/read.y > real(0.1)/'
rays pyramid-rise 's/read\.x - here \* read\.y/read.x - here/'
rays rise-void 's/rise\.y > real\(0\.5\)/rise.y > real(0.1)/'
rays code-slope 's/real\(-1\.57\), real\(1\.57\)/real(-1.0), real(1.0)/'
rays plane-sign 's/return -\(normal/return (normal/'
gather raised-cap 's/min\(slope, cap\)/slope/'
gather raised-hidden 's/slope > highest \? (max.*) : highest;/min(slope, cap);/'
gather gather-start 's/slice\.moments = gradedMoments\(plane/slice.moments = gradedMoments(real(0.0)/'
gather gather-outward 's/level \* moments\.y/level * moments.x/'
gather gather-last 's/slope > slice\.highest \? last : slice\.last/last/'
gather gather-crest 's/addSegment\(slice, cap,/addSegment(slice, slice.highest,/'
gather legendre-start 's/occlusionBelow\(risingDirection\(plane\)\)/occlusionBelow(vec2(1.0, 0.0))/'
gather legendre-weight 's/ \/ weight//'
gather legendre-below 's/next\.below - slice\.below/next.below/'

# The history of a line, and the sweep that keeps it.
passed()
{
  mutate "$1" lib/line_history.glsl "$2" gpu_tests:ShaderFunctions.LineHistory
}
passed history-void 's/VOID_HEIGHT, real\(-1\.0\)/real(0.0), real(-1.0)/'
passed history-rise 's/max\(rise, LEAST_RISE \* stepLength\)/LEAST_RISE * stepLength/'
passed history-least 's/max\(rise, LEAST_RISE \* stepLength\)/rise/'
passed history-join 's/far \* farther\.light\.x \+ near/near * farther.light.x + far/'
passed history-end 's/\? farther\.end : nearer\.end/? nearer.end : farther.end/'
passed history-tilt 's/step \* \(farther\.light\.x - nearer/step * (farther.light.x + nearer/'
passed history-bound 's/clamp\(tilt, -most, most\)/tilt/'
passed history-part 's/real\(0\.5\) - below/real(0.5)/'
passed history-lowest 's/min\(slice\.highest, lowest\)/slice.highest/'
passed history-place 's/position - passed\.end\.y/position/'
mutate gather-received lib/gather.glsl 's/slice\.outward \* along/slice.upward * along/' \
  gpu_tests:ShaderFunctions.LineHistory
shadow()
{
  mutate "$1" lib/shadow.glsl "$2" gpu_tests:ShaderFunctions.Shadow
}
shadow shadow-crest 's/height > shadow\.height/height < shadow.height/'
shadow shadow-sink 's/crest - distance \* sun/crest/'
shadow shadow-bound 's/clamp\(over, -most, most\)/over/'
shadow shadow-crossing 's/from \/ \(from - to\)/to \/ (to - from)/'
shadow shadow-mean 's/discFractionIntegral\(to\) - discFractionIntegral\(from\)/discFractionIntegral(to)/'
mutate shadow-lines passes/shadow_lines.comp 's/shadow\.height -= stepLength/shadow.height += stepLength/' \
  gpu_tests:BounceClosedForm.CorrugationsInTheSun
mutate shadow-far passes/shadow_edge.comp 's/if \(far\.height > shadow\.height\)/if (false)/' \
  gpu_tests:BounceClosedForm.CorrugationsInTheSun
edges()
{
  mutate "$1" "$2" "$3" "gpu_tests:ShadowEdges.*"
}
edges edge-softness host/terrain_shading.glsl 's/max\(softness, vec4\(least\)\)/softness/'
edges edge-posts host/terrain_shading.glsl 's/terrainSunSeen\(here\) - between/terrainSunSeen(here)/'
edges edge-known host/terrain_shading.glsl 's/certain \* certain/0.0/'
edges edge-facing passes/screen_edges.comp 's/risen \* max/0.5 * risen * max/'
edges edge-relief passes/screen_edges.comp 's/over\.x > -0\.98 \* most/over.x > 0.0/'
edges former-part host/terrain_shading.glsl 's/coordinate\), former, part/coordinate), former, 0.5/'
edges former-unlit host/terrain_shading.glsl 's/part >= 1\.0/part > 1.0/'
edges former-own host/terrain_shading.glsl 's/part <= 0\.0/part < 0.0/'
edges former-place host/terrain_shading.glsl 's/osgTerrainLight_former, place/osgTerrainLight_former, coordinate/'
edges former-edges host/terrain_shading.glsl 's/formerPosts\.x < 1\.0/formerPosts.x < 1.0e6/'
borders()
{
  mutate "$1" host/terrain_shading.glsl "$2" gpu_tests:EdgeBlend.IsThatOfTheShader
}
borders border-sides 's/osgTerrainLight_drawn\.zw - coordinate/osgTerrainLight_drawn.xy - coordinate/'
borders border-corners 's/length\(vec2\(high\.x, low\.y\)\)/length(high)/'
borders border-smooth 's/smoothstep\(0\.0, 1\.0, vec4\(low, high\)\)/min(vec4(low, high), 1.0)/'
mutate faces-views passes/faces.comp 's/min\(views\[i\] .*MOST_MORE\)/1.0/' \
  'gpu_tests:*HardGround*/Mine'
mutate faces-inside passes/faces.comp 's/INSIDE = 0\.2/INSIDE = 1.0/' 'gpu_tests:*HardGround*/Mine'
form()
{
  mutate "$1" "$2" "$3" 'gpu_tests:ObjectVolume.HoldsTheDistancesOfFormsThatDeform'
}
form form-window lib/sampled_form.glsl 's/int window = min.*/int window = 0;/'
form form-fold lib/sampled_form.glsl 's/turnsX \? side - 1 - acrossX : acrossX/acrossX/'
form form-void lib/sampled_form.glsl 's/isOutside && isVoid/false/'
form form-lower lib/sampled_form.glsl 's/under > above \? slopedDistance\(under/under > above ? slopedDistance(above/'
form form-row passes/object_volume.comp 's/form\.row = shape\.voxels\.y/form.row = 0/'
sweep()
{
  mutate "$1" passes/bounce_sweep.comp "$2" \
    "gpu_tests:BounceClosedForm.*:Bounce.*:*BounceAccuracy*/FractalInTheSun"
}
sweep bounce-look 's/line\.look > 0 \? line\.length\.x - 1 - walked : walked/walked/'
sweep bounce-late 's/int passed = walked - NEAR/int passed = walked/'
sweep bounce-segment 's/float\(walked - 1\), before/float(walked), before/'
sweep bounce-room 's/leaves \? gone : 0/leaves ? 1 : 0/'
sweep bounce-oldest 's/history\[oldest \+ i\] = history\[oldest \+ i \+ gone\]/history[oldest + i] = history[oldest + i]/'
sweep bounce-sum 's/sum \+ vec4\(receive/vec4(receive/'
sweep bounce-own 's/raisedSlope\(plane, before, receiver\.cap\)/plane/'
sweep bounce-void 's/if \(!ground\)/if (false)/'
sweep bounce-edge 's/6\.0 : -6\.0/-6.0 : 6.0/'
mutate bounce-own-sum passes/bounce_own.comp 's/sum \+= received/sum = received/' "gpu_tests:BounceClosedForm.*"

[[ $count -gt 0 ]] || complain "no mutation of the name ${wanted[*]}"
echo "$count mutations, $failed failed"
exit $((failed > 0))
