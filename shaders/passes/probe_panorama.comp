// What a probe sees all around, as a picture: the ground up to its horizon, above it the sky and
// key lights, and nothing where neither is. Without the sun, whose disc the three last invocations
// look for a horizon of.
//
// An invocation is a column: it walks away from the probe, and whatever rises above all before it
// is seen, as by the posts in bounce.comp, but from any height and on the surface itself.
layout(local_size_x = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D shading; // rgb = irradiance / pi
uniform sampler2D albedo;  // one texel per post, or one for all
#ifdef SKY_PICTURE
// RGBA32F, radiance, as sky_table.comp reads it: rows from the horizontal to the zenith. A whole
// number of its columns and rows in each of the panorama's.
uniform sampler2D sky;
#endif
// RGBA32F, radiance: columns counter-clockwise from east, an even number of rows from nadir to
// zenith.
layout(rgba32f, binding = 0) writeonly uniform image2D panorama;
layout(r32f, binding = 1) writeonly uniform image2D sunHorizon; // elevation [rad], three texels

uniform ivec2 size; // posts
uniform int frame;
uniform vec2 spacings; // [m] of columns and rows
uniform vec2 place;    // column and row of the probe, with fractions
uniform float height;  // [m]
uniform bool aboveGround;
uniform vec3 sunAzimuths; // [rad], counter-clockwise from east
uniform int keyLightCount; // 0 ... 8
// Of each key light: azimuth of its middle [rad, counter-clockwise from east], half its width,
// lowest >= 0 and highest elevation [rad].
uniform vec4 keyAreas[8];
uniform vec3 keyLightRadiances[8];

// Share of a range that another covers.
float covered(float from, float to, float otherFrom, float otherTo)
{
    return max(min(to, otherTo) - max(from, otherFrom), 0.0) / (to - from);
}

// Mean radiance of one texel of the panorama above the horizontal.
vec3 skyOf(int column, int row, ivec2 pictureSize)
{
    float width = 2.0 * PI / float(pictureSize.x);
    float rowHeight = PI / float(pictureSize.y);
    vec3 radiance = skyRadiance;
#ifdef SKY_PICTURE
    ivec2 parts = textureSize(sky, 0) / ivec2(pictureSize.x, pictureSize.y / 2);
    ivec2 first = ivec2(column, row - pictureSize.y / 2) * parts;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < parts.x * parts.y; ++i)
    {
        ivec2 texel = first + ivec2(i % parts.x, i / parts.x);
        float weight = cos(HALF_PI * (float(texel.y) + 0.5) / float(textureSize(sky, 0).y));
        sum += weight * vec4(texelFetch(sky, texel, 0).rgb, 1.0);
    }
    radiance = sum.rgb / sum.a;
#endif
    float bottom = rowHeight * float(row) - HALF_PI;
    for (int i = 0; i < keyLightCount; ++i)
    {
        // From the light's middle, -pi ... pi, and beyond that seam.
        float turn = (width * (float(column) + 0.5) - keyAreas[i].x) / (2.0 * PI);
        float middle = 2.0 * PI * (turn - floor(turn + 0.5));
        float share = covered(bottom, bottom + rowHeight, keyAreas[i].z, keyAreas[i].w);
        float left = middle - 0.5 * width;
        float around = middle < 0.0 ? 2.0 * PI : -2.0 * PI;
        share *= covered(left, left + width, -keyAreas[i].y, keyAreas[i].y) +
                 covered(left + around, left + around + width, -keyAreas[i].y, keyAreas[i].y);
        radiance += keyLightRadiances[i] * share;
    }
    return radiance;
}

void main()
{
    int column = int(INVOCATION.x);
    ivec2 pictureSize = imageSize(panorama);
    if (column >= pictureSize.x + 3)
        return;
    bool ofSun = column >= pictureSize.x;
    float phi = ofSun ? sunAzimuths[column - pictureSize.x]
                      : 2.0 * PI * (float(column) + 0.5) / float(pictureSize.x);
    vec2 perMetre = vec2(cos(phi), sin(phi)) / spacings;
    float rowHeight = PI / float(pictureSize.y);
    Length cell = min(spacings.x, spacings.y);

    vec2 below = riseBetweenPosts(heights, place, size, frame, 0.0);
    Length ground = below.y > 0.5 ? below.x / below.y : 0.0;
    Length here = aboveGround ? ground + height : below.y > 0.5 ? max(height, ground) : height;
    Length above = here - ground;
    // To where the ray leaves the tile [m].
    vec2 room = mix(place, vec2(size - 1) - place, greaterThan(perMetre, vec2(0.0)));
    vec2 ends = room / max(abs(perMetre), vec2(1.0e-12));
    Length end = min(ends.x, ends.y);

    Angle reached = -HALF_PI;
    int row = 0;          // that `reached` is in
    vec3 filled = vec3(0.0); // mean radiance of it up to there
    Length distance = 0.0;
    while (distance < end)
    {
        // Steps of about six degrees where the probe looks down, then from line to line of the grid
        // of posts: crests are there.
        Length step = max(0.1 * sqrt(distance * distance + above * above), 1.0e-3 * cell);
        vec2 at = place + perMetre * distance;
        vec2 line = mix(ceil(at - 1.0e-3) - 1.0, floor(at + 1.0e-3) + 1.0,
                        greaterThan(perMetre, vec2(0.0)));
        vec2 lines = abs(line - at) / max(abs(perMetre), vec2(1.0e-12));
        step = min(step, min(lines.x, lines.y));
        Length next = distance + step;
        vec2 rise = riseBetweenPosts(heights, place + perMetre * min(next, end), size, frame, here);
        Angle elevation = elevationOfSlope(rise.x / max(rise.y, 1.0e-3) / min(next, end));
        elevation = rise.y > 0.5 ? max(elevation, reached) : reached;
        vec2 between = (place + perMetre * min(distance + 0.5 * step, end) + 0.5);
        vec3 sent = textureLod(shading, between / vec2(size), 0.0).rgb *
                    textureLod(albedo, between / vec2(size), 0.0).rgb;
        int last = clamp(int(floor((elevation + HALF_PI) / rowHeight)), row, pictureSize.y);
        for (; row < last; ++row)
        {
            Angle top = rowHeight * float(row + 1) - HALF_PI;
            filled += sent * max(top - reached, 0.0) / rowHeight;
            if (!ofSun)
                imageStore(panorama, ivec2(column, row), vec4(filled, 1.0));
            filled = vec3(0.0);
            reached = top;
        }
        filled += sent * max(elevation - reached, 0.0) / rowHeight;
        reached = max(reached, elevation);
        distance = next;
    }
    if (ofSun)
    {
        imageStore(sunHorizon, ivec2(column - pictureSize.x, 0), vec4(reached));
        return;
    }
    for (; row < pictureSize.y; ++row)
    {
        Angle top = rowHeight * float(row + 1) - HALF_PI;
        if (2 * row >= pictureSize.y) // the sky ends at the horizontal
            filled += skyOf(column, row, pictureSize) * (max(top - reached, 0.0) / rowHeight);
        imageStore(panorama, ivec2(column, row), vec4(filled, 1.0));
        filled = vec3(0.0);
        reached = max(reached, top);
    }
}
