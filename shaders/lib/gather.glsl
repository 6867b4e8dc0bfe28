// What a post receives from one slice of azimuth: segments of terrain one above the other, each up
// to the slope at which the next is seen over it.

// The casting set of Nowrouzezahrai and Snyder 2009, section 3: a sample is seen where it stands
// above all before it. cap: slope of the horizon, which no sample passes; coarse ones would.
Slope raisedSlope(Slope highest, Slope slope, Slope cap)
{
    return slope > highest ? max(highest, min(slope, cap)) : highest;
}

// In moments (sliceMoments): exact for diffuse light on a surface of any normal.
struct SliceGather
{
    Slope highest; // that segments reach
    vec3 moments;  // of the slice above it
    // what segments send, times their moments: what a normal's vertical part receives
    vec3 upward;
    vec3 outward;  // and its part along the slice
    vec3 last;     // what the last segment seen sends
};

// plane: slope that the slice begins at; own: what the cell ahead of the post sends.
SliceGather startGather(Slope plane, vec3 own, Angle width)
{
    SliceGather slice;
    slice.highest = plane;
    slice.moments = gradedMoments(plane, width);
    slice.upward = vec3(real(0.0), real(0.0), real(0.0));
    slice.outward = slice.upward;
    slice.last = own;
    return slice;
}

// Up to a sample's slope, if it is seen, where what is sent changes evenly with the slope: `level`
// at slope 0 and `change` more for each 1. last: what the sample sends.
SliceGather addLinearSegment(SliceGather slice, Slope slope, vec3 level, vec3 change, vec3 last,
                             Slope cap, Angle width)
{
    SliceGather next;
    next.highest = raisedSlope(slice.highest, slope, cap);
    next.moments = gradedMoments(next.highest, width);
    vec3 moments = slice.moments - next.moments;
    next.upward = slice.upward + level * moments.x + change * moments.z;
    next.outward = slice.outward + level * moments.y +
                   change * (moments.x * (real(2.0) * sin(real(0.5) * width) / width));
    next.last = slope > slice.highest ? last : slice.last;
    return next;
}

// The same where it does not change. sent: radiance between the sample and the one before.
SliceGather addSegment(SliceGather slice, Slope slope, vec3 sent, Slope cap, Angle width)
{
    return addLinearSegment(slice, slope, sent, vec3(real(0.0), real(0.0), real(0.0)), sent, cap,
                            width);
}

// Least rise of a segment along which light changes: less of it rounds.
GLSL_CONST Slope LEAST_GRADED = real(0.05);

// The same where `from` is sent at the slice's highest slope, `sent` at `slope`.
SliceGather addGradedSegment(SliceGather slice, Slope slope, vec3 from, vec3 sent, Slope cap,
                             Angle width)
{
    Slope rise = slope - slice.highest;
    bool graded = rise > LEAST_GRADED;
    real scale = graded ? real(1.0) / max(rise, LEAST_GRADED) : real(0.0);
    vec3 change = (sent - from) * scale;
    vec3 level = graded ? from - change * slice.highest : (from + sent) * real(0.5);
    return addLinearSegment(slice, slope, level, change, sent, cap, width);
}

// Up to the crest, which coarse samples under-estimate.
SliceGather closeGather(SliceGather slice, Slope cap, Angle width)
{
    return addSegment(slice, cap, slice.last, cap, width);
}

// Irradiance that the slice's segments give a surface of the normal. Radiance below 0, as that of
// harmonics, counts as it is.
vec3 received(SliceGather slice, vec3 normal, real cosine, real sine)
{
    GLSL_ASSERT(isUnit(normal) && isUnitPair(cosine, sine));
    real along = normal.x * cosine + normal.y * sine;
    return slice.upward * normal.z + slice.outward * along;
}

// In Legendre polynomials, per colour.
struct LegendreGather
{
    vec4 below; // the slice up to where segments reach (occlusionBelow)
    vec4 red;
    vec4 green;
    vec4 blue;
};

LegendreGather startLegendreGather(Slope plane)
{
    LegendreGather slice;
    slice.below = occlusionBelow(risingDirection(plane));
    slice.red = vec4(real(0.0), real(0.0), real(0.0), real(0.0));
    slice.green = slice.red;
    slice.blue = slice.red;
    return slice;
}

// Up to `slope`, at least that of the segment before. sent: radiance times weight; 0 < weight.
LegendreGather addLegendreSegment(LegendreGather slice, Slope slope, vec3 sent, real weight)
{
    GLSL_ASSERT(weight > real(0.0));
    LegendreGather next;
    next.below = occlusionBelow(risingDirection(slope));
    // The paper's sum over differences of radiance, by differences of elevation.
    vec4 piece = (next.below - slice.below) / weight;
    next.red = slice.red + piece * sent.x;
    next.green = slice.green + piece * sent.y;
    next.blue = slice.blue + piece * sent.z;
    return next;
}
