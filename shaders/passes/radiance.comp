// What the cells between posts send out. rgb = radiance; a > 0: 1, or with the SUN what the cell
// receives of it in the mean, irradiance / pi over sunIrradiance, at least 2^-14. A cell with a
// void corner: all 0.
//
// Light is received at posts, whose normals are their neighbours' mean; it is sent by the faces
// between them. At a cliff those are not alike: a face of one cell's width may be vertical where
// neither of its posts is. So direct light is found anew for the face, from its corners' horizons.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D albedo;       // one texel per post, or one for all
#ifndef DIRECT
uniform sampler2D light; // irradiance / pi
#endif
// cell (x, y): posts x, x + 1, y, y + 1
layout(rgba16f, binding = 0) writeonly uniform image2D radiance;

uniform ivec2 size; // posts
uniform int frame;
#ifdef DIRECT
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2DArray horizon; // elevation codes, layer k looks towards 2*pi*k/m from east
uniform int azimuths;
uniform float northSpacing; // [m]
#endif

vec3 albedoOf(ivec2 post)
{
    return texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
}

void main()
{
    ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    if (cell.x >= size.x - 1 || cell.y >= size.y - 1)
        return;
    vec4 corners;
    vec3 colour = vec3(0.0);
    vec3 received = vec3(0.0);
    float mark = 1.0;
    bool valid = true;
    for (int i = 0; i < 4; ++i)
    {
        ivec2 post = cell + ivec2(i % 2, i / 2);
        corners[i] = postHeight(heights, post + frame);
        valid = valid && !isVoid(corners[i]);
        colour += 0.25 * albedoOf(post);
#ifndef DIRECT
        received += 0.25 * texelFetch(light, post, 0).rgb;
#endif
    }
    if (!valid)
    {
        imageStore(radiance, cell, vec4(0.0));
        return;
    }
#ifdef DIRECT
    Length east = 0.5 * (texelFetch(eastSpacings, ivec2(0, cell.y), 0).x +
                         texelFetch(eastSpacings, ivec2(0, cell.y + 1), 0).x);
    vec3 normal = cellNormal(corners, 0.5, 0.5, east, northSpacing);
    float sun = sunOnCell(cell, corners, east, northSpacing);
    received = directLightOnCell(cell, corners, east, northSpacing, sun);
    mark = SUN_IN_CELLS ? max(sun, exp2(-14.0)) : 1.0;
    if (hasSky)
        received += skyOnCell(horizon, azimuths, cell, normal);
#endif
    imageStore(radiance, cell, vec4(roundedToHalf(colour * received), roundedToHalf(vec3(mark)).x));
}
