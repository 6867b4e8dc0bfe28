// Nested windows around a tile: heights of its own level near it, then of coarser and coarser ones
// (docs/methods/tiles.md). A ray is measured by the finest window that it has not left.

// Posts of one level. Places are in posts of the tile, from its first.
struct Window
{
    ivec2 first; // where its first post stands
    ivec2 last;  // where it ends: at its last post or, if that is beyond the data, before it
    ivec2 texel; // of the first
    int step;    // from post to post, a power of two
};

// Whether a window has a post of that column and row of its own.
bool hasPost(Window window, ivec2 post)
{
    ivec2 count = window.last - window.first + ivec2(window.step - 1, window.step - 1);
    return post.x >= 0 && post.y >= 0 && post.x <= count.x / window.step &&
           post.y <= count.y / window.step;
}

// Steps that a ray makes from a place until it leaves a window; below 0 where it is outside.
real exitOf(Window window, vec2 place, GridRay ray)
{
    vec2 low = place - vec2(real(window.first.x), real(window.first.y));
    vec2 high = vec2(real(window.last.x), real(window.last.y)) - place;
    real x = ray.step.x < real(0.0) ? low.x : high.x;
    real y = ray.step.y < real(0.0) ? low.y : high.y;
    // Along an axis that it does not move along, it leaves nowhere.
    real east = abs(ray.step.x);
    real north = abs(ray.step.y);
    x = east < real(1.0e-7) ? (x < real(0.0) ? real(-1.0) : real(1.0e9)) : x / east;
    y = north < real(1.0e-7) ? (y < real(0.0) ? real(-1.0) : real(1.0e9)) : y / north;
    return min(x, y);
}

// Columns of a window that a line crosses, from one so many steps away to another, nearer one.
struct Columns
{
    int count;
    real farthest; // steps
};

// Those at more than `inner` and at most `outer` steps from a place of the line, 0 <= inner, whose
// major coordinate is whole.
Columns columnsBetween(Window window, vec2 place, GridRay ray, real inner, real outer)
{
    GLSL_ASSERT(inner >= real(0.0));
    real look = real(ray.major.x + ray.major.y);
    real step = real(window.step);
    real from = look * (ray.major.x != 0 ? place.x - real(window.first.x)
                                         : place.y - real(window.first.y));
    real last = floor((from + outer) / step);
    Columns columns;
    columns.count = max(int(last) - int(floor((from + inner) / step)), 0);
    columns.farthest = last * step - from;
    return columns;
}

// Where a line is at a column of a window, in posts of the window from its first.
struct ColumnPlace
{
    int column;  // along the major axis
    real across; // along the minor one
};

// At the column `away` steps from a place, whose major coordinate is whole.
ColumnPlace columnPlace(Window window, vec2 place, GridRay ray, real away)
{
    vec2 from = place - vec2(real(window.first.x), real(window.first.y));
    bool east = ray.major.x != 0;
    real step = real(window.step);
    real along = (east ? from.x : from.y) + real(ray.major.x + ray.major.y) * away;
    ColumnPlace at;
    at.column = int(floor(along / step + real(0.5)));
    at.across = ((east ? from.y : from.x) + ray.drift * away) / step;
    return at;
}

ivec2 postOfColumn(GridRay ray, int column, int minor)
{
    return ray.major.x != 0 ? ivec2(column, minor) : ivec2(minor, column);
}

// Height where a line crosses the column of a window `away` steps from a place, whose major
// coordinate is whole: void where it is outside.
Length columnHeight(HeightMap heights, Window window, vec2 place, GridRay ray, real away)
{
    ColumnPlace at = columnPlace(window, place, ray, away);
    int whole = int(floor(at.across));
    ivec2 post = postOfColumn(ray, at.column, whole);
    if (!hasPost(window, post))
        return VOID_HEIGHT;
    ivec2 texel = window.texel + post;
    return crossingHeight(postHeight(heights, texel), postHeight(heights, texel + ray.minor),
                          at.across - real(whole));
}

// Where a line crosses a row of a window: steps from a place, and height, void where there is none.
struct Crossing
{
    real away;
    Length height;
};

// Between the column `away` steps from a place and the next one, farther away.
Crossing rowCrossing(HeightMap heights, Window window, vec2 place, GridRay ray, real away)
{
    ColumnPlace at = columnPlace(window, place, ray, away);
    real beyond = at.across + ray.drift;
    real row = floor(max(at.across, beyond));
    ivec2 post = postOfColumn(ray, at.column, int(row));
    Crossing crossing;
    crossing.away = away;
    crossing.height = VOID_HEIGHT;
    if (row > min(at.across, beyond) && hasPost(window, post) && hasPost(window, post + ray.major))
    {
        // The row's posts are one of each column's.
        real share = (row - at.across) / ray.drift;
        ivec2 texel = window.texel + post;
        Length nearer = postHeight(heights, texel);
        crossing.away = away + share * real(window.step);
        crossing.height =
            crossingHeight(nearer, postHeight(heights, texel + ray.major), share);
    }
    return crossing;
}
