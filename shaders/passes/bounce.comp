// One bounce of diffuse light: what a post receives from the terrain it sees (MATHS, "One slice,
// exactly"; casting set of Nowrouzezahrai and Snyder 2009, section 3). Sub-sampled it is two passes. FAR:
// at one post of every block, what samples beyond the first `exact` send, as a mean per azimuth. NEAR: at
// every post, its own cells and the first samples; the rest of each slice, up to the post's own horizon,
// sends the mean of the blocks about it. So only radiance is interpolated: planes, normals and horizons are
// each post's own, and no light is made.
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
// A texel per block, a layer per azimuth: radiance times weight, weight; the weight is what the slice's part
// gives the block's post of a radiance of 1, times azimuths.
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
    // Along a ray: distance [steps] and level of a sample's height, the same of the radiance between it
    // and the sample before. The first nearCount are whole steps and read posts.
    vec4 samples[128];
};
uniform int nearCount;
uniform int sampleCount;
// x, y, width, height in the pyramids' textures; the first is not used.
uniform ivec4 heightLevels[16];
uniform ivec4 radianceLevels[16];

#ifdef DIRECT
#ifndef FAR
uniform bool hasSky;
uniform vec3 skyRadiance; // SKY_TABLE: 1

// Direct irradiance / pi of the corners of the four cells that meet at a post, south-west, south-east,
// north-west, north-east: each with that cell's normal there. Beside a void: 0.
struct CornerLight
{
    vec3 light[4];
};

CornerLight lightOfCorners(ivec2 post, Length here, Length east, float visible)
{
    vec3 normals[4];
    SkyShare sky[4];
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
        sky[i] = SkyShare(0.0);
    }
    float width = 2.0 * PI / float(azimuths);
    for (int k = 0; k < (hasSky ? azimuths : 0); ++k)
    {
        float phi = width * float(k);
        Angle elevation = elevationOfCode(texelFetch(horizon, ivec3(post, k), 0).x);
        for (int i = 0; i < 4; ++i)
            sky[i] += skyShare(elevation, normals[i], cos(phi), sin(phi), width, k);
    }
    CornerLight corners;
    for (int i = 0; i < 4; ++i)
        corners.light[i] = whole[i] * skyRadiance * sky[i];
#ifdef SUN
    for (int i = 0; i < 4; ++i)
        corners.light[i] +=
            whole[i] * sunIrradiance * (visible * max(dot(normals[i], sunDirection), 0.0) / PI);
#endif
#ifdef KEY_LIGHTS
    for (int i = 0; i < 4; ++i)
        corners.light[i] += whole[i] * keyLight(post, normals[i]);
#endif
    return corners;
}
#endif

#ifdef SUN
// What a cell sends out, with the sun's light of one place of it instead of the cell's mean.
vec3 sentAt(vec2 place, Length east)
{
    ivec2 cell = clamp(ivec2(floor(place)), ivec2(0), size - 2);
    vec2 inside = clamp(place - vec2(cell), 0.0, 1.0);
    vec4 sent = texelFetch(radiance, cell, 0);
    vec4 corners;
    for (int i = 0; i < 4; ++i)
        corners[i] = postHeight(heights, cell + ivec2(i % 2, i / 2) + frame);
    vec3 normal = cellNormal(corners, inside.x, inside.y, east, northSpacing);
    float share = discOnCell(sunAboveCorners(cell), inside.x, inside.y, sunRadius, normal, sunDirection);
    ivec2 nearest = min(cell + ivec2(inside + 0.5), textureSize(albedo, 0) - 1);
    vec3 more = texelFetch(albedo, nearest, 0).rgb * sunIrradiance * (share - sent.a);
    return sent.a > 0.0 ? max(sent.rgb + more, 0.0) : vec3(0.0);
}
#endif
#endif

void main()
{
    ivec2 id = ivec2(gl_GlobalInvocationID.xy);
#ifdef FAR
    ivec2 post = id * stride;
#else
    ivec2 post = id;
#endif
    if (post.x >= size.x || post.y >= size.y)
        return;
#ifdef FAR
    post = postOfBlock(heights, id, stride, size, frame);
#endif
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
    {
#ifdef FAR
        for (int k = 0; k < azimuths; ++k)
            imageStore(farRadiance, ivec3(id, k), vec4(0.0));
#else
        imageStore(light, post, vec4(0.0));
#endif
        return;
    }
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    vec3 normal = postNormal(heights, post + frame, east, northSpacing);
#ifndef FAR
    vec3 colour = texelFetch(albedo, min(post, textureSize(albedo, 0) - 1), 0).rgb;
#ifdef DIRECT
    CornerLight corners = lightOfCorners(post, here, east, texelFetch(direct, post, 0).a);
#else
    vec3 bounced = texelFetch(lastLight, post, 0).rgb;
#endif
#endif
#ifdef NEAR
    ivec2 blocks[4];
    float weights[4];
    for (int i = 0; i < 4; ++i)
    {
        ivec2 corner = ivec2(i % 2, i / 2);
        blocks[i] = min(post / stride + corner, (size - 1) / stride);
        ivec2 gathered = postOfBlock(heights, blocks[i], stride, size, frame);
        Length height = postHeight(heights, gathered + frame);
        vec3 across = vec3(vec2(gathered - post) * vec2(east, northSpacing),
                           isVoid(height) ? 0.0 : height - here);
        vec2 share = vec2(post % stride) / float(stride);
        weights[i] = blockWeight(corner, share, across, normal, max(east, northSpacing));
    }
#endif
    vec2 heightScale = 1.0 / vec2(textureSize(heightPyramid, 0));
    vec2 radianceScale = 1.0 / vec2(textureSize(radiancePyramid, 0));
    float width = 2.0 * PI / float(azimuths);
    mat3 sum = mat3(0.0); // a vector per colour
    for (int k = 0; k < azimuths; ++k)
    {
        vec4 direction = directions[k];
        int look = int(direction.y);
        bool north = direction.z != 0.0;
        float drift = direction.x * float(look);
        ivec2 major = north ? ivec2(0, look) : ivec2(look, 0);
        ivec2 minor = north ? ivec2(1, 0) : ivec2(0, 1);
        vec2 step = vec2(major) + drift * vec2(minor);
        Length stepLength = texelFetch(stepLengths, ivec2(k, post.y), 0).x;
        float code = texelFetch(horizon, ivec3(post, k), 0).x;
        Angle elevation = elevationOfCode(max(code, 1.0 / 65535.0));
        Slope cap = tan(clamp(elevation, -1.57, 1.57));
        float phi = width * float(k);
        float cosine = cos(phi);
        float sine = sin(phi);
        float nh = normal.x * cosine + normal.y * sine;
        Slope highest = -nh / normal.z;
        vec2 below = sliceMoments(highest, width);
#ifdef FAR
        vec2 start; // of what is counted
#endif
        // Much of what a post sees is the cell it stands on, from where the cell begins.
        ivec2 side = ivec2(drift < 0.0 ? -minor : minor);
        Length ahead = postHeight(heights, post + major + frame);
        Length beside = postHeight(heights, post + side + frame);
        Slope slope = (ahead - here + abs(drift) * (beside - here)) / stepLength;
        bool seen = !isVoid(ahead) && !isVoid(beside) && slope > highest;
        highest = seen ? max(highest, min(slope, cap)) : highest;
        vec2 above = sliceMoments(highest, width);
#ifdef FAR
        // Not counted, but what is sent up to the crest if no sample is seen.
        vec3 last = texelFetch(radiance, clamp(post + min(major + side, 0), ivec2(0), size - 2), 0).rgb;
        vec3 upward = vec3(0.0);
        vec3 outward = vec3(0.0);
#else
#ifdef DIRECT
        ivec2 quadrant = max(major + side, ivec2(0));
        vec3 last = colour * corners.light[quadrant.x + 2 * quadrant.y];
#else
        vec3 last = colour * bounced;
#endif
        vec3 upward = (below.x - above.x) * last;
        vec3 outward = (below.y - above.y) * last;
#endif
        below = above;
#ifdef FAR
        start = above;
#endif
#ifdef NEAR
        for (int i = 0; i < exact; ++i)
#else
        for (int i = 0; i < nearCount; ++i)
#endif
        {
            float distance = samples[i].x;
            float offset = drift * distance;
            float whole = floor(offset);
            ivec2 place = post + major * int(distance) + minor * int(whole);
            bool inside = all(greaterThanEqual(place, ivec2(0))) && all(lessThan(place, size));
            // Beside the last post is the frame, which is void.
            ivec2 framed = clamp(place, ivec2(0), size - 1) + frame;
            Length height = crossingHeight(postHeight(heights, framed),
                                           postHeight(heights, framed + minor), offset - whole);
            vec2 between = vec2(post) + samples[i].z * step;
#ifdef SUN
            vec3 sent = sentAt(between, east);
#else
            vec3 sent = texelFetch(radiance, clamp(ivec2(floor(between)), ivec2(0), size - 2), 0).rgb;
#endif
            slope = (height - here) / (distance * stepLength);
            seen = inside && !isVoid(height) && slope > highest;
            highest = seen ? max(highest, min(slope, cap)) : highest;
            above = sliceMoments(highest, width);
#ifdef FAR
            if (i < exact)
            {
                below = above;
                start = above;
            }
#endif
            upward += (below.x - above.x) * sent;
            outward += (below.y - above.y) * sent;
            below = above;
            last = seen ? sent : last;
        }
#ifdef NEAR
        vec4 beyond = vec4(0.0);
        for (int i = 0; i < 4; ++i)
            beyond += weights[i] * texelFetch(farRadiance, ivec3(blocks[i], k), 0);
        last = beyond.a > 1.0e-4 ? beyond.rgb / beyond.a : last;
#else
        for (int i = nearCount; i < sampleCount; ++i)
        {
            vec2 place = vec2(post) + samples[i].x * step;
            bool inside = all(greaterThanEqual(place, vec2(0.0))) &&
                          all(lessThanEqual(place, vec2(size - 1)));
            ivec4 level = heightLevels[int(samples[i].y)];
            vec2 texel = clamp(place * exp2(-samples[i].y), vec2(0.0), vec2(level.zw - 1));
            vec2 height = textureLod(heightPyramid, (vec2(level.xy) + texel + 0.5) * heightScale, 0.0).xy;
            level = radianceLevels[int(samples[i].w)];
            texel = clamp((vec2(post) + samples[i].z * step) * exp2(-samples[i].w), vec2(0.5),
                          vec2(level.zw) - 0.5);
            vec4 sent = textureLod(radiancePyramid, (vec2(level.xy) + texel) * radianceScale, 0.0);
            sent.rgb /= max(sent.a, 1.0e-3);
            slope = (height.x / max(height.y, 1.0e-3) - here) / (samples[i].x * stepLength);
            seen = inside && height.y > 0.5 && slope > highest;
            highest = seen ? max(highest, min(slope, cap)) : highest;
            above = sliceMoments(highest, width);
            upward += (below.x - above.x) * sent.rgb;
            outward += (below.y - above.y) * sent.rgb;
            below = above;
            last = seen ? sent.rgb : last;
        }
#endif
        // Up to the crest, which coarse samples under-estimate.
        highest = max(highest, cap);
        above = sliceMoments(highest, width);
        upward += (below.x - above.x) * last;
        outward += (below.y - above.y) * last;
#ifdef FAR
        // start - above: the moments of all of it. Rounding may leave them a little below 0.
        float weight = max(normal.z * (start.x - above.x) + nh * (start.y - above.y), 0.0);
        vec3 sent = max(normal.z * upward + nh * outward, vec3(0.0));
        imageStore(farRadiance, ivec3(id, k),
                   vec4(roundedToHalf(float(azimuths) * sent),
                        roundedToHalf(vec3(float(azimuths) * weight)).x));
#else
        for (int c = 0; c < 3; ++c)
            sum[c] += vec3(cosine * outward[c], sine * outward[c], upward[c]);
#endif
    }
#ifndef FAR
    sum /= PI;
    vec3 received = normal * sum;
    imageStore(light, post, vec4(roundedToHalf(received), 1.0));
#endif
}
