// One bounce of diffuse light: what a post receives from the terrain it sees (MATHS, "One slice,
// exactly"; casting set of Nowrouzezahrai and Snyder 2009, section 3). Sub-sampled it is two
// passes. FAR: at one post of every block, what samples beyond the first `exact` send, as a mean
// per azimuth. NEAR: at every post, its own cells and the first samples; the rest of each slice, up
// to the post's own horizon, sends the mean of the blocks about it. So only radiance is
// interpolated: planes, normals and horizons are each post's own, and no light is made.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2D stepLengths;  // R32F [m]: ground length of a step of azimuth x in row y
uniform sampler2D albedo;       // one texel per post, or one for all
uniform sampler2D radiance;     // of radiance.comp
uniform sampler2D heightPyramid;   // RG32F: height times weight, weight
uniform sampler2D radiancePyramid; // RGBA16F: radiance times weight, weight
uniform sampler2DArray horizon; // elevation codes, layer k looks towards 2*pi*k/m from east
#ifdef FAR
// A texel per block, a layer per azimuth: radiance times weight, weight; the weight is what the
// slice's part gives the block's post of a radiance of 1, times azimuths.
layout(rgba16f, binding = 0) writeonly uniform image2DArray farRadiance;
#else
layout(rgba16f, binding = 0) writeonly uniform image2D light; // irradiance / pi of this bounce
#ifdef DIRECT
uniform sampler2D direct; // of which alpha is read, the sun's visible fraction
#else
uniform sampler2D lastLight; // irradiance / pi of the last bounce
#endif
#endif
#ifdef NEAR
uniform sampler2DArray farRadiance;
#endif
uniform int stride; // posts a side of a block
uniform int exact;  // samples; at most nearCount

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform float northSpacing; // [m]
layout(std140, binding = 0) uniform Rays
{
    vec4 directions[256]; // drift along the minor axis per step, look, 1 where north, -
    // Along a ray: distance [steps] and level of a sample's height, the same of the radiance
    // between it and the sample before. The first nearCount are whole steps and read posts.
    vec4 samples[128];
};
uniform int nearCount;
uniform int sampleCount;
// x, y, width, height in the pyramids' textures; the first is not used.
uniform ivec4 heightLevels[16];
uniform ivec4 radianceLevels[16];

#ifdef DIRECT
#ifndef FAR
// Direct irradiance / pi of the corners of the four cells that meet at a post, south-west,
// south-east, north-west, north-east: each with that cell's normal there. Beside a void: 0.
FourLights lightOfCorners(ivec2 post, Length here, Length east, float visible)
{
    vec3 normals[4];
    float whole[4];
    for (int i = 0; i < 4; ++i)
    {
        ivec2 side = ivec2(i % 2, i / 2) * 2 - 1;
        Length besideX = postHeight(heights, post + frame + ivec2(side.x, 0));
        Length besideY = postHeight(heights, post + frame + ivec2(0, side.y));
        whole[i] = isVoid(besideX) || isVoid(besideY) ? 0.0 : 1.0;
        normals[i] = normalize(vec3(float(side.x) * whole[i] * (here - besideX) * northSpacing,
                                    float(side.y) * whole[i] * (here - besideY) * east,
                                    east * northSpacing));
    }
    FourLights sky = skyOnPost(horizon, azimuths, post, normals);
    FourLights corners;
    for (int i = 0; i < 4; ++i)
        corners.light[i] = whole[i] * directLight(post, normals[i], sky.light[i], visible);
    return corners;
}
#endif
#endif

vec3 sentByCell(vec2 place)
{
    return texelFetch(radiance, clamp(ivec2(floor(place)), ivec2(0), size - 2), 0).rgb;
}

#ifdef DIRECT
// The same with the sun's light of that place of the cell instead of the cell's mean.
vec3 sentAt(vec2 place, Length east)
{
    if (!SUN_IN_CELLS)
        return sentByCell(place);
    ivec2 cell = clamp(ivec2(floor(place)), ivec2(0), size - 2);
    vec2 inside = clamp(place - vec2(cell), 0.0, 1.0);
    vec4 sent = texelFetch(radiance, cell, 0);
    vec4 corners;
    for (int i = 0; i < 4; ++i)
        corners[i] = postHeight(heights, cell + ivec2(i % 2, i / 2) + frame);
    vec3 normal = cellNormal(corners, inside.x, inside.y, east, northSpacing);
    float share = sunInCell(cell, inside, normal);
    ivec2 nearest = min(cell + ivec2(inside + 0.5), textureSize(albedo, 0) - 1);
    vec3 more = texelFetch(albedo, nearest, 0).rgb * sunIrradiance * (share - sent.a);
    return sent.a > 0.0 ? max(sent.rgb + more, 0.0) : vec3(0.0);
}
#else
vec3 sentAt(vec2 place, Length east)
{
    return sentByCell(place);
}
#endif

// The post that light is gathered at.
struct Receiver
{
    ivec2 post;
    Length here;
    Length east; // [m] between columns
    vec3 normal;
};

// A slice of azimuth from a receiver.
struct Slice
{
    GridRay ray;
    Length stepLength;
    Slope cap; // slope of the horizon
    float width;
};

// Sample `i` < nearCount, which reads posts.
SliceGather addNear(SliceGather gathered, Receiver receiver, Slice slice, int i)
{
    Length height = heightAtStep(heights, receiver.post, slice.ray, int(samples[i].x), size, frame);
    vec2 between = vec2(receiver.post) + samples[i].z * slice.ray.step;
    vec3 sent = sentAt(between, receiver.east);
    Slope slope = (height - receiver.here) / (samples[i].x * slice.stepLength);
    return addSegment(gathered, slope, sent, slice.cap, slice.width);
}

#ifndef NEAR
// Sample `i` >= nearCount, which reads the pyramids.
SliceGather addFar(SliceGather gathered, Receiver receiver, Slice slice, int i)
{
    vec2 place = vec2(receiver.post) + samples[i].x * slice.ray.step;
    int number = int(samples[i].y);
    vec2 texel = pyramidTexel(heightLevels[number], place, number);
    vec2 scale = 1.0 / vec2(textureSize(heightPyramid, 0));
    Length height = pyramidHeight(textureLod(heightPyramid, texel * scale, 0.0).xy);
    number = int(samples[i].w);
    texel = cellPyramidTexel(radianceLevels[number],
                             vec2(receiver.post) + samples[i].z * slice.ray.step, number);
    scale = 1.0 / vec2(textureSize(radiancePyramid, 0));
    vec4 sent = textureLod(radiancePyramid, texel * scale, 0.0);
    Slope slope = (height - receiver.here) / (samples[i].x * slice.stepLength);
    slope = onSurface(place, size, 0.0) ? slope : NO_HORIZON;
    return addSegment(gathered, slope, sent.rgb / max(sent.a, 1.0e-3), slice.cap, slice.width);
}
#endif

#ifdef NEAR
// The blocks about a post, and how much each counts there.
struct Blocks
{
    ivec2 at[4];
    float weights[4];
};

Blocks blocksAbout(Receiver receiver)
{
    Blocks blocks;
    for (int i = 0; i < 4; ++i)
    {
        ivec2 corner = ivec2(i % 2, i / 2);
        blocks.at[i] = min(receiver.post / stride + corner, (size - 1) / stride);
        ivec2 gathered = postOfBlock(heights, blocks.at[i], stride, size, frame);
        Length height = postHeight(heights, gathered + frame);
        vec3 across = vec3(vec2(gathered - receiver.post) * vec2(receiver.east, northSpacing),
                           isVoid(height) ? 0.0 : height - receiver.here);
        vec2 share = vec2(receiver.post % stride) / float(stride);
        blocks.weights[i] = blockWeight(corner, share, across, receiver.normal,
                                        max(receiver.east, northSpacing));
    }
    return blocks;
}

// What they say that terrain beyond the near samples sends; `otherwise` where none knows.
vec3 sentBeyond(Blocks blocks, int k, vec3 otherwise)
{
    vec4 beyond = vec4(0.0);
    for (int i = 0; i < 4; ++i)
        beyond += blocks.weights[i] * texelFetch(farRadiance, ivec3(blocks.at[i], k), 0);
    return beyond.a > 1.0e-4 ? beyond.rgb / beyond.a : otherwise;
}
#endif

Slice sliceOf(Receiver receiver, int k)
{
    vec4 direction = directions[k];
    Slice slice;
    slice.ray = gridRay(direction.x, int(direction.y), direction.z != 0.0);
    slice.stepLength = texelFetch(stepLengths, ivec2(k, receiver.post.y), 0).x;
    slice.cap = slopeOfCode(texelFetch(horizon, ivec3(receiver.post, k), 0).x);
    slice.width = 2.0 * PI / float(azimuths);
    return slice;
}

// Up to the cell that a post stands on, which is much of what the post sees.
SliceGather startSlice(Receiver receiver, Slice slice, vec3 own, float cosine, float sine)
{
    SliceGather gathered =
        startGather(planeSlope(receiver.normal, cosine, sine), own, slice.width);
    Slope slope = ownCellSlope(heights, receiver.post + frame, receiver.here, slice.ray);
    return addSegment(gathered, slope / slice.stepLength, own, slice.cap, slice.width);
}

Receiver receiverAt(ivec2 post)
{
    Receiver receiver;
    receiver.post = post;
    receiver.here = postHeight(heights, post + frame);
    receiver.east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    receiver.normal = postNormal(heights, post + frame, receiver.east, northSpacing);
    return receiver;
}

#ifdef FAR
void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (block.x * stride >= size.x || block.y * stride >= size.y)
        return;
    Receiver receiver = receiverAt(postOfBlock(heights, block, stride, size, frame));
    vec3 normal = receiver.normal;
    for (int k = 0; k < azimuths; ++k)
    {
        if (isVoid(receiver.here))
        {
            imageStore(farRadiance, ivec3(block, k), vec4(0.0));
            continue;
        }
        Slice slice = sliceOf(receiver, k);
        float cosine = cos(slice.width * float(k));
        float sine = sin(slice.width * float(k));
        // The near part is not counted, but what is sent up to the crest if no sample is seen.
        vec3 own = sentByCell(vec2(receiver.post + min(slice.ray.major + slice.ray.side, 0)));
        SliceGather gathered = startSlice(receiver, slice, own, cosine, sine);
        for (int i = 0; i < exact; ++i)
            gathered = addNear(gathered, receiver, slice, i);
        vec2 start = gathered.moments;
        gathered = countFromHere(gathered);
        for (int i = exact; i < nearCount; ++i)
            gathered = addNear(gathered, receiver, slice, i);
        for (int i = nearCount; i < sampleCount; ++i)
            gathered = addFar(gathered, receiver, slice, i);
        gathered = closeGather(gathered, slice.cap, slice.width);
        // The moments of all of it. Rounding may leave them a little below 0.
        float nh = normal.x * cosine + normal.y * sine;
        vec2 all = start - gathered.moments;
        float weight = max(normal.z * all.x + nh * all.y, 0.0);
        vec3 sent = max(normal.z * gathered.upward + nh * gathered.outward, vec3(0.0));
        imageStore(farRadiance, ivec3(block, k),
                   vec4(roundedToHalf(float(azimuths) * sent),
                        roundedToHalf(vec3(float(azimuths) * weight)).x));
    }
}
#else
void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Receiver receiver = receiverAt(post);
    if (isVoid(receiver.here))
    {
        imageStore(light, post, vec4(0.0));
        return;
    }
    vec3 colour = texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
#ifdef DIRECT
    float visible = texelFetch(direct, post, 0).a;
    FourLights corners = lightOfCorners(post, receiver.here, receiver.east, visible);
#else
    vec3 bounced = texelFetch(lastLight, post, 0).rgb;
#endif
#ifdef NEAR
    Blocks blocks = blocksAbout(receiver);
#endif
    mat3 sum = mat3(0.0); // a vector per colour
    for (int k = 0; k < azimuths; ++k)
    {
        Slice slice = sliceOf(receiver, k);
        float cosine = cos(slice.width * float(k));
        float sine = sin(slice.width * float(k));
#ifdef DIRECT
        ivec2 quadrant = max(slice.ray.major + slice.ray.side, ivec2(0));
        vec3 own = colour * corners.light[quadrant.x + 2 * quadrant.y];
#else
        vec3 own = colour * bounced;
#endif
        SliceGather gathered = startSlice(receiver, slice, own, cosine, sine);
#ifdef NEAR
        for (int i = 0; i < exact; ++i)
            gathered = addNear(gathered, receiver, slice, i);
        gathered.last = sentBeyond(blocks, k, gathered.last);
#else
        for (int i = 0; i < nearCount; ++i)
            gathered = addNear(gathered, receiver, slice, i);
        for (int i = nearCount; i < sampleCount; ++i)
            gathered = addFar(gathered, receiver, slice, i);
#endif
        gathered = closeGather(gathered, slice.cap, slice.width);
        for (int c = 0; c < 3; ++c)
            sum[c] += vec3(cosine * gathered.outward[c], sine * gathered.outward[c],
                           gathered.upward[c]);
    }
    sum /= PI;
    vec3 received = receiver.normal * sum;
    imageStore(light, post, vec4(roundedToHalf(received), 1.0));
}
#endif
