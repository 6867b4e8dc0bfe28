// The windows around a tile, for passes whose lines come from beyond it; without SURROUNDED nothing
// surrounds the tile.
#ifdef SURROUNDED
uniform int farLevels; // coarser windows
// By level, the tile's own first: posts of the tile where the window's first and last post stand,
// and texels of the first, for rays along the axes east and north.
uniform ivec4 windowPosts[24];
uniform ivec4 windowTexels[24];
layout(r32f) readonly uniform image2D farHeights; // R32F [m], of all but the tile's own level

Window windowOf(int level, bool north)
{
    Window window;
    window.first = windowPosts[level].xy;
    window.last = windowPosts[level].zw;
    window.texel = north ? windowTexels[level].zw : windowTexels[level].xy;
    window.step = 1 << level;
    return window;
}

// Where a line that is at a place of the tile, or at its edge, has come from.
Length farHeight(int level, vec2 place, GridRay ray, float away)
{
    return columnHeight(farHeights, windowOf(level, ray.major.y != 0), place, ray, away);
}
#endif
