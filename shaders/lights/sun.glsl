// The sun: without SUN it gives nothing.
uniform vec3 sunIrradiance; // on a surface that faces the sun
uniform vec3 sunDirection;  // unit, x east, y north, z up
uniform float sunElevation; // [rad]
uniform float sunRadius;    // [rad]
uniform float sunOff;       // visible fraction without SUN: 1 switched off, 0 below the horizontal

#ifdef SUN
uniform sampler2DArray sunHorizon; // elevation codes towards the disc's left, centre and right
layout(rg16f) readonly uniform image2D sunEdge; // of shadow_edge.comp

// How far the sun's centre stands over a post's horizon [rad], 0 left, 1 centre, 2 right of the
// disc. The sky's edge is the horizontal, for the sun as for the sky.
Angle sunAbove(ivec2 post, int part)
{
    return sunElevation - max(elevationOfCode(texelFetch(sunHorizon, ivec3(post, part), 0).x), 0.0);
}

// Visible fraction of the disc from a post.
float sunVisible(ivec2 post)
{
    return visibleDiscFractionAcross(sunAbove(post, 0), sunAbove(post, 1), sunAbove(post, 2),
                                     sunRadius);
}

// Irradiance / pi of a surface that sees the whole disc, over sunIrradiance; at least the least
// half float.
float sunFacing(vec3 normal)
{
    return max(dot(normal, sunDirection) / PI, exp2(-14.0));
}

// Irradiance / pi of a surface that sees a fraction of it.
vec3 sunLight(vec3 normal, float visible)
{
    return sunIrradiance * (visible * max(dot(normal, sunDirection), 0.0) / PI);
}

// Height over the sun's shadow, and the softness of its edge [m].
vec2 overSunShadow(ivec2 post)
{
    return imageLoad(sunEdge, post).xy;
}

// Mean visible fraction of the disc on a straight way between two such.
float sunBetween(vec2 from, vec2 to)
{
    float softness = max(0.5 * (from.y + to.y), 1.0e-4);
    return min(meanDiscFraction(from.x / softness, to.x / softness),
               discFraction(sunElevation / sunRadius));
}

// Irradiance / pi of a cell in the mean. facing: of its corners, sunFacing().
vec3 sunOnCell(ivec2 cell, vec4 facing)
{
    vec2 over[4];
    for (int i = 0; i < 4; ++i)
        over[i] = overSunShadow(cell + ivec2(i % 2, i / 2));
    // In strips, along the axis along which the shadow changes more.
    if (abs(over[0].x - over[2].x) + abs(over[1].x - over[3].x) >
        abs(over[0].x - over[1].x) + abs(over[2].x - over[3].x))
    {
        vec2 kept = over[1];
        over[1] = over[2];
        over[2] = kept;
        facing.yz = facing.zy;
    }
    float mean = 0.0;
    for (int i = 0; i < 4; ++i)
    {
        float across = (float(i) + 0.5) / 4.0;
        vec2 from = mix(over[0], over[2], across);
        vec2 to = mix(over[1], over[3], across);
        float edge = shadowCrossing(from.x, to.x);
        float lit = from.x < 0.0 ? 0.5 * (1.0 + edge) : 0.5 * edge; // the middle of what is
        float there = mix(mix(facing.x, facing.z, across), mix(facing.y, facing.w, across),
                          edge < 1.0 ? lit : 0.5);
        mean += 0.25 * there * sunBetween(from, to);
    }
    return sunIrradiance * mean;
}
#else
float sunVisible(ivec2 post)
{
    return sunOff;
}

float sunFacing(vec3 normal)
{
    return 1.0;
}

vec3 sunLight(vec3 normal, float visible)
{
    return vec3(0.0);
}
#endif
