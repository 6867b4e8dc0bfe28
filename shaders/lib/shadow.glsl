// The edge of the sun's shadow between posts.
//
// A shadow ends where the surface meets the plane of light that grazes a crest. The height of that
// plane over a place is linear in plan, and so is the surface along a straight way, while the angle
// of the horizon is neither. So what counts is the surface's height over the shadow, beside its
// softness: how high the disc's radius is there, seen over the crest.

// The shadow of a crest over a place: height [m] and distance to the crest [m].
struct Shadow
{
    Length height;
    Length distance;
};

Shadow noShadow()
{
    Shadow shadow;
    shadow.height = VOID_HEIGHT;
    shadow.distance = real(1.0);
    return shadow;
}

// Of a crest of that height [m] or, where it is lower, the one there was.
Shadow addCrest(Shadow shadow, Length crest, Length distance, Slope sun)
{
    GLSL_ASSERT(distance >= real(0.0));
    Length height = crest - distance * sun;
    bool higher = !isVoid(crest) && height > shadow.height;
    shadow.height = higher ? height : shadow.height;
    shadow.distance = higher ? distance : shadow.distance;
    return shadow;
}

// Between two places, 0 ... 1 of the way; where one has none, it is the other's.
Shadow mixShadows(Shadow a, Shadow b, real weight)
{
    Shadow mixed;
    mixed.height = a.height + (b.height - a.height) * weight;
    mixed.distance = a.distance + (b.distance - a.distance) * weight;
    if (isVoid(a.height))
        mixed = b;
    if (isVoid(b.height))
        mixed = a;
    return mixed;
}

// What the surface rises or falls against the light from a post to its neighbours. relief [m]:
// postRelief(); spacing [m]: the wider one.
Length shadowRelief(Length relief, Length spacing, Slope sun)
{
    return relief + real(1.5) * spacing * abs(sun);
}

// Height of a surface over the shadow [m] and softness [m] > 0: their ratio is how many of the
// disc's radii its centre stands above the crest. elevation, radius [rad] > 0: of the disc; sun:
// its slope. relief [m] >= 0: what the surface rises or falls to the next places; a shadow that is
// higher than that and the softness says nothing of where it ends, and behind a wall it would.
vec2 overShadow(Shadow shadow, Length here, Angle elevation, Slope sun, Angle radius, Length relief)
{
    GLSL_ASSERT(radius > real(0.0) && relief >= real(0.0));
    Length over = isVoid(shadow.height) ? real(1.0e30) : here - shadow.height;
    Angle above = elevation - elevationOfSlope(sun - over / max(shadow.distance, real(1.0e-6)));
    // Where both are 0 their ratio is that of small angles.
    Length softness = abs(above) > real(1.0e-3)
                          ? over / above * radius
                          : shadow.distance * radius * (real(1.0) + sun * sun);
    Length most = relief + softness;
    return vec2(clamp(over, -most, most), softness);
}

// Visible fraction of a disc whose centre stands `above` a straight horizon, in radii: within
// 0.0032 of visibleDiscFraction(), without its arc sine.
real discFraction(real above)
{
    real x = clamp(above, real(-1.0), real(1.0));
    real y = x * x;
    return real(0.5) + x * (real(0.6366) - y * (real(0.1017) + y * real(0.0349)));
}

// Its antiderivative, 0 where nothing of the disc is seen.
real discFractionIntegral(real above)
{
    real x = clamp(above, real(-1.0), real(1.0));
    real y = x * x;
    real inside = real(0.5) * (x + real(1.0)) - real(0.287058333333) +
                  y * (real(0.3183) - y * (real(0.025425) + y * real(0.005816666667)));
    return inside + max(above - real(1.0), real(0.0));
}

// Mean visible fraction of a disc along a way on which the height of its centre over the horizon
// changes evenly, in radii.
real meanDiscFraction(real from, real to)
{
    real change = to - from;
    real middle = real(0.5) * (from + to);
    // Close together, differences of the integral round; and the fraction is straight.
    real mean = abs(change) > real(0.1)
                    ? (discFractionIntegral(to) - discFractionIntegral(from)) / change
                    : discFraction(middle);
    // Far from the disc on one side, those of large numbers would round.
    return min(from, to) >= real(1.0) ? real(1.0) : mean;
}

// How far along a way the height over the shadow changes its sign, 0 ... 1; 1 where it does not.
real shadowCrossing(Length from, Length to)
{
    bool crosses = (from < real(0.0)) != (to < real(0.0));
    return crosses ? from / (from - to) : real(1.0);
}
