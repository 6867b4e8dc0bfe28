// What cells send out in the mean, for glossy ground. rgb = radiance, a = 1; a cell with a void
// corner: all 0.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D faces; // of faces.comp
#ifdef SUN
uniform sampler2D albedo; // one texel per post, or one for all
#endif
// cell (x, y): posts x, x + 1, y, y + 1
layout(rgba16f, binding = 0) writeonly uniform image2D radiance;

uniform ivec2 size; // posts

void main()
{
    ivec2 cell = ivec2(INVOCATION.xy);
    if (cell.x >= size.x - 1 || cell.y >= size.y - 1)
        return;
    vec3 sent = vec3(0.0);
    vec4 facing;
    for (int i = 0; i < 4; ++i)
    {
        vec4 corner = texelFetch(faces, 2 * cell + 1 + ivec2(i % 2, i / 2), 0);
        sent += 0.25 * corner.rgb;
        facing[i] = corner.a;
    }
#ifdef SUN
    vec3 colour = vec3(0.0);
    for (int i = 0; i < 4; ++i)
    {
        ivec2 post = min(cell + ivec2(i % 2, i / 2), textureSize(albedo, 0) - 1);
        colour += 0.25 * texelFetch(albedo, post, 0).rgb;
    }
    sent += colour * sunOnCell(cell, facing);
#endif
    imageStore(radiance, cell, facing.x > 0.0 ? vec4(roundedToHalf(sent), 1.0) : vec4(0.0));
}
