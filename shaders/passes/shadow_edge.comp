// Of every post: its height over the sun's shadow [m], and how soft the shadow's edge is [m].
// Crests within the first NEAR steps are found on the post's own ray, the others on the two lines
// of shadow_lines.comp that it runs between.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
uniform sampler2D lines;        // of shadow_lines.comp
layout(rg16f, binding = 0) writeonly uniform image2D edge;

uniform ivec2 size; // posts
uniform int frame;
uniform float northSpacing; // [m]
uniform vec4 direction;     // towards the sun, as in horizon_sweep.comp
uniform float sunSlope;

const int NEAR = 8;

Shadow onLine(ivec2 place)
{
    vec2 read = texelFetch(lines, place, 0).xy;
    Shadow shadow;
    shadow.height = read.x;
    shadow.distance = read.y;
    return shadow;
}

// Between the lines, `steps` steps towards the sun from a post.
Shadow farShadow(GridRay ray, ivec2 post, int steps, float stepLength)
{
    bool north = direction.z != 0.0;
    ivec2 extent = north ? size.yx : size;
    int major = (north ? post.y : post.x) + steps * int(direction.y);
    float minor = float(north ? post.x : post.y) + ray.drift * float(steps);
    if (major < 0 || major >= extent.x || minor < 0.0 || minor > float(extent.y - 1))
        return noShadow();
    float base = direction.x * float(major) - max(direction.x, 0.0) * float(extent.x - 1);
    int whole = int(floor(base));
    int last = clamp(int(floor(minor - base)) + whole, -1, extent.y - 2);
    ivec2 place = north ? ivec2(last + 1, major) : ivec2(major, last + 1);
    Shadow shadow = mixShadows(onLine(place), onLine(place + ray.minor),
                               clamp(minor - base - float(last - whole), 0.0, 1.0));
    shadow.distance += float(steps) * stepLength;
    shadow.height -= float(steps) * stepLength * sunSlope;
    return shadow;
}

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    Length here = postHeight(heights, post + frame);
    if (isVoid(here))
    {
        imageStore(edge, post, vec4(0.0));
        return;
    }
    GridRay ray = gridRay(direction.x, int(direction.y), direction.z != 0.0);
    Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
    float stepLength = length(ray.step * vec2(east, northSpacing));
    Shadow shadow = noShadow();
    for (int i = 1; i < NEAR; ++i)
    {
        Length crest = heightAtStep(heights, post, ray, i, size, frame);
        shadow = addCrest(shadow, crest, float(i) * stepLength, sunSlope);
    }
    Shadow far = farShadow(ray, post, NEAR, stepLength);
    if (far.height > shadow.height)
        shadow = far;
    Length relief =
        shadowRelief(postRelief(heights, post + frame), max(east, northSpacing), sunSlope);
    vec2 over = overShadow(shadow, here, sunElevation, sunSlope, sunRadius, relief);
    imageStore(edge, post, vec4(clamp(over, vec2(-6.0e4), vec2(6.0e4)), 0.0, 0.0));
}
