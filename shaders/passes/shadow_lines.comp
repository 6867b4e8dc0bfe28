// The height of the sun's shadow along lines towards it: one invocation walks one line, away from
// the sun. A shadow sinks with every step, and a crest above it begins another. SURROUNDED: crests
// around the tile, too.
layout(local_size_x = 32) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
// height of the shadow [m], distance to its crest [m]: of lines one post apart, where they cross
// column x (or row y); in row y (column x) the one whose last post is the (y - 1)-th.
layout(rg32f, binding = 0) writeonly uniform image2D lines;

uniform ivec2 size; // posts
uniform int frame;
uniform float northSpacing; // [m]
uniform vec4 direction;     // towards the sun, as in horizon_sweep.comp
uniform float sunSlope;

#ifdef SURROUNDED
// After so many steps of that length.
Shadow sunk(Shadow shadow, float steps, float stepLength)
{
    shadow.height -= steps * stepLength * sunSlope;
    shadow.distance += steps * stepLength;
    return shadow;
}

// Of what a line comes through before a place at the tile's edge, at it.
Shadow shadowAround(vec2 place, GridRay ray, float stepLength)
{
    bool north = ray.major.y != 0;
    Shadow shadow = noShadow();
    float at = 0.0; // steps from the place where the shadow is
    for (int level = farLevels; level >= 0; --level)
    {
        Window window = windowOf(level, north);
        float inner =
            level == 0 ? 0.0 : max(exitOf(windowOf(level - 1, north), place, ray), 0.0);
        Columns columns =
            columnsBetween(window, place, ray, inner, exitOf(window, place, ray));
        for (int i = 0; i < columns.count; ++i)
        {
            float away = columns.farthest - float(i * window.step);
            shadow = sunk(shadow, at - away, stepLength);
            at = away;
            Length crest = VOID_HEIGHT;
            if (level == 0)
                crest = columnHeight(heights, window, place, ray, away);
            else
                crest = farHeight(level, place, ray, away);
            shadow = addCrest(shadow, crest, 0.0, sunSlope);
        }
    }
    return sunk(shadow, at, stepLength);
}
#endif

void main()
{
    bool north = direction.z != 0.0;
    int look = int(direction.y);
    ivec2 across = north ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 extent = north ? size.yx : size;
    float shift = max(direction.x, 0.0) * float(extent.x - 1);
    int number = int(INVOCATION.x);
    Shadow shadow = noShadow();
    bool begins = true;
    for (int walked = 0; walked < extent.x; ++walked)
    {
        int major = look > 0 ? extent.x - 1 - walked : walked;
        float base = direction.x * float(major) - shift; // of line 0
        int last = number + int(floor(base));
        if (last < -1 || last >= extent.y)
            continue;
        float minor = clamp(float(number) + base, 0.0, float(extent.y - 1));
        int whole = min(int(floor(minor)), max(extent.y - 2, 0));
        ivec2 post = north ? ivec2(whole, major) : ivec2(major, whole);
        Length crest = crossingHeight(postHeight(heights, post + frame),
                                      postHeight(heights, post + frame + across),
                                      minor - float(whole));
        Length east = texelFetch(eastSpacings, ivec2(0, post.y), 0).x;
        float stepLength = north ? length(vec2(direction.x * east, northSpacing))
                                 : length(vec2(east, direction.x * northSpacing));
#ifdef SURROUNDED
        if (begins)
        {
            vec2 place = vec2(major, float(number) + base);
            // One step on, from which it sinks below.
            shadow = sunk(shadowAround(north ? place.yx : place,
                                       gridRay(direction.x, look, north), stepLength),
                          -1.0, stepLength);
        }
        begins = false;
#endif
        shadow.height -= stepLength * sunSlope;
        shadow.distance += stepLength;
        shadow = addCrest(shadow, crest, 0.0, sunSlope);
        imageStore(lines, north ? ivec2(last + 1, major) : ivec2(major, last + 1),
                   vec4(shadow.height, shadow.distance, 0.0, 0.0));
    }
}
