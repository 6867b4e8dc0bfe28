// What the cells between posts send out. rgb = radiance, a = 1; a cell with a void corner: all 0.
//
// Light is received at posts, whose normals are their neighbours' mean; it is sent by the faces between
// them. At a cliff those are not alike: a face of one cell's width may be vertical where neither of its
// posts is. So direct light is found anew for the face, from its corners' horizons.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D albedo;       // one texel per post, or one for all
uniform sampler2D light;        // DIRECT: the shading, of which alpha is read; else irradiance / pi
layout(rgba16f, binding = 0) writeonly uniform image2D radiance; // cell (x, y): posts x, x + 1, y, y + 1

uniform ivec2 size; // posts
uniform int frame;
#ifdef DIRECT
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2DArray horizon; // elevation codes, layer k looks towards 2*pi*k/m from east
uniform int azimuths;
uniform float northSpacing; // [m]
uniform vec3 skyRadiance;   // 0 where there is none; SKY_TABLE: 1
uniform bool hasSky;
uniform vec3 sunIrradiance; // 0 where there is none
uniform vec3 sunDirection;
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
    Length corners[4];
    vec3 colour = vec3(0.0);
    vec4 received = vec4(0.0);
    bool valid = true;
    for (int i = 0; i < 4; ++i)
    {
        ivec2 post = cell + ivec2(i % 2, i / 2);
        corners[i] = postHeight(heights, post + frame);
        valid = valid && !isVoid(corners[i]);
        colour += 0.25 * albedoOf(post);
        received += 0.25 * texelFetch(light, post, 0);
    }
    if (!valid)
    {
        imageStore(radiance, cell, vec4(0.0));
        return;
    }
#ifdef DIRECT
    Length east = 0.5 * (texelFetch(eastSpacings, ivec2(0, cell.y), 0).x +
                         texelFetch(eastSpacings, ivec2(0, cell.y + 1), 0).x);
    vec3 normal = normalize(vec3(0.5 * (corners[0] + corners[2] - corners[1] - corners[3]) * northSpacing,
                                 0.5 * (corners[0] + corners[1] - corners[2] - corners[3]) * east,
                                 east * northSpacing));
    // The sun is sharp: what each corner sees of it, with the cell's normal there.
    received.rgb = vec3(0.0);
    for (int i = 0; i < 4; ++i)
    {
        vec3 corner = normalize(vec3((corners[i - i % 2] - corners[i - i % 2 + 1]) * northSpacing,
                                     (corners[i % 2] - corners[i % 2 + 2]) * east, east * northSpacing));
        received.rgb += sunIrradiance * (0.25 * texelFetch(light, cell + ivec2(i % 2, i / 2), 0).a *
                                         max(dot(corner, sunDirection), 0.0) / PI);
#ifdef KEY_LIGHTS
        received.rgb += 0.25 * keyLight(cell + ivec2(i % 2, i / 2), corner);
#endif
    }
    if (hasSky)
    {
        float width = 2.0 * PI / float(azimuths);
        SkyShare sum = SkyShare(0.0);
        for (int k = 0; k < azimuths; ++k)
        {
            float code = 0.0;
            for (int i = 0; i < 4; ++i)
                code += 0.25 * texelFetch(horizon, ivec3(cell + ivec2(i % 2, i / 2), k), 0).x;
            float phi = width * float(k);
            sum += skyShare(elevationOfCode(code), normal, cos(phi), sin(phi), width, k);
        }
        received.rgb += skyRadiance * sum;
    }
#endif
    imageStore(radiance, cell, vec4(roundedToHalf(colour * received.rgb), 1.0));
}
