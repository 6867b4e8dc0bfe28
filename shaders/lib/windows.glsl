// Nested windows around a tile: heights of its own level near it, then of coarser and coarser ones
// (docs/methods/tiles.md). A ray is measured by the finest window that it has not left.

// Posts of one level. Places are in posts of the tile, from its first.
struct Window
{
    ivec2 first; // where its first post stands
    ivec2 last;  // and its last
    ivec2 texel; // of the first
    int step;    // from post to post, a power of two
};

// Steps that a ray makes from a place until it leaves a window; below 0 where it is outside.
real exitOf(Window window, vec2 place, GridRay ray)
{
    vec2 low = place - vec2(real(window.first.x), real(window.first.y));
    vec2 high = vec2(real(window.last.x), real(window.last.y)) - place;
    real x = ray.step.x < real(0.0) ? low.x : high.x;
    real y = ray.step.y < real(0.0) ? low.y : high.y;
    // Along an axis that it does not move along, it leaves nowhere.
    x = x / max(abs(ray.step.x), real(1.0e-7));
    y = y / max(abs(ray.step.y), real(1.0e-7));
    return min(x, y);
}

// Steps from a post to the first column of a window that is at least `away` >= 0 steps along a ray.
// Columns stand across the ray's major axis.
real columnFrom(Window window, ivec2 post, GridRay ray, real away)
{
    GLSL_ASSERT(away >= real(0.0));
    int look = ray.major.x + ray.major.y;
    int from = ray.major.x != 0 ? post.x - window.first.x : post.y - window.first.y;
    real step = real(window.step);
    real column = (real(from * look) + away) / step;
    // Rounding must not miss the column that is meant.
    return ceil(column - real(0.01)) * step - real(from * look);
}

// Height where a ray from a post crosses the column of a window `away` steps from it: void where it
// is outside.
Length columnHeight(HeightMap heights, Window window, ivec2 post, GridRay ray, real away)
{
    ivec2 from = post - window.first;
    int look = ray.major.x + ray.major.y;
    bool east = ray.major.x != 0;
    real step = real(window.step);
    int column = int(floor(real(east ? from.x : from.y) / step + real(look) * away / step + real(0.5)));
    real across = (real(east ? from.y : from.x) + ray.drift * away) / step;
    int whole = int(floor(across));
    ivec2 place = east ? ivec2(column, whole) : ivec2(whole, column);
    ivec2 count = (window.last - window.first) / window.step;
    bool inside = place.x >= 0 && place.y >= 0 && place.x <= count.x && place.y <= count.y;
    ivec2 texel = window.texel + place;
    if (!inside)
        return VOID_HEIGHT;
    return crossingHeight(postHeight(heights, texel), postHeight(heights, texel + ray.minor),
                          across - real(whole));
}

// Slope [m per step] at which a post of height `here` sees the surface of a window along its ray,
// at the column `away` steps from it or, if that is higher, at the row that the ray crosses between
// it and the column before; NO_HORIZON where neither has valid posts.
Slope slopeInWindow(HeightMap heights, Window window, ivec2 post, Length here, GridRay ray,
                    real away)
{
    GLSL_ASSERT(away > real(0.0));
    Length rise = columnHeight(heights, window, post, ray, away) - here;
    Slope slope = isVoid(rise) ? NO_HORIZON : rise / away;

    bool east = ray.major.x != 0;
    int look = ray.major.x + ray.major.y;
    real step = real(window.step);
    ivec2 from = post - window.first;
    real across = (real(east ? from.y : from.x) + ray.drift * away) / step;
    real before = across - ray.drift;
    real row = floor(max(across, before));
    real back = away - step;
    if (!(row > min(across, before)) || back < real(0.0))
        return slope;
    // The row's posts are one of each column's.
    real share = (row - before) / ray.drift;
    int column = int(floor(real(east ? from.x : from.y) / step + real(look) * away / step + real(0.5)));
    ivec2 place = east ? ivec2(column, int(row)) : ivec2(int(row), column);
    ivec2 count = (window.last - window.first) / window.step;
    bool inside = place.x >= 0 && place.y >= 0 && place.x <= count.x && place.y <= count.y;
    ivec2 texel = window.texel + place;
    rise = inside ? crossingHeight(postHeight(heights, texel - ray.major),
                                   postHeight(heights, texel), share) -
                        here
                  : VOID_HEIGHT;
    return isVoid(rise) ? slope : max(slope, rise / (back + share * step));
}
