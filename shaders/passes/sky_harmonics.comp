// A sky in spherical harmonics as a picture: radiance at the middle of each texel.
layout(local_size_x = 8, local_size_y = 8) in;

// RGBA32F, rgb = radiance: columns counter-clockwise from east, rows upwards from the horizontal to
// the zenith, both of equal angles.
layout(rgba32f, binding = 0) writeonly uniform image2D sky;
uniform vec3 harmonics[16]; // (l, m) at l (l + 1) + m

void main()
{
    ivec2 texel = ivec2(INVOCATION.xy);
    ivec2 size = imageSize(sky);
    if (texel.x >= size.x || texel.y >= size.y)
        return;
    float phi = 2.0 * PI * (float(texel.x) + 0.5) / float(size.x);
    Angle elevation = HALF_PI * (float(texel.y) + 0.5) / float(size.y);
    ShVector basis =
        shBasis(vec3(cos(elevation) * cos(phi), cos(elevation) * sin(phi), sin(elevation)));
    vec3 radiance = vec3(0.0);
    for (int i = 0; i < 16; ++i)
        radiance += harmonics[i] * basis.c[i / 4][i % 4];
    imageStore(sky, texel, vec4(radiance, 1.0));
}
