// The sun: without SUN it gives nothing.
uniform vec3 sunIrradiance; // on a surface that faces the sun
uniform vec3 sunDirection;  // unit, x east, y north, z up
uniform float sunElevation; // [rad]
uniform float sunRadius;    // [rad]
uniform float sunOff;       // visible fraction without SUN: 1 switched off, 0 below the horizontal

#ifdef SUN
uniform sampler2DArray sunHorizon; // elevation codes towards the disc's left, centre and right

// How far the sun's centre stands over a post's horizon [rad], 0 left, 1 centre, 2 right of the
// disc. The sky's edge is the horizontal, for the sun as for the sky.
Angle sunAbove(ivec2 post, int part)
{
    return sunElevation - max(elevationOfCode(texelFetch(sunHorizon, ivec3(post, part), 0).x), 0.0);
}

// The same of a cell's corners.
vec4 sunAboveCorners(ivec2 cell)
{
    return vec4(sunAbove(cell, 1), sunAbove(cell + ivec2(1, 0), 1), sunAbove(cell + ivec2(0, 1), 1),
                sunAbove(cell + ivec2(1, 1), 1));
}

// Visible fraction of the disc from a post.
float sunVisible(ivec2 post)
{
    return visibleDiscFractionAcross(sunAbove(post, 0), sunAbove(post, 1), sunAbove(post, 2),
                                     sunRadius);
}

// Irradiance / pi of a surface that sees a fraction of the disc.
vec3 sunLight(vec3 normal, float visible)
{
    return sunIrradiance * (visible * max(dot(normal, sunDirection), 0.0) / PI);
}

// Irradiance / pi at a place in a cell, 0 ... 1, over sunIrradiance.
const bool SUN_IN_CELLS = true;

float sunInCell(ivec2 cell, vec2 inside, vec3 normal)
{
    return discOnCell(sunAboveCorners(cell), inside.x, inside.y, sunRadius, normal, sunDirection);
}

// Its mean over the cell. corners [m]: as in cellNormal().
float sunOnCell(ivec2 cell, vec4 corners, Length east, Length north)
{
    vec4 above = sunAboveCorners(cell);
    float mean = 0.0;
    for (int i = 0; i < 16; ++i)
    {
        vec2 place = (vec2(i % 4, i / 4) + 0.5) / 4.0;
        vec3 there = cellNormal(corners, place.x, place.y, east, north);
        mean += discOnCell(above, place.x, place.y, sunRadius, there, sunDirection) / 16.0;
    }
    return mean;
}
#else
float sunVisible(ivec2 post)
{
    return sunOff;
}

vec3 sunLight(vec3 normal, float visible)
{
    return vec3(0.0);
}

const bool SUN_IN_CELLS = false;

float sunInCell(ivec2 cell, vec2 inside, vec3 normal)
{
    return 0.0;
}

float sunOnCell(ivec2 cell, vec4 corners, Length east, Length north)
{
    return 0.0;
}
#endif
