// The far part of horizons: one invocation walks one line of one direction, away from where it looks,
// and keeps the upper hull of the line's samples (Timonen and Westerholm 2010, sections 4 and 5). A
// post asks the two lines that it stands between, with its own height, and mixes what they say: exact
// on any plane. Samples closer than `reach` steps are left to horizon_near.comp, which sees them where
// they really are.
//
// Two dispatches: lines of even number (PARITY 0) write, then those of odd number mix with what they
// find. POSTS_PER_STEP: posts that a line serves in a step, 2 where there is one line per post, else 1.
layout(local_size_x = 32) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D stepLengths;  // R32F, one texel per row: see horizon_near.comp
layout(r16, binding = 0) uniform image2DArray horizon; // elevation codes
layout(r32ui, binding = 1) uniform uimage2D dropped;             // hull vertices lost, see below

uniform ivec2 size; // posts
uniform int frame;
uniform int reach;
uniform int linesPerPost;
// Per direction: signed drift along the minor axis per step of the major axis towards +, look
// direction along the major axis (+1 or -1), 1 where the major axis is north, layer.
uniform vec4 directions[256];

// A hull that may need more vertices than there is room for loses every second of them, the newest
// excepted. Between two kept vertices the hull then runs below the lost one, by no more than the lost
// vertex stood above their chord. `dropped` counts them.
const int HULL_CAPACITY = HULL_SIZE;
const int CHUNK = 32;

// Of a line's share in a post. A post with less of its even line than this takes its odd line alone, so
// rounding cannot leave it with a line that did not write.
const float MARGIN = 0.01;

void main()
{
    vec4 direction = directions[int(gl_GlobalInvocationID.z)];
    float drift = direction.x;
    int look = int(direction.y);
    bool north = direction.z != 0.0;
    int layer = int(direction.w);
    int steps = north ? size.y : size.x;
    int breadth = north ? size.x : size.y;

    // Line j stands at minor coordinate lineStart + drift * i over major coordinate i.
    int line = 2 * int(gl_GlobalInvocationID.x) + PARITY;
    float perPost = float(linesPerPost);
    float shift = max(drift, 0.0) * float(steps - 1);
    float lineStart = float(line) / perPost - shift;

    // Major coordinates at which the line is over the tile, half a post around it included.
    int low = 0;
    int high = steps - 1;
    if (abs(drift) > 1.0e-6)
    {
        float a = (-0.999 - lineStart) / drift;
        float b = (float(breadth) - 0.001 - lineStart) / drift;
        low = max(low, int(ceil(min(a, b))));
        high = min(high, int(floor(max(a, b))));
    }
    else if (lineStart < -0.999 || lineStart > float(breadth) - 0.001)
        return;
    int count = high - low + 1;
    int start = look > 0 ? high : low;

    // Vertices: height, position in steps walked. The newest two stand in registers; hull[] holds all
    // but the newest.
    vec2 hull[HULL_CAPACITY];
    vec2 newest = vec2(0.0);
    vec2 second = vec2(0.0);
    int vertices = 0;
    for (int chunk = 0; chunk < count; chunk += CHUNK)
    {
        // Asked once per chunk, not per push: a processor that runs lanes in step pays for it each time.
        if (vertices > HULL_CAPACITY - CHUNK)
        {
            int kept = vertices / 2;
            for (int i = 1; i < kept; ++i)
                hull[i] = hull[2 * i];
            imageAtomicAdd(dropped, ivec2(0), uint(vertices - 1 - kept));
            second = hull[kept - 1];
            vertices = kept + 1;
        }
        for (int walked = chunk; walked < min(chunk + CHUNK, count); ++walked)
        {
            int pushed = walked - reach - 1;
            if (pushed >= 0)
            {
                int major = start - look * pushed;
                float minor = lineStart + drift * float(major);
                int whole = int(floor(minor));
                ivec2 post = (north ? ivec2(whole, major) : ivec2(major, whole)) + frame;
                float a = postHeight(heights, post);
                float b = postHeight(heights, post + (north ? ivec2(1, 0) : ivec2(0, 1)));
                vec2 vertex = vec2(mix(a, b, minor - float(whole)), float(pushed));
                if (!isVoid(vertex.x))
                {
                    while (vertices > 1 && hidesOrEquals(vertex, newest, second))
                    {
                        newest = second;
                        --vertices;
                        second = hull[max(vertices - 2, 0)];
                    }
                    hull[max(vertices - 1, 0)] = newest;
                    second = newest;
                    newest = vertex;
                    ++vertices;
                }
            }

            // The posts that this line is one of the two lines of: the two beside it, or, where there
            // is more than one line per post, the nearest at most.
            int major = start - look * walked;
            float minor = lineStart + drift * float(major);
            int nearest = int(floor(POSTS_PER_STEP == 2 ? minor : minor + 0.5));
            for (int side = 0; side < POSTS_PER_STEP; ++side)
            {
                float aside = float(nearest + side) - minor;
                float share = 1.0 - abs(aside) * perPost;
                // Along the tile's edges one line of the two may run outside: then the other counts alone.
                float other = minor + (aside < 0.0 ? -1.0 : 1.0) / perPost;
                bool otherIn = other > -MARGIN && other < float(breadth - 1) + MARGIN;
                bool inside = minor > -MARGIN && minor < float(breadth - 1) + MARGIN;
                bool served = nearest + side >= 0 && nearest + side < breadth && share > -MARGIN && inside;
                if (served)
                {
                    ivec2 post = north ? ivec2(nearest + side, major) : ivec2(major, nearest + side);
                    Slope slope = NO_HORIZON;
                    if (vertices > 0)
                    {
                        vec2 eye = vec2(postHeight(heights, post + frame), float(walked));
                        vec2 nearer = newest;
                        vec2 farther = second;
                        int rest = vertices - 1;
                        while (rest > 0 && hidesOrEquals(eye, nearer, farther))
                        {
                            nearer = farther;
                            --rest;
                            farther = hull[max(rest - 1, 0)];
                        }
                        slope = (nearer.x - eye.x) / (eye.y - nearer.y);
                    }
                    float stepLength = texelFetch(stepLengths, ivec2(layer, post.y), 0).x;
                    float elevation = elevationOfSlope(slope / stepLength);
                    if (PARITY == 1 && share < 1.0 - MARGIN && otherIn)
                        elevation = mixElevations(
                            elevation, elevationOfCode(imageLoad(horizon, ivec3(post, layer)).x),
                            1.0 - share);
                    imageStore(horizon, ivec3(post, layer), vec4(codeOfElevation(elevation)));
                }
            }
        }
    }
}
