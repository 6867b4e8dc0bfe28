// The ground of a tile, and a volume of distances to placed objects on it, for passes that gather
// light there. Nothing without AMONG_OBJECTS.
#ifdef AMONG_OBJECTS
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
uniform sampler3D volume;
// What the objects send, and what they leave of the ground's light and send to it, where `sending`:
// of object_radiosity.comp
uniform bool sending;
uniform sampler3D radiosity;
uniform sampler2D groundShare;
uniform float slabVoxels; // of a slab of `radiosity` along z
uniform int lampCount;
uniform vec4 lamps[16]; // centre [m] in the volume's frame, radius [m]
uniform vec3 lampRadiances[16];

uniform ivec2 size; // posts
uniform int frame;
uniform vec2 spacings; // [m] of columns and rows
uniform vec3 corner;   // of the volume [m]: from post (0, 0), above the tile's heightOrigin
uniform vec3 volumeSize; // [m]
uniform float voxel;     // [m]
uniform float reach;     // [m]
uniform vec3 contentLow; // [m] in the volume's frame
uniform vec3 contentHigh;
layout(std140, binding = 0) uniform Cones
{
    vec4 cones[34]; // axis about +z, sine; from 32 on: the fit, and (count, stride)
};
layout(std430, binding = 0) readonly buffer Around
{
    uint around[];
};

DistanceField objectField()
{
    DistanceField field;
    field.size = volumeSize;
    field.voxel = voxel;
    field.reach = reach;
    field.low = contentLow;
    field.high = contentHigh;
    return field;
}

// Column and row of the tile where a place of the volume, or the post next to it, is.
vec2 postsOf(vec2 metres)
{
    return clamp(metres / spacings, vec2(0.0), vec2(size - 1));
}

// Coordinate of the textures per post.
vec2 texelOf(vec2 place)
{
    return (place + 0.5) / vec2(size);
}

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
    vec2 texel = texelOf(place);
    float low = floor(at);
    float code = mix(textureLod(horizon, vec3(texel, mod(low, layers)), 0.0).x,
                     textureLod(horizon, vec3(texel, mod(low + 1.0, layers)), 0.0).x, at - low);
    // The sky's edge is the horizontal.
    return tan(clamp(elevationOfCode(code), 0.0, 1.5));
#else
    return 0.0;
#endif
}

// Radiance of the sky, or of a uniform one its share.
vec3 skyTowards(vec3 axis)
{
#ifdef SKY_PICTURE
    return textureLod(sky, vec2(fract(atan(axis.y, axis.x) / (2.0 * PI)),
                                asin(clamp(axis.z, 0.0, 1.0)) / HALF_PI), 0.0).rgb;
#else
    return vec3(1.0);
#endif
}

// Cones about a normal, and what they see. above: of each, the share above the terrain's horizon.
struct ConesSeen
{
    int count;
    vec4 axes[32];
    float above[32];
    ConesOpen seen;
};

// place: of the volume; post: column and row of the ground below.
ConesSeen lookAround(vec3 place, vec3 normal, vec2 post)
{
    ConesSeen all;
    all.count = int(cones[33].x);
    uint near[32];
    float weights[32];
    for (int i = 0; i < all.count; ++i)
    {
        all.axes[i] = vec4(aboutNormal(cones[i].xyz, normal), cones[i].w);
        near[i] = around[i];
        all.above[i] = coneAboveHorizon(all.axes[i].xyz, all.axes[i].w,
                                        horizonSlope(post, all.axes[i].xyz));
        weights[i] = 1.0;
    }
    all.seen = conesAmongObjects(volume, objectField(), place, normal, all.axes, near, weights,
                                 all.count, cones[33].y, cones[32]);
    return all;
}

// Mean over the cones of what the objects that hide them send, radiance: irradiance / pi.
vec3 sentByObjects(vec3 place, ConesSeen look)
{
    if (!sending)
        return vec3(0.0);
    AmbientCubes slabs;
    slabs.size = volumeSize;
    slabs.slabVoxels = slabVoxels;
    vec3 sent = vec3(0.0);
    DistanceField field = objectField();
    for (int i = 0; i < look.count; ++i)
        if (look.seen.light[i] < 0.999)
        {
            vec3 met = nearestOnObject(volume, field,
                                        place + look.axes[i].xyz * look.seen.along[i]);
            sent += (1.0 - look.seen.light[i]) *
                    ambientCubeRadiance(radiosity, slabs, met, -look.axes[i].xyz);
        }
    return sent / float(look.count);
}

// Irradiance / pi.
vec3 lampsOn(vec3 place, vec3 normal)
{
    vec3 light = vec3(0.0);
    for (int i = 0; i < lampCount; ++i)
        light += lampRadiances[i] * lampAmongObjects(volume, objectField(), place, normal,
                                                     lamps[i].xyz, lamps[i].w);
    return light;
}

// Irradiance / pi by the sun that a normal receives; seen: the fraction that the terrain leaves.
vec3 sunOn(vec3 place, vec3 normal, float seen)
{
#ifdef SUN_AMONG_OBJECTS
    float facing = dot(normal, sunDirection);
    if (facing <= 0.0 || seen <= 0.0)
        return vec3(0.0);
    return sunIrradiance * (seen * facing / PI *
                            discAmongObjects(volume, objectField(), place, normal, sunDirection,
                                             sin(sunRadius), 1.0e30));
#else
    return vec3(0.0);
#endif
}

// What objects leave of the light of the ground, and send to it, over what it has without them; a:
// of the visible fraction of the sun. height: of the ground above the tile's heightOrigin.
vec4 shareOfGround(vec2 metres, float height)
{
    vec2 place = postsOf(metres);
    vec3 at = vec3(metres, height) - corner;
    vec3 normal = normalAt(place);
    ConesSeen look = lookAround(at, normal, place);
    vec3 sky = vec3(0.0);
    vec3 skyLeft = vec3(0.0);
    float ground = 1.0e-6;
    float groundLeft = 1.0e-6;
    for (int i = 0; i < look.count; ++i)
    {
        vec3 radiance = skyTowards(look.axes[i].xyz) * look.above[i];
        sky += radiance;
        skyLeft += radiance * look.seen.light[i];
        ground += 1.0 - look.above[i];
        groundLeft += (1.0 - look.above[i]) * look.seen.light[i];
    }
    vec3 ofSky = mix(vec3(1.0), skyLeft / max(sky, vec3(1.0e-20)), greaterThan(sky, vec3(0.0)));
    float ofGround = groundLeft / ground;

    vec2 coordinate = texelOf(place);
    vec4 light = textureLod(direct, coordinate, 0.0);
    vec3 bounced = max(textureLod(shading, coordinate, 0.0).rgb - light.rgb, vec3(0.0));
    vec3 sun = vec3(0.0);
    float ofSun = 1.0;
#ifdef SUN_AMONG_OBJECTS
    float facing = dot(normal, sunDirection);
    sun = min(sunIrradiance * (light.a * max(facing, 0.0) / PI), light.rgb);
    if (facing > 0.0)
        ofSun = discAmongObjects(volume, objectField(), at, normal, sunDirection, sin(sunRadius),
                                 1.0e30);
#endif
    vec3 fromSky = max(light.rgb - sun, vec3(0.0));
    vec3 all = fromSky + sun + bounced;
    vec3 left = fromSky * ofSky + sun * ofSun + bounced * ofGround + sentByObjects(at, look) +
                lampsOn(at, normal);
    // A lamp may give ten thousand times what is there without it, which half floats hold.
    vec3 share = left / max(all, max(1.0e-4 * left, vec3(1.0e-20)));
    return vec4(mix(ofSky, share, greaterThan(all, vec3(1.0e-12))), ofSun);
}
#endif
