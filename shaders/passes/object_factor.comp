// What placed objects leave of the light of the ground around them: a texel is a place on the
// ground, much nearer to the next than posts are. rgb: of the light of the shading texture; a: of
// the visible fraction of the sun. Exactly 1 where no cone meets an object.
//
// Each kind of light has a part of its own: the sky above the terrain's horizon through cones, each
// cut by that horizon, what comes from terrain below it likewise, and the sun by a ray.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D direct;  // a texel per post: irradiance / pi, visible fraction of the sun
uniform sampler2D shading; // the same with bounces
#ifdef HORIZON
uniform sampler2DArray horizon; // elevation codes, layer k looks towards 2*pi*k/azimuths from east
#endif
#ifdef SKY_PICTURE
// RGBA32F, radiance: columns counter-clockwise from east, rows from the horizontal to the zenith
uniform sampler2D sky;
#endif
uniform bool known; // whether the volume is there
uniform sampler3D volume;
layout(rgba16f, binding = 0) writeonly uniform image2D factor;

uniform ivec2 size; // posts
uniform int frame;
uniform vec2 spacings; // [m] of columns and rows
uniform vec3 corner;   // of the volume [m]: from post (0, 0), above the tile's heightOrigin
uniform vec3 volumeSize; // [m]
uniform float voxel;     // [m]
uniform float reach;     // [m]
uniform vec3 contentLow; // [m] in the volume's frame
uniform vec3 contentHigh;
uniform vec2 first;   // centre of texel (0, 0) [m from post (0, 0)]
uniform float pitch;  // of texels [m]
uniform ivec2 texels; // of this volume ...
uniform int row;      // ... from this row on
layout(std140, binding = 0) uniform Cones
{
    vec4 cones[34]; // axis about +z, sine; from 32 on: the fit, and (count, stride)
};
layout(std430, binding = 0) readonly buffer Around
{
    uint around[];
};
vec3 normalAt(vec2 place)
{
    vec2 low = clamp(floor(place), vec2(0.0), vec2(max(size - 2, 0)));
    vec2 part = clamp(place - low, 0.0, 1.0);
    vec3 normal = vec3(0.0);
    for (int i = 0; i < 4; ++i)
    {
        ivec2 post = min(ivec2(low) + ivec2(i % 2, i / 2), size - 1);
        vec2 weight = mix(1.0 - part, part, vec2(i % 2, i / 2));
        normal += weight.x * weight.y *
                  postNormal(heights, post + frame, spacings.x, spacings.y);
    }
    return normalize(normal);
}

// Slope of the terrain's horizon in the azimuth of a direction.
Slope horizonSlope(vec2 place, vec3 axis)
{
#ifdef HORIZON
    float layers = float(textureSize(horizon, 0).z);
    float at = fract(atan(axis.y, axis.x) / (2.0 * PI)) * layers;
    vec2 texel = (place + 0.5) / vec2(size);
    float low = floor(at);
    float code = mix(textureLod(horizon, vec3(texel, mod(low, layers)), 0.0).x,
                     textureLod(horizon, vec3(texel, mod(low + 1.0, layers)), 0.0).x, at - low);
    // The sky's edge is the horizontal.
    return tan(clamp(elevationOfCode(code), 0.0, 1.5));
#else
    return 0.0;
#endif
}

vec3 skyTowards(vec3 axis)
{
#ifdef SKY_PICTURE
    return textureLod(sky, vec2(atan(axis.y, axis.x) / (2.0 * PI) + 1.0,
                                asin(clamp(axis.z, 0.0, 1.0)) / HALF_PI), 0.0).rgb;
#else
    return vec3(1.0);
#endif
}

void main()
{
    ivec2 texel = ivec2(INVOCATION.xy);
    if (texel.x >= texels.x || texel.y >= texels.y)
        return;
    vec2 metres = first + vec2(texel) * pitch;
    vec2 place = clamp(metres / spacings, vec2(0.0), vec2(size - 1));
    vec2 rise = riseBetweenPosts(heights, place, size, frame, 0.0);
    ivec2 to = texel + ivec2(0, row);
    if (rise.y <= 0.5 || !known)
    {
        imageStore(factor, to, vec4(1.0));
        return;
    }
    vec3 at = vec3(metres, rise.x / rise.y) - corner;
    vec3 normal = normalAt(place);

    DistanceField field;
    field.size = volumeSize;
    field.voxel = voxel;
    field.reach = reach;
    field.low = contentLow;
    field.high = contentHigh;

    int count = int(cones[33].x);
    vec4 axes[32];
    uint near[32];
    float weights[32];
    float aboveHorizon[32];
    for (int i = 0; i < count; ++i)
    {
        axes[i] = vec4(aboutNormal(cones[i].xyz, normal), cones[i].w);
        near[i] = around[i];
        aboveHorizon[i] =
            coneAboveHorizon(axes[i].xyz, axes[i].w, horizonSlope(place, axes[i].xyz));
        weights[i] = 1.0;
    }
    ConesOpen seen = conesAmongObjects(volume, field, at, normal, axes, near, weights, count,
                                       cones[33].y, cones[32]);
    vec3 sky = vec3(0.0);
    vec3 skyLeft = vec3(0.0);
    float ground = 1.0e-6;
    float groundLeft = 1.0e-6;
    for (int i = 0; i < count; ++i)
    {
        vec3 radiance = skyTowards(axes[i].xyz) * aboveHorizon[i];
        sky += radiance;
        skyLeft += radiance * seen.light[i];
        ground += 1.0 - aboveHorizon[i];
        groundLeft += (1.0 - aboveHorizon[i]) * seen.light[i];
    }
    vec3 ofSky = mix(vec3(1.0), skyLeft / max(sky, vec3(1.0e-20)), greaterThan(sky, vec3(0.0)));
    float ofGround = groundLeft / ground;

    vec2 coordinate = (place + 0.5) / vec2(size);
    vec4 light = textureLod(direct, coordinate, 0.0);
    vec3 bounced = max(textureLod(shading, coordinate, 0.0).rgb - light.rgb, vec3(0.0));
    vec3 sun = vec3(0.0);
    float ofSun = 1.0;
#ifdef SUN_AMONG_OBJECTS
    float facing = dot(normal, sunDirection);
    sun = min(sunIrradiance * (light.a * max(facing, 0.0) / PI), light.rgb);
    if (facing > 0.0)
        ofSun = discAmongObjects(volume, field, at, normal, sunDirection, sin(sunRadius));
#endif
    vec3 fromSky = max(light.rgb - sun, vec3(0.0));
    vec3 all = fromSky + sun + bounced;
    vec3 left = fromSky * ofSky + sun * ofSun + bounced * ofGround;
    vec3 share = mix(ofSky, left / max(all, vec3(1.0e-20)), greaterThan(all, vec3(1.0e-12)));
    // The last texels lead over to ground that knows of no object.
    vec2 inside = min(vec2(texel), vec2(texels - 1 - texel)) / 8.0;
    float known = clamp(min(inside.x, inside.y), 0.0, 1.0);
    imageStore(factor, to, mix(vec4(1.0), vec4(share, ofSun), known));
}
