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
//
// SURROUNDED: a line begins in the farthest of the coarser windows around the tile, comes through
// each of them and through the tile's own ring, and serves posts of the tile.
layout(local_size_x = 32) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
layout(r32f) readonly uniform image2D stepLengths; // R32F, one texel per row: see horizon_near.comp
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
    // the major axis (+1 or -1), 1 where the major axis is north, how far the lines are moved along
    // the minor axis. One layer each.
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

// A line: at minor coordinate start + drift * i over major coordinate i.
struct Line
{
    float drift; // along the minor axis per step of the major axis towards +
    int look;    // along the major axis
    bool north;  // the major axis
    int layer;
    int number;
    float shift, start;
    int first, count; // major coordinate where it is over the tile first, and steps there
};

// Vertices of the hull but for the newest: height, position in steps walked.
vec2 hull[HULL_CAPACITY];
// The newest two stand in registers.
vec2 newest = vec2(0.0);
vec2 second = vec2(0.0);
int vertices = 0;

int steps(Line line)
{
    return line.north ? size.y : size.x;
}

int breadth(Line line)
{
    return line.north ? size.x : size.y;
}

// Steps along the major axis, and across it.
ivec2 along(Line line)
{
    return line.north ? ivec2(0, line.look) : ivec2(line.look, 0);
}

ivec2 across(Line line)
{
    return line.north ? ivec2(1, 0) : ivec2(0, 1);
}

ivec2 postAt(Line line, int minor, int major)
{
    return line.north ? ivec2(minor, major) : ivec2(major, minor);
}

// The line of this invocation; count is 0 where it misses the tile.
Line lineOf(vec4 direction)
{
    Line line;
    line.drift = direction.x;
    line.look = int(direction.y);
    line.north = direction.z != 0.0;
    line.layer = firstDirection + int(INVOCATION.z);
    line.number = ASKED * int(INVOCATION.x) + PARITY;
    line.shift = max(line.drift, 0.0) * float(steps(line) - 1) + direction.w;
    line.start = float(line.number) / float(linesPerPost) - line.shift;
    // Major coordinates at which the line is over the tile, half a post around it included.
    int low = 0;
    int high = steps(line) - 1;
    float edge = float(breadth(line)) - 0.001;
    if (abs(line.drift) > 1.0e-6)
    {
        float a = (-0.999 - line.start) / line.drift;
        float b = (edge - line.start) / line.drift;
        low = max(low, int(ceil(min(a, b))));
        high = min(high, int(floor(max(a, b))));
    }
    else if (line.start < -0.999 || line.start > edge)
        high = low - 1;
    line.first = line.look > 0 ? high : low;
    line.count = high - low + 1;
#ifdef SURROUNDED
    // And in the ring that it comes through before.
    vec2 place = vec2(line.first, line.start + line.drift * float(line.first));
    place = line.north ? place.yx : place;
    GridRay ray = gridRay(line.drift, line.look, line.north);
    int lead = line.count > 0 ? max(0, int(exitOf(windowOf(0, line.north), place, ray))) : 0;
    line.first += line.look * lead;
    line.count += lead;
#endif
    return line;
}

// A hull that is almost full loses every second vertex.
void thinHull()
{
    int kept = vertices / 2;
    for (int i = 1; i < kept; ++i)
        hull[i] = hull[2 * i];
    imageAtomicAdd(dropped, ivec2(0), uint(vertices - 1 - kept));
    second = hull[kept - 1];
    vertices = kept + 1;
}

// The newest vertex, but where it is void.
void pushVertex(vec2 vertex)
{
    if (isVoid(vertex.x))
        return;
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

// The line's surface after so many steps.
void push(Line line, int walked)
{
    int major = line.first - line.look * walked;
    float minor = line.start + line.drift * float(major);
    int whole = int(floor(minor));
    ivec2 post = postAt(line, whole, major) + frame;
    float a = postHeight(heights, post);
    float b = postHeight(heights, post + across(line));
    pushVertex(vec2(crossingHeight(a, b, minor - float(whole)), float(walked)));
}

#ifdef SURROUNDED
// The line's surface in the coarser windows, farthest first; positions are below 0.
void pushFar(Line line)
{
    GridRay ray = gridRay(line.drift, line.look, line.north);
    vec2 place = vec2(line.first, line.start + line.drift * float(line.first));
    place = line.north ? place.yx : place;
    for (int level = farLevels; level >= 1; --level)
    {
        Window window = windowOf(level, line.north);
        float inner = max(exitOf(windowOf(level - 1, line.north), place, ray), 0.0);
        Columns columns =
            columnsBetween(window, place, ray, inner, exitOf(window, place, ray));
        for (int chunk = 0; chunk < columns.count; chunk += CHUNK / 2)
        {
            if (vertices > HULL_CAPACITY - CHUNK)
                thinHull();
            // Two vertices each.
            for (int i = chunk; i < min(chunk + CHUNK / 2, columns.count); ++i)
            {
                float away = columns.farthest - float(i * window.step);
                Crossing row = rowCrossing(farHeights, window, place, ray, away);
                if (i > 0)
                    pushVertex(vec2(row.height, -row.away));
                pushVertex(vec2(farHeight(level, place, ray, away), -away));
            }
        }
    }
}
#endif

// The vertex in which an eye, height and position, sees the horizon.
vec2 vertexSeen(vec2 eye)
{
    vec2 nearer = newest;
    vec2 farther = second;
    int rest = vertices - 1;
    while (rest > 0 && hidesOrEquals(eye, nearer, farther))
    {
        nearer = farther;
        --rest;
        farther = hull[max(rest - 1, 0)];
    }
    return nearer;
}

// Slope at which a post's own ray meets the tile's own posts about `found` steps away [m per step],
// before its exit and in the first `walked` steps; NO_HORIZON where it does not.
Slope slopeNear(Line line, ivec2 post, float here, float found, float exit, float walked)
{
    float turn = line.drift * float(line.look); // of the ray, per step
    Slope slope = NO_HORIZON;
    // Steps whose columns are on the tile or beside it.
    float last = min(walked, floor(exit) + 1.0);
    RayColumn before =
        rayColumn(heights, post + frame, along(line), across(line), turn,
                  int(clamp(found + float(FIRST_MEASURED - 1), 0.0, last)));
    for (int i = FIRST_MEASURED; i <= 1; ++i)
    {
        float away = found + float(i);
        bool onRay = away > float(reach) && away < exit + 1.0 && away <= walked;
        int step = int(clamp(away, 1.0, max(last, 1.0)));
        RayColumn column =
            rayColumn(heights, post + frame, along(line), across(line), turn, step);
        Slope met = slopeAtStep(before, column, here, turn, step);
        before = column;
        slope = onRay ? max(slope, met) : slope;
    }
    return slope;
}

// Beside a void a ray may meet no surface where its line has seen one; then the line's word stands.
Slope slopeOrWord(Slope slope, vec2 eye, vec2 seen, float exit)
{
    bool word = vertices > 0 && exit > float(reach) && slope <= NO_HORIZON;
    return word ? (seen.x - eye.x) / (eye.y - seen.y) : slope;
}

#ifdef SURROUNDED
// Horizon of a post that asks the line after so many steps [m per step]. A crest in the ring or the
// tile is measured; beside one of a coarser window the post's ray runs within a quarter of a cell,
// and the line's word will do.
Slope slopeSeen(Line line, ivec2 post, vec2 eye)
{
    GridRay ray = gridRay(line.drift, line.look, line.north);
    vec2 seen = vertexSeen(eye);
    // What the line sees last may lie beyond where the ray leaves the data.
    float end = floor(exitOf(windowOf(farLevels, line.north), vec2(post), ray));
    float own = exitOf(windowOf(0, line.north), vec2(post), ray);
    float found = vertices > 0 ? min(eye.y - seen.y, end) : end;
    Slope slope = NO_HORIZON;
    if (found <= own)
        slope = slopeNear(line, post, eye.x, found, own, own + 1.0);
    return slopeOrWord(slope, eye, seen, end);
}
#else
// Horizon of a post that asks the line after so many steps [m per step].
Slope slopeSeen(Line line, ivec2 post, vec2 eye)
{
    int minor = line.north ? post.x : post.y;
    float turn = line.drift * float(line.look); // of the ray, per step
    float room = turn < 0.0 ? float(minor) : float(breadth(line) - 1 - minor);
    // Steps to the edge of the data; none where the ray runs along the grid.
    float exit = abs(turn) < 1.0e-7 ? float(steps(line)) : room / abs(turn);
    vec2 seen = vertexSeen(eye);
    // A line may leave the data later than the ray beside it: what it sees there, the ray would see
    // at its own exit at most. Where the line's only sample that far is beyond the data, its exit
    // is asked.
    float found = min(vertices > 0 ? eye.y - seen.y : exit, floor(exit));
    return slopeOrWord(slopeNear(line, post, eye.x, found, exit, eye.y), eye, seen, floor(exit));
}
#endif

// Writes the horizon of a post that asks the line after so many steps.
void serve(Line line, int minor, int major, int walked)
{
    ivec2 post = postAt(line, minor, major);
    vec2 eye = vec2(postHeight(heights, post + frame), float(walked));
    Slope slope = slopeSeen(line, post, eye);
    float stepLength = imageLoad(stepLengths, ivec2(line.layer, post.y)).x;
    float code = codeOfElevation(elevationOfSlope(slope / stepLength));
    if (PARITY == 1)
        code = max(code, imageLoad(horizon, ivec3(post, line.layer)).x);
    imageStore(horizon, ivec3(post, line.layer), vec4(code));
}

// Whether a post asks this line. Which lines it asks follows from the post, so that rounding cannot
// give it more or fewer.
bool isAsked(Line line, int minor, float drifted)
{
    // The line asked, or the first of two.
    int lead =
        int(floor((float(minor) - drifted + line.shift) * float(linesPerPost) + LEAD));
    return lead == line.number || (ASKED == 2 && lead + 1 == line.number);
}

// Not in the ring.
bool inTile(Line line, int major)
{
#ifdef SURROUNDED
    return major >= 0 && major < steps(line);
#else
    return true;
#endif
}

void main()
{
    Line line = lineOf(directions[firstDirection + int(INVOCATION.z)]);
#ifdef SURROUNDED
    if (line.count > 0)
        pushFar(line);
#endif
    for (int chunk = 0; chunk < line.count; chunk += CHUNK)
    {
        // Asked once per chunk, not per push: a processor that runs lanes in step pays for it each
        // time.
        if (vertices > HULL_CAPACITY - CHUNK)
            thinHull();
        for (int walked = chunk; walked < min(chunk + CHUNK, line.count); ++walked)
        {
            if (walked > reach)
                push(line, walked - reach - 1);
            int major = line.first - line.look * walked;
            float drifted = line.drift * float(major);
            int beside = int(floor(line.start + drifted));
            for (int side = 0; side < POSTS_PER_STEP; ++side)
            {
                int minor = beside + side;
                bool mine = isAsked(line, minor, drifted);
                if (POSTS_PER_STEP == 1 && !mine)
                    mine = isAsked(line, ++minor, drifted);
                if (minor >= 0 && minor < breadth(line) && mine && inTile(line, major))
                    serve(line, minor, major, walked);
            }
        }
    }
}
