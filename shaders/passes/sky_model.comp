// A computed sky as a picture: radiance at the middle of each texel.
layout(local_size_x = 8, local_size_y = 8) in;

// RGBA32F, rgb = radiance: columns counter-clockwise from east, rows upwards from the horizontal to
// the zenith, both of equal angles.
layout(rgba32f, binding = 0) writeonly uniform image2D sky;
#ifdef CLEAR
// As in ClearSky.
uniform vec4 luminance;
uniform vec4 x;
uniform vec4 y;
uniform vec3 e;
uniform vec3 zenith;
uniform vec3 gain;
#else
uniform bool overcast;
#endif

void main()
{
    ivec2 texel = ivec2(INVOCATION.xy);
    ivec2 size = imageSize(sky);
    if (texel.x >= size.x || texel.y >= size.y)
        return;
    Angle elevation = HALF_PI * (float(texel.y) + 0.5) / float(size.y);
#ifdef CLEAR
    float phi = 2.0 * PI * (float(texel.x) + 0.5) / float(size.x);
    ClearSky model;
    model.sun = sunDirection;
    model.luminance = luminance;
    model.x = x;
    model.y = y;
    model.e = e;
    model.zenith = zenith;
    model.gain = gain;
    vec3 radiance = clearSkyRadiance(
        model, vec3(cos(elevation) * cos(phi), cos(elevation) * sin(phi), sin(elevation)));
#else
    vec3 radiance = skyRadiance * (overcast ? overcastGradation(sin(elevation)) : 1.0);
#endif
    imageStore(sky, texel, vec4(radiance, 1.0));
}
