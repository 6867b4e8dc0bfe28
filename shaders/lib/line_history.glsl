// What a line has passed, in entries that are coarser the farther they are: a bounce asks them for
// the terrain that a post sees beyond its own first steps.
//
// An entry stands for a piece of the line. What its terrain sends is weighed by its rise: that is
// what those who look from about its height see of it. (Weights for several slopes of view, mixed,
// change nothing.) Along a wall light changes: an entry also has the straight line by height that
// fits its terrain's radiance best (least squares). An entry is joined seldom and read often, so
// what it has is ready to be read.

// The least rise of a step of ground, over its length: where nothing in an entry rises, all of it
// counts alike.
GLSL_CONST real LEAST_RISE = real(7.0e-4);

struct Passed
{
    vec4 light; // radiance in the mean, rise [m]
    vec2 end;   // height [m] and position [steps walked] at which the entry is seen to end
    vec3 tilt;  // how much more the upper end sends than the lower
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

// A tilt that leaves no end of a piece of such light farther below 0 than half of it: where a
// shadow's edge goes through a piece its line begins below 0, and there are those who see no more
// than that end.
real boundedTilt(real tilt, real light)
{
    real most = real(3.0) * abs(light);
    return clamp(tilt, -most, most);
}

// One step of ground from a height at a position, `rise` [m] above its nearer end. sent: radiance
// in the mean; more: at its farther end, less what is at its nearer one; stepLength [m] > 0.
Passed passedStep(Length height, real position, Length rise, vec3 sent, vec3 more,
                  Length stepLength)
{
    GLSL_ASSERT(stepLength > real(0.0));
    Passed passed;
    passed.light = vec4(sent.x, sent.y, sent.z, max(rise, LEAST_RISE * stepLength));
    passed.end = vec2(height, position);
    passed.tilt = vec3(boundedTilt(more.x, sent.x), boundedTilt(more.y, sent.y),
                       boundedTilt(more.z, sent.z));
    return passed;
}

// Two pieces as one. It ends where a view of slope -1 sees it end.
Passed joinPassed(Passed farther, Passed nearer, Length stepLength)
{
    GLSL_ASSERT(stepLength > real(0.0));
    Length between = (nearer.end.y - farther.end.y) * stepLength;
    Passed joined;
    joined.end = farther.end.x - nearer.end.x + between >= real(0.0) ? farther.end : nearer.end;
    // The farther one is seen above the nearer.
    Length rise = farther.light.w + nearer.light.w;
    real scale = real(1.0) / max(rise, real(1.0e-12));
    real far = farther.light.w * scale;
    real near = nearer.light.w * scale;
    joined.light = vec4(far * farther.light.x + near * nearer.light.x,
                        far * farther.light.y + near * nearer.light.y,
                        far * farther.light.z + near * nearer.light.z, rise);
    real step = real(6.0) * far * near;
    far = far * far;
    near = near * near;
    joined.tilt = vec3(boundedTilt(far * farther.tilt.x + near * nearer.tilt.x +
                                       step * (farther.light.x - nearer.light.x),
                                   joined.light.x),
                       boundedTilt(far * farther.tilt.y + near * nearer.tilt.y +
                                       step * (farther.light.y - nearer.light.y),
                                   joined.light.y),
                       boundedTilt(far * farther.tilt.z + near * nearer.tilt.z +
                                       step * (farther.light.z - nearer.light.z),
                                   joined.light.z));
    return joined;
}

// Up to where a piece of that many steps is seen to end, if it is seen, from a height `here` at a
// position beyond it. Its light changes evenly with the height: what is seen of it is its upper
// part, and who stands below sees the lower part of a high wall best.
SliceGather addPassed(SliceGather slice, Passed passed, real steps, Length here, real position,
                      Length stepLength, Slope cap, Angle width)
{
    GLSL_ASSERT(stepLength > real(0.0) && position >= passed.end.y + steps);
    real inverse = real(1.0) / ((position - passed.end.y) * stepLength);
    Slope slope = (passed.end.x - here) * inverse;
    // Its upper half is farther away, so that less is seen of it: by a sixth of its length over the
    // distance of its middle, here as a series.
    real part = steps * stepLength * inverse;
    real below = part / real(6.0) * (real(1.0) + part * (real(0.5) + part * real(0.25)));
    vec3 mean = vec3(passed.light.x, passed.light.y, passed.light.z);
    vec3 top = mean + passed.tilt * (real(0.5) - below);
    Slope lowest = (passed.end.x - passed.light.w - here) * inverse /
                   max(real(1.0) - part, real(0.1));
    // From its lower end, or from where terrain before it ends the view of it.
    Slope range = slope - min(slice.highest, lowest);
    bool graded = range > LEAST_GRADED;
    real perSlope = graded ? real(1.0) / max(range, LEAST_GRADED) : real(0.0);
    vec3 change = passed.tilt * perSlope;
    vec3 level = graded ? top - change * slope : mean;
    return addLinearSegment(slice, slope, level, change, top, cap, width);
}
