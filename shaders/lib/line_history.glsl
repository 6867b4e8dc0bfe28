// What a line has passed, in entries that are coarser the farther they are: a bounce asks them for
// the terrain that a post sees beyond its own first steps.
//
// An entry stands for a piece of the line. What its terrain sends is weighed by its rise: that is
// what those who look from about its height see of it. (Weights for several slopes of view, mixed,
// change nothing.) Light times rise, and rise, add up, so entries can be joined. Along a wall light
// changes: an entry also has the straight line by height that fits its terrain's radiance best
// (least squares), whose parts add up, too.

// The least rise of a step of ground, over its length: where nothing in an entry rises, all of it
// counts alike.
GLSL_CONST real LEAST_RISE = real(7.0e-4);

struct Passed
{
    vec4 light; // radiance times rise [m], rise
    vec2 end;   // height [m] and position [steps walked] at which the entry is seen to end
    vec3 tilt;  // how much more the upper end sends than the lower, times the square of the rise
};

// A piece without ground: it sends nothing, and nobody sees it.
Passed passedNothing()
{
    Passed passed;
    passed.light = vec4(real(0.0), real(0.0), real(0.0), real(0.0));
    passed.end = vec2(VOID_HEIGHT, real(-1.0));
    passed.tilt = vec3(real(0.0), real(0.0), real(0.0));
    return passed;
}

// One step of ground from a height at a position, `rise` [m] above its nearer end. sent: radiance
// in the mean; more: at its farther end, less what is at its nearer one; stepLength [m] > 0.
Passed passedStep(Length height, real position, Length rise, vec3 sent, vec3 more,
                  Length stepLength)
{
    GLSL_ASSERT(stepLength > real(0.0));
    Length weight = max(rise, LEAST_RISE * stepLength);
    Passed passed;
    passed.light = vec4(sent.x * weight, sent.y * weight, sent.z * weight, weight);
    passed.end = vec2(height, position);
    passed.tilt = more * (weight * weight);
    return passed;
}

// Two pieces as one. It ends where a view of slope -1 sees it end.
Passed joinPassed(Passed farther, Passed nearer, Length stepLength)
{
    GLSL_ASSERT(stepLength > real(0.0));
    Length between = (nearer.end.y - farther.end.y) * stepLength;
    Passed joined;
    joined.light = farther.light + nearer.light;
    joined.end = farther.end.x - nearer.end.x + between >= real(0.0) ? farther.end : nearer.end;
    // The farther one is seen above the nearer.
    real near = real(6.0) * nearer.light.w;
    real far = real(6.0) * farther.light.w;
    joined.tilt = farther.tilt + nearer.tilt +
                  vec3(near * farther.light.x - far * nearer.light.x,
                       near * farther.light.y - far * nearer.light.y,
                       near * farther.light.z - far * nearer.light.z);
    return joined;
}

// A tilt that leaves no end of a piece of such light farther below 0 than half of it.
real boundedTilt(real tilt, real light)
{
    real most = real(3.0) * abs(light);
    return clamp(tilt, -most, most);
}

// Up to where a piece of that many steps is seen to end, if it is seen, from a height `here` at a
// position beyond it. Its light changes evenly with the height: what is seen of it is its upper
// part, and who stands below sees the lower part of a high wall best.
SliceGather addPassed(SliceGather slice, Passed passed, real steps, Length here, real position,
                      Length stepLength, Slope cap, Angle width)
{
    GLSL_ASSERT(stepLength > real(0.0) && position >= passed.end.y + steps);
    real scale = real(1.0) / max(passed.light.w, real(1.0e-12));
    Length distance = (position - passed.end.y) * stepLength;
    Slope slope = (passed.end.x - here) / distance;
    // Where a shadow's edge goes through it the line begins below 0: not too far, for those who see
    // no more than that end.
    vec3 tilt = vec3(boundedTilt(passed.tilt.x * scale, passed.light.x) * scale,
                     boundedTilt(passed.tilt.y * scale, passed.light.y) * scale,
                     boundedTilt(passed.tilt.z * scale, passed.light.z) * scale);
    // Its upper half is farther away, so that less is seen of it, to first order by this.
    real away = max(position - passed.end.y - real(0.5) * steps, real(0.5) * steps);
    vec3 top = vec3(passed.light.x * scale, passed.light.y * scale, passed.light.z * scale) +
               tilt * (real(0.5) - steps / (real(6.0) * away));
    Slope lowest = (passed.end.x - passed.light.w - here) /
                   max(distance - steps * stepLength, real(0.5) * stepLength);
    real part = clamp((slope - slice.highest) / max(slope - lowest, real(1.0e-6)), real(0.0),
                      real(1.0));
    return addGradedSegment(slice, slope, top - tilt * part, top, cap, width);
}
