// Adds to what cells send diffusely what their corners send towards one viewer by gloss: the one
// pyramid of Nowrouzezahrai and Snyder 2009, section 5.3, for mixed surfaces.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2DArray lastExit; // layers as in gloss.comp
layout(rgba16f, binding = 0) uniform image2D radiance; // of cells
uniform ivec2 size; // posts
uniform vec3 towards; // unit: x east, y north, z up

void main()
{
    ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    if (cell.x >= size.x - 1 || cell.y >= size.y - 1)
        return;
    ShVector basis = shBasis(towards);
    vec3 glossy = vec3(0.0);
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c)
            for (int j = 0; j < 4; ++j)
                glossy[c] += 0.25 * dot(texelFetch(lastExit,
                                                   ivec3(cell + ivec2(i % 2, i / 2), 4 * c + j), 0),
                                        basis.c[j]);
    vec4 sent = imageLoad(radiance, cell);
    imageStore(radiance, cell,
               sent.a > 0.0 ? vec4(roundedToHalf(sent.rgb + glossy), sent.a) : vec4(0.0));
}
