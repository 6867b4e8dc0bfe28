// The far part of horizons: one invocation walks one line of one direction, away from where it looks,
// and keeps the upper hull of the line's samples (Timonen and Westerholm 2010, sections 4 and 5). A
// post asks its nearest line, with its own height; samples closer than `reach` steps are left to
// horizon_near.comp, which sees them where they really are.
layout(local_size_x = 32) in;

uniform sampler2D heights;      // R32F [m], framed by `frame` void posts, row 0 south
uniform sampler2D stepLengths;  // R32F, one texel per row: see horizon_near.comp
layout(r16, binding = 0) writeonly uniform image2DArray horizon; // elevation codes
layout(r32ui, binding = 1) uniform uimage2D dropped;             // hull vertices lost, see below

uniform ivec2 size; // posts
uniform int frame;
uniform int reach;
uniform int linesPerPost;
uniform int firstDirection;
// Per direction: signed drift along the minor axis per step of the major axis towards +, look
// direction along the major axis (+1 or -1), 1 where the major axis is north, layer.
uniform vec4 directions[256];

// A hull that needs more vertices loses every second of them, the newest excepted. Between two kept
// vertices the hull then runs below the lost one, by no more than the lost vertex stood above their
// chord. `dropped` counts them.
const int HULL_CAPACITY = HULL_SIZE;

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
    int line = int(gl_GlobalInvocationID.x);
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

    vec2 hull[HULL_CAPACITY]; // height, position in steps walked
    int top = -1;
    for (int walked = 0; walked < count; ++walked)
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
                vec2 nearer = hull[max(top, 0)];
                while (top > 0)
                {
                    vec2 farther = hull[top - 1];
                    if (!hidesOrEquals(vertex, nearer, farther))
                        break;
                    nearer = farther;
                    --top;
                }
                if (top == HULL_CAPACITY - 1)
                {
                    for (int i = 1; i < HULL_CAPACITY / 2; ++i)
                        hull[i] = hull[2 * i];
                    hull[HULL_CAPACITY / 2] = hull[top];
                    top = HULL_CAPACITY / 2;
                    imageAtomicAdd(dropped, ivec2(0), uint(HULL_CAPACITY - 1 - top));
                }
                ++top;
                hull[top] = vertex;
            }
        }

        // The post that this line is nearest to, if there is one: asked of the post, so that rounding
        // cannot leave a post between two lines that both decline it.
        int major = start - look * walked;
        float drifted = drift * float(major);
        int minor = int(floor(lineStart + drifted));
        if (int(floor((float(minor) - drifted + shift) * perPost + 0.5)) != line)
            ++minor;
        bool nearest = minor >= 0 && minor < breadth &&
                       int(floor((float(minor) - drifted + shift) * perPost + 0.5)) == line;
        if (nearest)
        {
            ivec2 post = north ? ivec2(minor, major) : ivec2(major, minor);
            float slope = NO_HORIZON;
            if (top >= 0)
            {
                vec2 eye = vec2(postHeight(heights, post + frame), float(walked));
                int index = top;
                vec2 nearer = hull[index];
                while (index > 0)
                {
                    vec2 farther = hull[index - 1];
                    if (!hidesOrEquals(eye, nearer, farther))
                        break;
                    nearer = farther;
                    --index;
                }
                slope = (nearer.x - eye.x) / (eye.y - nearer.y);
            }
            float stepLength = texelFetch(stepLengths, ivec2(layer, post.y), 0).x;
            float code = codeOfElevation(elevationOfSlope(slope / stepLength));
            imageStore(horizon, ivec3(post, layer), vec4(code));
        }
    }
}
