// One azimuth of a bounce of diffuse light: one invocation walks one line, away from where it
// looks, and keeps what it has passed in a history that coarsens with distance
// (lib/line_history.glsl). A post asks the nearest line, which stands up to half a post beside it;
// so its first NEAR steps it sees on its own ray, and ground enters the history NEAR steps late.
//
// Which entries a history has depends on the steps that a group has walked, and on nothing else, so
// that its lines run alike: what is void, or not the tile's, enters as a piece without ground. All
// reads of the history have constant indices: a processor that runs lanes in step would gather.
//
// SURROUNDED: a line begins in the windows around the tile, with the light that their ground sends.
layout(local_size_x = 32) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
// R32F [m]: ground length of a step of azimuth x in row y
layout(r32f) readonly uniform image2D stepLengths;
layout(rgba16f) readonly uniform image2D faces; // of faces.comp
layout(rg32f) readonly uniform image2D gradients; // of bounce_own.comp
// elevation codes, layer k looks towards 2*pi*k/m from east
layout(r16) readonly uniform image2DArray horizon;
#ifdef SUN
uniform sampler2D albedo;       // one texel per post, or one for all
#endif
layout(rgba32f, binding = 0) uniform image2D sums; // irradiance; each post is one line's

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform int azimuth; // of this dispatch
layout(std140, binding = 0) uniform Rays
{
    vec4 directions[256]; // drift along the minor axis per step, look, 1 where north, lines' shift
};

const int BLOCK = 4; // steps in which level 1 gets two pieces

// Level l of a history holds up to ENTRIES pieces, oldest first, of 2^l steps. Two pieces of a full
// level are joined to one of the next.
Passed history[LEVELS * ENTRIES];
int counts[LEVELS];
Passed joined; // that leaves a level
bool leaves;

// What is done for levels from 2 on, written out.
#if LEVELS == 5
#define FROM_LEVEL_2(f) f(2) f(3) f(4)
#elif LEVELS == 6
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5)
#elif LEVELS == 7
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6)
#elif LEVELS == 8
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6) f(7)
#elif LEVELS == 9
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6) f(7) f(8)
#elif LEVELS == 10
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6) f(7) f(8) f(9)
#elif LEVELS == 11
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6) f(7) f(8) f(9) f(10)
#elif LEVELS == 12
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6) f(7) f(8) f(9) f(10) f(11)
#elif LEVELS == 13
#define FROM_LEVEL_2(f) f(2) f(3) f(4) f(5) f(6) f(7) f(8) f(9) f(10) f(11) f(12)
#endif

// A line of the azimuth, and where it is over the tile, half a post around it included.
struct Line
{
    GridRay ray;
    float drift; // along the minor axis per step of the major axis towards +
    float shift; // of the first line
    int number;  // stands at minor coordinate number - shift + drift * i over major coordinate i
    bool north;
    int look;
    ivec2 length;  // posts along the major and the minor axis
    int first;     // steps walked, from the row or column that is farthest in view
    int last;
};

Line lineOf(int number)
{
    vec4 direction = directions[azimuth];
    Line line;
    line.drift = direction.x;
    line.look = int(direction.y);
    line.north = direction.z != 0.0;
    line.ray = gridRay(line.drift, line.look, line.north);
    line.length = line.north ? size.yx : size;
    line.shift = max(line.drift, 0.0) * float(line.length.x - 1) + direction.w;
    line.number = number;
    float start = float(number) - line.shift;
    float below = -0.999 - start;
    float above = float(line.length.y) - 0.001 - start;
    int low = 0;
    int high = line.length.x - 1;
    if (abs(line.drift) > 1.0e-6)
    {
        low = max(low, int(ceil(min(below / line.drift, above / line.drift))));
        high = min(high, int(floor(max(below / line.drift, above / line.drift))));
    }
    else if (below > 0.0 || above < 0.0)
        high = -1;
    line.first = line.look > 0 ? line.length.x - 1 - high : low;
    line.last = line.look > 0 ? line.length.x - 1 - low : high;
    return line;
}

int majorAt(Line line, int walked)
{
    return line.look > 0 ? line.length.x - 1 - walked : walked;
}

// Minor coordinate over a major one. Beside the tile it is that of the tile's last posts.
float minorAt(Line line, float major)
{
    float minor = float(line.number) - line.shift + line.drift * major;
    return clamp(minor, 0.0, float(line.length.y - 1));
}

ivec2 postAt(Line line, int major, int minor)
{
    return line.north ? ivec2(minor, major) : ivec2(major, minor);
}

Length heightAt(Line line, int major)
{
    float minor = minorAt(line, float(major));
    int whole = min(int(floor(minor)), max(line.length.y - 2, 0));
    ivec2 post = postAt(line, major, whole) + frame;
    return crossingHeight(postHeight(heights, post), postHeight(heights, post + line.ray.minor),
                          minor - float(whole));
}

// The cell that a step goes through at its middle. major: the less of the step's two; minor: of the
// middle.
ivec2 cellOf(Line line, int major, float minor)
{
    return postAt(line, clamp(major, 0, line.length.x - 2),
                  clamp(int(floor(minor)), 0, line.length.y - 2));
}

// What a cell sends where a step begins or ends, but for the sun's light: on the side of it towards
// - or + of the major axis (0, 1), at a minor coordinate. a > 0 where there is a cell, and what
// sunFacing() is.
vec4 faceAt(Line line, ivec2 cell, int side, float minor)
{
    ivec2 texel = 2 * cell + 1 + side * abs(line.ray.major);
    float weight = clamp(minor - float(line.north ? cell.x : cell.y), 0.0, 1.0);
    return mix(imageLoad(faces, texel), imageLoad(faces, texel + line.ray.minor), weight);
}

#ifdef SUN
// Height over the sun's shadow, and its softness, where a line or a ray crosses between two posts.
vec2 overAt(Line line, int major, float minor)
{
    int whole = clamp(int(floor(minor)), 0, line.length.y - 1);
    ivec2 post = postAt(line, clamp(major, 0, line.length.x - 1), whole);
    return mix(overSunShadow(post), overSunShadow(min(post + line.ray.minor, size - 1)),
               clamp(minor - float(whole), 0.0, 1.0));
}

// What sunFacing() is to be multiplied by, as in faceAt().
vec3 sunlit(Line line, ivec2 cell, int side, float minor)
{
    bool second = minor - float(line.north ? cell.x : cell.y) > 0.5;
    ivec2 nearest = cell + side * abs(line.ray.major) + (second ? line.ray.minor : ivec2(0));
    return sunIrradiance * texelFetch(albedo, min(nearest, textureSize(albedo, 0) - 1), 0).rgb;
}
#endif

// A place that a line has come to.
struct Place
{
    Length height;
    float minor;
    vec2 over; // the sun's shadow
};

Place nowhere()
{
    return Place(VOID_HEIGHT, 0.0, vec2(0.0));
}

Place placeAt(Line line, int major)
{
    Place place;
    place.minor = minorAt(line, float(major));
    place.height = heightAt(line, major);
#ifdef SUN
    place.over = overAt(line, major, place.minor);
#else
    place.over = vec2(0.0);
#endif
    return place;
}

// The step of ground that ends at a place; before: its farther end.
Passed passedAt(Line line, int walked, Place before, Place now, Length stepLength)
{
    int major = majorAt(line, walked);
    int ahead = line.look > 0 ? 1 : 0;
    ivec2 cell = cellOf(line, major - 1 + ahead, 0.5 * (before.minor + now.minor));
    vec4 far = faceAt(line, cell, ahead, before.minor);
    vec4 near = faceAt(line, cell, 1 - ahead, now.minor);
    bool ground = !isVoid(before.height) && !isVoid(now.height) && far.a > 0.0;
    vec3 sent = 0.5 * (far.rgb + near.rgb);
    vec3 more = far.rgb - near.rgb;
#ifdef SUN
    vec3 sun = sunlit(line, cell, ahead, before.minor);
    float lit = sunBetween(before.over, now.over);
    // Where an edge goes through it, one end has more of it.
    float tilt = (before.over.x > now.over.x ? 6.0 : -6.0) * lit * (1.0 - lit);
    sent += sun * (0.5 * (far.a + near.a) * lit);
    more += sun * ((far.a - near.a) * lit + 0.5 * (far.a + near.a) * tilt);
#endif
    Passed passed = passedStep(before.height, float(walked - 1), before.height - now.height, sent,
                               more, stepLength);
    if (!ground)
        passed = passedNothing();
    return passed;
}

void clearLevel(const int level)
{
    for (int i = 0; i < ENTRIES; ++i)
        history[level * ENTRIES + i] = passedNothing();
    counts[level] = 0;
}

// Joins the two oldest pieces of a level where it is full and needs room. They leave it, but for
// the last level, which keeps them as one.
void makeRoom(const int level, bool needed, Length stepLength)
{
    const int oldest = level * ENTRIES;
    const int gone = level == LEVELS - 1 ? 1 : 2;
    leaves = needed && counts[level] == ENTRIES;
    joined = joinPassed(history[oldest], history[oldest + 1], stepLength);
    for (int i = 0; i < ENTRIES; ++i)
    {
        if (leaves && i < ENTRIES - gone)
            history[oldest + i] = history[oldest + i + gone];
        if (leaves && i >= ENTRIES - gone)
            history[oldest + i].end = vec2(VOID_HEIGHT, -1.0);
    }
    if (leaves && gone == 1)
        history[oldest] = joined;
    counts[level] -= leaves ? gone : 0;
}

void enter(const int level, Passed passed, bool enters)
{
    for (int i = 0; i < ENTRIES; ++i)
        if (enters && counts[level] == i)
            history[level * ENTRIES + i] = passed;
    counts[level] += enters ? 1 : 0;
}

// What leaves the level before enters this one.
void moveUp(const int level, Length stepLength)
{
    Passed passed = joined;
    bool enters = leaves;
    makeRoom(level, enters, stepLength);
    enter(level, passed, enters);
}

// A post that looks along its slice.
struct Receiver
{
    Length here;
    int walked;
    Length stepLength;
    Slope cap; // slope of the horizon
    float width;
};

// The pieces of a level, nearest first. In two loops, so that compilers write them out.
SliceGather addLevel(SliceGather slice, const int level, Receiver receiver)
{
    const int oldest = level * ENTRIES;
    for (int i = ENTRIES - 1; i >= ENTRIES / 2; --i)
        slice = addPassed(slice, history[oldest + i], float(1 << level), receiver.here,
                          float(receiver.walked), receiver.stepLength, receiver.cap,
                          receiver.width);
    for (int i = ENTRIES / 2 - 1; i >= 0; --i)
        slice = addPassed(slice, history[oldest + i], float(1 << level), receiver.here,
                          float(receiver.walked), receiver.stepLength, receiver.cap,
                          receiver.width);
    return slice;
}

vec3 receive(Line line, ivec2 post, int walked)
{
    Receiver receiver;
    receiver.here = postHeight(heights, post + frame);
    receiver.walked = walked;
    receiver.stepLength = imageLoad(stepLengths, ivec2(azimuth, post.y)).x;
    receiver.cap = slopeOfCode(imageLoad(horizon, ivec3(post, azimuth)).x);
    receiver.width = 2.0 * PI / float(azimuths);
    float cosine = cos(receiver.width * float(azimuth));
    float sine = sin(receiver.width * float(azimuth));
    vec2 gradient = imageLoad(gradients, post).xy;
    vec3 normal = normalize(vec3(-gradient, 1.0));

    // The own cell's light is there already (bounce_own.comp); what it sends beside the post stands
    // in where nothing else is seen up to the crest.
    Slope plane = gradient.x * cosine + gradient.y * sine;
    Slope own = ownCellSlope(heights, post + frame, receiver.here, line.ray);
    int major = majorAt(line, walked);
    float minor = float(line.north ? post.x : post.y);
    int ahead = line.look > 0 ? 1 : 0;
    ivec2 cell = cellOf(line, major - 1 + ahead, minor + 0.5 * line.ray.drift);
    vec4 from = faceAt(line, cell, 1 - ahead, minor);
    Slope before = own / receiver.stepLength;
    vec3 sent = from.rgb;
#ifdef SUN
    vec2 over = overSunShadow(post);
    sent += sunlit(line, cell, 1 - ahead, minor) * from.a * sunBetween(over, over);
    Length lastHeight = receiver.here;
#endif
    SliceGather slice =
        startGather(raisedSlope(plane, before, receiver.cap), sent, receiver.width);
    for (int i = 1; i <= NEAR; ++i)
    {
        Length height = heightAtStep(heights, post, line.ray, i, size, frame);
        Slope slope = (height - receiver.here) / (float(i) * receiver.stepLength);
        cell = cellOf(line, major - 1 + ahead, minor + 0.5 * line.ray.drift);
        from = faceAt(line, cell, 1 - ahead, minor);
        major += line.look;
        minor += line.ray.drift;
        vec4 to = faceAt(line, cell, ahead, minor);
        // What is seen of the step is its farther part.
        float seen = clamp((slice.highest - before) / max(slope - before, 1.0e-6), 0.0, 1.0);
        from = mix(from, to, seen);
#ifdef SUN
        vec2 farther = overAt(line, major, minor);
        // Up to where the sun's shadow begins or ends, and from there on.
        over = mix(over, farther, seen);
        float edge = isVoid(lastHeight) ? 1.0 : shadowCrossing(over.x, farther.x);
        vec2 overEdge = mix(over, farther, edge);
        vec4 between = mix(from, to, edge);
        vec3 lit = sunlit(line, cell, ahead, minor);
        vec3 sun = lit * sunBetween(over, overEdge);
        edge = mix(seen, 1.0, edge);
        Length rise = crossingHeight(lastHeight, height, edge) - receiver.here;
        Slope atEdge = rise / (max(float(i - 1) + edge, 1.0e-3) * receiver.stepLength);
        // In the own cell the surface is a parabola, and its slope from the post is linear.
        atEdge = i > 1 ? atEdge : mix(before, slope, edge);
        slice = addGradedSegment(slice, atEdge, from.rgb + sun * from.a,
                                 between.rgb + sun * between.a, receiver.cap, receiver.width);
        sun = lit * sunBetween(overEdge, farther);
        from.rgb = between.rgb + sun * between.a;
        to.rgb += sun * to.a;
        over = farther;
        lastHeight = height;
#endif
        slice = addGradedSegment(slice, slope, from.rgb, to.rgb, receiver.cap, receiver.width);
        before = slope;
    }
#define ADD_LEVEL(level) slice = addLevel(slice, level, receiver);
    ADD_LEVEL(0)
    ADD_LEVEL(1)
    FROM_LEVEL_2(ADD_LEVEL)
    slice = closeGather(slice, receiver.cap, receiver.width);
    return received(slice, normal, cosine, sine);
}

// The post that asks the line there, if any. Which line a post asks follows from the post, so that
// rounding cannot give it two or none.
void serve(Line line, int walked)
{
    int major = majorAt(line, walked);
    float drifted = line.drift * float(major);
    int minor = int(floor(float(line.number) - line.shift + drifted));
    if (int(floor(float(minor) - drifted + line.shift + 0.5)) != line.number)
        ++minor;
    if (minor < 0 || minor >= line.length.y ||
        int(floor(float(minor) - drifted + line.shift + 0.5)) != line.number)
        return;
    ivec2 post = postAt(line, major, minor);
    if (isVoid(postHeight(heights, post + frame)))
        return;
    vec4 sum = imageLoad(sums, post);
    imageStore(sums, post, sum + vec4(receive(line, post, walked), 0.0));
}

#ifdef SURROUNDED
// Steps that lines of the whole terrain have walked where they come to the tile, less a multiple of
// 4096. In one piece most lines begin with the first of them, and so do blocks here.
uniform int walkedBefore;
const int ALIGNED = 4 * BLOCK;

uniform sampler2D farLight; // radiance that the ground of the coarser levels sends
// Columns of a window that are joined before they enter the history, 2^3.
const int SEED_OCTAVES = 3;

vec3 farSent(int level, vec2 place)
{
    Window window = windowOf(level, false);
    vec2 posts = (place - vec2(window.first)) / float(window.step);
    posts = clamp(posts, vec2(0.0), vec2((window.last - window.first) / window.step));
    vec2 texel = vec2(window.texel) + posts + 0.5;
    return textureLod(farLight, texel / vec2(textureSize(farLight, 0)), 0.0).rgb;
}

// Into a level from 2 on; what leaves it moves up.
void insert(int into, Passed piece, Length stepLength)
{
    leaves = false;
#define INSERT(level)                                                                              \
    {                                                                                              \
        bool here = level == into;                                                                 \
        Passed enters = joined;                                                                    \
        if (here)                                                                                  \
            enters = piece;                                                                        \
        here = here || leaves;                                                                     \
        makeRoom(level, here, stepLength);                                                         \
        enter(level, enters, here);                                                                \
    }
    FROM_LEVEL_2(INSERT)
    leaves = false;
}

// What the line has passed before it comes to the tile.
void passFar(Line line, Length stepLength)
{
    int major = majorAt(line, line.first);
    vec2 place = vec2(major, float(line.number) - line.shift + line.drift * float(major));
    place = line.north ? place.yx : place;
    Length height = VOID_HEIGHT; // where the last piece ended
    float from = 0.0;
    vec3 sent = vec3(0.0);
    for (int level = farLevels; level >= 1; --level)
    {
        Window window = windowOf(level, line.north);
        Window finer = windowOf(level - 1, line.north);
        if (level == 1) // light of its own has the tile only, not its ring
        {
            finer.first = ivec2(0);
            finer.last = size - 1;
        }
        float inner = max(exitOf(finer, place, line.ray), 0.0);
        Columns columns =
            columnsBetween(window, place, line.ray, inner, exitOf(window, place, line.ray));
        Passed joinedPiece = passedNothing();
        for (int i = 0; i < columns.count; ++i)
        {
            float away = columns.farthest - float(i * window.step);
            Length now = farHeight(level, place, line.ray, away);
            vec3 sentNow = farSent(level, place + line.ray.step * away);
            Passed piece = passedNothing();
            if (!isVoid(height) && !isVoid(now))
                piece = passedStep(height, float(line.first) - from, height - now,
                                   0.5 * (sent + sentNow), sent - sentNow,
                                   stepLength * (from - away));
            bool first = i % (1 << SEED_OCTAVES) == 0;
            Passed both = joinPassed(joinedPiece, piece, stepLength);
            joinedPiece = both;
            if (first)
                joinedPiece = piece;
            height = now;
            from = away;
            sent = sentNow;
            if (i == columns.count - 1 || (i + 1) % (1 << SEED_OCTAVES) == 0)
                insert(min(level + SEED_OCTAVES, LEVELS - 1), joinedPiece, stepLength);
        }
    }
}
#endif

void main()
{
    Line line = lineOf(int(INVOCATION.x));
    // Lines side by side are over the tile one after the other: of a group, the first and the last
    // have the extremes.
    Line one = lineOf(int(GROUP.x * gl_WorkGroupSize.x));
    Line other = lineOf(int((GROUP.x + 1u) * gl_WorkGroupSize.x) - 1);
    int begin = min(one.first, other.first);
    int end = max(one.last, other.last);
#ifdef SURROUNDED
    // Each begins with what it has passed, at the end of which the tile is.
    begin = line.first - (line.first + walkedBefore) % ALIGNED;
    end = line.last;
#endif
    Length stepLength = imageLoad(stepLengths, ivec2(azimuth, size.y / 2)).x;

#define CLEAR_LEVEL(level) clearLevel(level);
    CLEAR_LEVEL(0)
    CLEAR_LEVEL(1)
    FROM_LEVEL_2(CLEAR_LEVEL)
    counts[0] = ENTRIES; // of nothing, so that level 1 is full only where a block begins
#ifdef SURROUNDED
    if (begin <= end)
        passFar(line, stepLength);
#endif
    Place before = nowhere();
    for (int block = begin; block <= end; block += BLOCK)
    {
        makeRoom(1, true, stepLength);
#define MOVE_UP(level) moveUp(level, stepLength);
        FROM_LEVEL_2(MOVE_UP)
        for (int walked = block; walked < block + BLOCK; ++walked)
        {
            int passed = walked - NEAR;
            bool inside = passed >= line.first && passed <= line.last;
            Place now = nowhere();
            if (inside)
                now = placeAt(line, majorAt(line, passed));
            Passed step = passedAt(line, passed, before, now, stepLength);
            before = now;
            makeRoom(0, true, stepLength);
            enter(0, step, true);
            enter(1, joined, leaves);
            if (walked >= line.first && walked <= line.last)
                serve(line, walked);
        }
    }
}
