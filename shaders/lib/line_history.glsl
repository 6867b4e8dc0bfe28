// What a line has passed, in entries that are coarser the farther they are: a bounce asks them for
// the terrain that a post sees beyond its own first steps.
//
// An entry stands for a piece of the line. What its terrain sends is weighed by its rise: that is
// what those who look from about its height see of it. (Weights for several slopes of view, mixed,
// change nothing.) Light times rise, and rise, add up, so entries can be joined.

// The least rise of a step of ground, over its length: where nothing in an entry rises, all of it
// counts alike.
GLSL_CONST real LEAST_RISE = real(7.0e-4);

struct Passed
{
    vec4 light; // radiance times rise [m], rise
    vec2 end;   // height [m] and position [steps walked] at which the entry is seen to end
};

// A piece without ground: it sends nothing, and nobody sees it.
Passed passedNothing()
{
    Passed passed;
    passed.light = vec4(real(0.0), real(0.0), real(0.0), real(0.0));
    passed.end = vec2(VOID_HEIGHT, real(-1.0));
    return passed;
}

// One step of ground from a height at a position, `rise` [m] above its nearer end. sent: radiance;
// stepLength [m] > 0.
Passed passedStep(Length height, real position, Length rise, vec3 sent, Length stepLength)
{
    GLSL_ASSERT(stepLength > real(0.0));
    Length weight = max(rise, LEAST_RISE * stepLength);
    Passed passed;
    passed.light = vec4(sent.x * weight, sent.y * weight, sent.z * weight, weight);
    passed.end = vec2(height, position);
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
    return joined;
}

// Up to where a piece is seen to end, if it is seen, from a height `here` at a position beyond it.
SliceGather addPassed(SliceGather slice, Passed passed, Length here, real position,
                      Length stepLength, Slope cap, Angle width)
{
    GLSL_ASSERT(stepLength > real(0.0) && position > passed.end.y);
    real scale = real(1.0) / max(passed.light.w, real(1.0e-30));
    vec3 sent = vec3(passed.light.x * scale, passed.light.y * scale, passed.light.z * scale);
    Slope slope = (passed.end.x - here) / ((position - passed.end.y) * stepLength);
    return addSegment(slice, slope, sent, cap, width);
}
