// What the faces between posts send out, at their corners: each of a cell's four has its own light,
// and between them it is bilinear. Along a wall of one cell's width light varies as much as along a
// slope of many posts. The sun's is not in it: its edges go through cells, and who sees a place of
// a cell finds it there (lights/sun.glsl).
//
// Light is received at posts, whose normals are their neighbours' mean; it is sent by the faces
// between them. At a cliff those are not alike: a face of one cell's width may be vertical where
// neither of its posts is. DIRECT light is found anew, for each face's own normal at the post; what
// a bounce brought to a post its faces have by the part of their view that terrain fills.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2D albedo;       // one texel per post, or one for all
// elevation codes, layer k looks towards 2*pi*k/m from east
layout(r16) readonly uniform image2DArray horizon;
#ifndef DIRECT
uniform sampler2D light; // irradiance / pi
#endif
// texel (2x + i, 2y + j): post (x, y) as a corner of the cell to its west (i = 0) or east, to its
// south (j = 0) or north. rgb = radiance, a = sunFacing(), or 1 where not DIRECT; a cell with a
// void corner: all 0
layout(rgba16f, binding = 0) writeonly uniform image2D faces;

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform float northSpacing; // [m]

// Where in the cell a corner's normal is: a little inside, since in a twisted cell the corners' own
// are those of no more than themselves.
const float INSIDE = 0.2;

#ifndef DIRECT
// The most by which a face sees more of what a post received than the post.
const float MOST_MORE = 8.0;

// Irradiance by terrain of radiance 1, of surfaces of five normals.
float[5] terrainViews(ivec2 post, vec3 normals[5])
{
    float views[5] = float[5](0.0, 0.0, 0.0, 0.0, 0.0);
    float width = 2.0 * PI / float(azimuths);
    for (int k = 0; k < azimuths; ++k)
    {
        float cosine = cos(width * float(k));
        float sine = sin(width * float(k));
        Slope cap = slopeOfCode(imageLoad(horizon, ivec3(post, k)).x);
        vec2 above = sliceMoments(cap, width);
        for (int i = 0; i < 5; ++i)
        {
            Slope plane = planeSlope(normals[i], cosine, sine);
            vec2 terrain = sliceMoments(min(plane, cap), width) - above;
            views[i] += dot(terrain, vec2(normals[i].z,
                                          normals[i].x * cosine + normals[i].y * sine));
        }
    }
    return views;
}
#endif

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    bool whole[4];
    vec3 normals[4];
    for (int i = 0; i < 4; ++i)
    {
        ivec2 side = ivec2(i % 2, i / 2) * 2 - 1;
        Length besideX = postHeight(heights, post + frame + ivec2(side.x, 0));
        Length besideY = postHeight(heights, post + frame + ivec2(0, side.y));
        Length across = postHeight(heights, post + frame + side);
        whole[i] = !isVoid(min(min(here, besideX), min(besideY, across)));
        vec2 rise = vec2(mix(besideX - here, across - besideY, INSIDE),
                         mix(besideY - here, across - besideX, INSIDE));
        rise = whole[i] ? rise * vec2(side) : vec2(0.0);
        normals[i] =
            normalize(vec3(-rise.x * northSpacing, -rise.y * east, east * northSpacing));
    }
    FourLights received;
#ifdef DIRECT
    received = skyOnPost(horizon, azimuths, post, normals);
    for (int i = 0; i < 4; ++i)
        received.light[i] = directLight(post, normals[i], received.light[i], 0.0);
#else
    float views[5] = terrainViews(
        post, vec3[5](normals[0], normals[1], normals[2], normals[3],
                      postNormal(heights, post + frame, east, northSpacing)));
    for (int i = 0; i < 4; ++i)
        received.light[i] = texelFetch(light, post, 0).rgb *
                            min(views[i] / max(views[4], 1.0e-6), MOST_MORE);
#endif
    vec3 colour = texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
    for (int i = 0; i < 4; ++i)
    {
#ifdef DIRECT
        float facing = roundedToHalf(vec3(sunFacing(normals[i]))).x;
#else
        float facing = 1.0;
#endif
        imageStore(faces, 2 * post + ivec2(i % 2, i / 2),
                   whole[i] ? vec4(roundedToHalf(colour * received.light[i]), facing) : vec4(0.0));
    }
}
