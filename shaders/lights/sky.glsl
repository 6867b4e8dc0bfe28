// The sky. Compiled for a uniform one, or with SKY_TABLE for a sky of any radiance.
uniform bool hasSky;
uniform vec3 skyRadiance; // of the uniform sky; SKY_TABLE: 1

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

struct FourLights
{
    vec3 light[4];
};

// Irradiance / pi of a post as surfaces of four normals. horizon: elevation codes, layer k looks
// towards 2*pi*k/azimuths from east.
FourLights skyOnPost(readonly image2DArray horizon, int azimuths, ivec2 post, vec3 normals[4])
{
    SkyShare sums[4];
    for (int i = 0; i < 4; ++i)
        sums[i] = SkyShare(0.0);
    float width = 2.0 * PI / float(azimuths);
    for (int k = 0; k < (hasSky ? azimuths : 0); ++k)
    {
        float phi = width * float(k);
        Angle elevation = elevationOfCode(imageLoad(horizon, ivec3(post, k)).x);
        for (int i = 0; i < 4; ++i)
            sums[i] += skyShare(elevation, normals[i], cos(phi), sin(phi), width, k);
    }
    FourLights sky;
    for (int i = 0; i < 4; ++i)
        sky.light[i] = skyRadiance * sums[i];
    return sky;
}
