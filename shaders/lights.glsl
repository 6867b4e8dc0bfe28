// Direct light beyond the uniform sky, for the passes that are compiled with it. The kinds of light
// in lighting/sources bind what it reads. SKY_TABLE: a sky of any radiance. KEY_LIGHTS: area
// lights. SUN: the sun.

// Irradiance / pi by a sky, over skyRadiance: a number where the sky is uniform, a colour (and
// skyRadiance is 1) where it has a table.
#ifdef SKY_TABLE
#define SkyShare vec3

// RGBA32F, a third of the rows each for red, green, blue, column k: xyz = the vector whose product
// with a normal is the irradiance, over pi, of slice k from the zenith down to row / (rows of a
// third - 1) * 90 degrees.
uniform sampler2D skyTable;

// What slice k gives above a horizon. The filter's weights have 8 bits, of a row: fine enough.
SkyShare skyShare(Angle elevation, vec3 normal, float cosine, float sine, Angle width, int k)
{
    Angle plane = planeZenithAngle(normal.z, normal.x * cosine + normal.y * sine);
    Angle theta = min(HALF_PI - max(elevation, 0.0), plane);
    vec2 size = vec2(textureSize(skyTable, 0));
    float rows = size.y / 3.0;
    vec2 place = vec2(k, theta / HALF_PI * (rows - 1.0)) + 0.5;
    vec3 light;
    for (int c = 0; c < 3; ++c)
        light[c] =
            dot(normal, textureLod(skyTable, (place + vec2(0.0, rows * float(c))) / size, 0.0).xyz);
    return light;
}
#else
#define SkyShare float

SkyShare skyShare(Angle elevation, vec3 normal, float cosine, float sine, Angle width, int k)
{
    return skySlice(elevation, normal, cosine, sine, width, 0);
}
#endif

#ifdef KEY_LIGHTS
uniform sampler2DArray keyHorizon; // elevation codes, a layer per slice, light after light
uniform int keyCount;              // 1 ... 8
// Of each light: azimuth of its first slice [rad, counter-clockwise from east; the others follow
// clockwise], width of a slice, lowest >= 0 and highest elevation [rad].
uniform vec4 keyPlaces[8];
uniform vec4 keyRadiances[8]; // rgb; a = number of slices

// Irradiance / pi of a post by all key lights, as a surface of the given normal.
vec3 keyLight(ivec2 post, vec3 normal)
{
    vec3 light = vec3(0.0);
    int layer = 0;
    for (int i = 0; i < keyCount; ++i)
    {
        vec4 place = keyPlaces[i];
        float sum = 0.0;
        for (int slice = 0; slice < int(keyRadiances[i].a); ++slice)
        {
            float phi = place.x - place.y * float(slice);
            Angle elevation = elevationOfCode(texelFetch(keyHorizon, ivec3(post, layer), 0).x);
            sum += keySlice(elevation, place.z, place.w, normal, cos(phi), sin(phi), place.y);
            ++layer;
        }
        light += keyRadiances[i].rgb * sum;
    }
    return light;
}
#endif

#ifdef SUN
uniform sampler2DArray sunHorizon; // elevation codes towards the disc's left, centre and right
uniform vec3 sunIrradiance; // on a surface that faces the sun
uniform vec3 sunDirection;  // unit, x east, y north, z up
uniform float sunElevation; // [rad]
uniform float sunRadius;    // [rad]

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
#endif
