// The far part of horizons: one invocation walks one line of one direction, away from where it
// looks, and keeps the upper hull of the line's samples (Timonen and Westerholm 2010, sections 4
// and 5). A post stands between two lines, up to a post's width aside, so their horizons are not
// its own: it only asks each line where the horizon is, and measures the surface on its own ray
// there and a step to either side, on columns and rows. The result is a slope that the ray really
// meets: exact on planes, and, but for voids, never too high.
// Samples closer than `reach` steps are left to horizon_near.comp.
//
// ASKED 1: one dispatch, a post asks its nearest line. ASKED 2: it asks the two lines that it
// stands between; lines of even number (PARITY 0) write, then, in a second dispatch, those of odd
// number keep the higher.
layout(local_size_x = 32) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D stepLengths;  // R32F, one texel per row: see horizon_near.comp
layout(r16, binding = 0) uniform image2DArray horizon; // elevation codes
layout(r32ui, binding = 1) uniform uimage2D dropped;             // hull vertices lost, see below

uniform ivec2 size; // posts
uniform int frame;
uniform int reach;
uniform int linesPerPost;
uniform int firstDirection; // of this dispatch
layout(std140, binding = 0) uniform Rays
{
    // Signed drift along the minor axis per step of the major axis towards +, look direction along
    // the major axis (+1 or -1), 1 where the major axis is north, layer.
    vec4 directions[256];
};

// A hull that may need more vertices than there is room for loses every second of them, the newest
// excepted. Between two kept vertices the hull then runs below the lost one, by no more than the
// lost vertex stood above their chord. `dropped` counts them.
const int HULL_CAPACITY = HULL_SIZE;
const int CHUNK = 16;

// Steps that are measured about the one found. A post that asks two lines gets by without the
// nearer one: what it would add, the other line finds.
const int FIRST_MEASURED = ASKED == 1 ? -1 : 0;

const float LEAD = ASKED == 1 ? 0.5 : 0.0;
// Posts that a line serves in a step: two where it is one of two lines, one per post.
#if ASKED == 2 && !defined(DENSE)
const int POSTS_PER_STEP = 2;
#else
const int POSTS_PER_STEP = 1;
#endif

void main()
{
    vec4 direction = directions[firstDirection + int(gl_GlobalInvocationID.z)];
    float drift = direction.x;
    int look = int(direction.y);
    bool north = direction.z != 0.0;
    int layer = int(direction.w);
    int steps = north ? size.y : size.x;
    int breadth = north ? size.x : size.y;

    // Line j stands at minor coordinate lineStart + drift * i over major coordinate i.
    int line = ASKED * int(gl_GlobalInvocationID.x) + PARITY;
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

    // Vertices: height, position in steps walked. The newest two stand in registers; hull[] holds
    // all but the newest.
    vec2 hull[HULL_CAPACITY];
    vec2 newest = vec2(0.0);
    vec2 second = vec2(0.0);
    int vertices = 0;
    for (int chunk = 0; chunk < count; chunk += CHUNK)
    {
        // Asked once per chunk, not per push: a processor that runs lanes in step pays for it each
        // time.
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
                vec2 vertex = vec2(crossingHeight(a, b, minor - float(whole)), float(pushed));
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

            int major = start - look * walked;
            float drifted = drift * float(major);
            int beside = int(floor(lineStart + drifted));
            for (int side = 0; side < POSTS_PER_STEP; ++side)
            {
                // Which lines a post asks follows from the post, so that rounding cannot give it
                // more or fewer. `lead`: the line asked, or the first of two.
                int minor = beside + side;
                int lead = int(floor((float(minor) - drifted + shift) * perPost + LEAD));
                bool mine = lead == line || (ASKED == 2 && lead + 1 == line);
                if (POSTS_PER_STEP == 1 && !mine)
                {
                    ++minor;
                    lead = int(floor((float(minor) - drifted + shift) * perPost + LEAD));
                    mine = lead == line || (ASKED == 2 && lead + 1 == line);
                }
                bool served = minor >= 0 && minor < breadth && mine;
                if (served)
                {
                    ivec2 post = north ? ivec2(minor, major) : ivec2(major, minor);
                    vec2 eye = vec2(postHeight(heights, post + frame), float(walked));
                    float turn = drift * float(look); // of the ray, per step
                    float room = turn < 0.0 ? float(minor) : float(breadth - 1 - minor);
                    // Steps to the edge of the data; none where the ray runs along the grid.
                    float exit = abs(turn) < 1.0e-7 ? float(steps) : room / abs(turn);

                    vec2 nearer = newest;
                    vec2 farther = second;
                    int rest = vertices - 1;
                    while (rest > 0 && hidesOrEquals(eye, nearer, farther))
                    {
                        nearer = farther;
                        --rest;
                        farther = hull[max(rest - 1, 0)];
                    }
                    // A line may leave the data later than the ray beside it: what it sees there,
                    // the ray would see at its own exit at most.
                    // Where the line's only sample that far is beyond the data, its exit is asked.
                    float found = min(vertices > 0 ? eye.y - nearer.y : exit, floor(exit));
                    Slope slope = NO_HORIZON;
                    bool measured = false;
                    for (int i = FIRST_MEASURED; i <= 1; ++i)
                    {
                        float away = found + float(i);
                        bool onRay = away > float(reach) && away < exit + 1.0 &&
                                     away <= float(walked);
                        Slope met = slopeAtStep(heights, post + frame, eye.x,
                                                north ? ivec2(0, look) : ivec2(look, 0),
                                                north ? ivec2(1, 0) : ivec2(0, 1), turn,
                                                onRay ? int(away) : 1);
                        onRay = onRay && met > NO_HORIZON;
                        slope = onRay ? max(slope, met) : slope;
                        measured = measured || onRay;
                    }
                    // Beside a void the ray may meet no surface there; then the line's word stands.
                    if (vertices > 0 && !measured && floor(exit) > float(reach))
                        slope = (nearer.x - eye.x) / (eye.y - nearer.y);
                    float stepLength = texelFetch(stepLengths, ivec2(layer, post.y), 0).x;
                    float code = codeOfElevation(elevationOfSlope(slope / stepLength));
                    if (PARITY == 1)
                        code = max(code, imageLoad(horizon, ivec3(post, layer)).x);
                    imageStore(horizon, ivec3(post, layer), vec4(code));
                }
            }
        }
    }
}
