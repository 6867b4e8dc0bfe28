// Adds to what faces send diffusely what their corners send towards one viewer by gloss: the one
// pyramid of Nowrouzezahrai and Snyder 2009, section 5.3, for mixed surfaces.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2DArray lastExit; // layers as in gloss.comp
layout(rgba16f, binding = 0) uniform image2D faces; // of faces.comp
uniform ivec2 size; // posts
uniform vec3 towards; // unit: x east, y north, z up

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    ShVector basis = shBasis(towards);
    vec3 glossy = vec3(0.0);
    for (int c = 0; c < 3; ++c)
        for (int j = 0; j < 4; ++j)
            glossy[c] += dot(texelFetch(lastExit, ivec3(post, 4 * c + j), 0), basis.c[j]);
    for (int i = 0; i < 4; ++i)
    {
        ivec2 corner = 2 * post + ivec2(i % 2, i / 2);
        vec4 sent = imageLoad(faces, corner);
        imageStore(faces, corner,
                   sent.a > 0.0 ? vec4(roundedToHalf(sent.rgb + glossy), sent.a) : vec4(0.0));
    }
}
