// The surface: bilinear between posts. Heights [m] are read from a texture that is framed by void
// posts on all sides, so that no read leaves it.

// Stands for a void post in a height texture; a mask, since no height is within a factor 1e24 of
// it. A bilinear mix with a void post stays below VOID_LIMIT, so a crossing next to a void casts
// nothing: the greatest weight below 1 leaves -6e22 in float, -1e14 in double.
GLSL_CONST Length VOID_HEIGHT = real(-1.0e30);
GLSL_CONST Length VOID_LIMIT = real(-1.0e12);

bool isVoid(Length height)
{
    return height < VOID_LIMIT;
}

// Height where a ray crosses the line between two neighbouring posts, `weight` of the way from a to
// b. A weight that rounding, or a fused multiply-add, moved out of 0 ... 1 is the end's: beyond it
// a void would cast, 1e30 times the slip high. Written out, since mix(a, b, 1) need not be b: a +
// (b - a) is 0 where a is void; but level ground must stay exactly level.
Length crossingHeight(Length a, Length b, real weight)
{
    Length between = a + (b - a) * max(weight, real(0.0));
    return weight < real(1.0) ? between : b;
}

Length postHeight(HeightMap heights, ivec2 post)
{
    return imageLoad(heights, post).x;
}

// Between posts, where any may be void: (height above `here` times weight, weight), bilinear.
// place: posts from the first, 0 ... size - 1; `frame` void posts surround them in the texture.
vec2 riseBetweenPosts(HeightMap heights, vec2 place, ivec2 size, int frame, Length here)
{
    GLSL_ASSERT(place.x >= real(0.0) && place.x <= real(size.x - 1));
    GLSL_ASSERT(place.y >= real(0.0) && place.y <= real(size.y - 1));
    int x = max(min(int(floor(place.x)), size.x - 2), 0);
    int y = max(min(int(floor(place.y)), size.y - 2), 0);
    real east = place.x - real(x);
    real north = place.y - real(y);
    vec2 sum = vec2(real(0.0), real(0.0));
    for (int i = 0; i < 4; ++i)
    {
        ivec2 post = ivec2(min(x + i % 2, size.x - 1), min(y + i / 2, size.y - 1));
        Length height = postHeight(heights, post + ivec2(frame, frame));
        real weight =
            (i % 2 == 0 ? real(1.0) - east : east) * (i / 2 == 0 ? real(1.0) - north : north);
        if (!isVoid(height))
            sum = sum + vec2((height - here) * weight, weight);
    }
    return sum;
}

// What the surface rises or falls from a post (texel of the framed texture) to its eight
// neighbours at most, voids left out [m].
Length postRelief(HeightMap heights, ivec2 post)
{
    Length here = postHeight(heights, post);
    Length relief = real(0.0);
    for (int i = 0; i < 9; ++i)
    {
        Length beside = postHeight(heights, post + ivec2(i % 3 - 1, i / 3 - 1));
        relief = max(relief, isVoid(beside) ? real(0.0) : abs(beside - here));
    }
    return relief;
}

// Unit normal of a cell at (east, north), 0 ... 1, in it. corners: its heights south-west,
// south-east, north-west, north-east; none void. eastSpacing and northSpacing [m] > 0.
vec3 cellNormal(vec4 corners, real east, real north, Length eastSpacing, Length northSpacing)
{
    GLSL_ASSERT(min(east, north) >= real(0.0) && max(east, north) <= real(1.0));
    GLSL_ASSERT(min(eastSpacing, northSpacing) > real(0.0));
    GLSL_ASSERT(!isVoid(min(min(corners.x, corners.y), min(corners.z, corners.w))));
    real x = (corners.y - corners.x) * (real(1.0) - north) + (corners.w - corners.z) * north;
    real y = (corners.z - corners.x) * (real(1.0) - east) + (corners.w - corners.y) * east;
    return normalize(vec3(-x * northSpacing, -y * eastSpacing, eastSpacing * northSpacing));
}

// Unit normal at a post (texel of the framed texture): sum of the unnormalised normals of the up to
// four adjacent cells that have no void corner (Timonen and Westerholm 2010, section 7); straight
// up where there is none. eastSpacing and northSpacing [m] > 0.
vec3 postNormal(HeightMap heights, ivec2 post, Length eastSpacing, Length northSpacing)
{
    GLSL_ASSERT(min(eastSpacing, northSpacing) > real(0.0));
    Length here = postHeight(heights, post);
    real east = real(0.0);
    real north = real(0.0);
    real count = real(0.0);
    for (int quadrant = 0; quadrant < 4; ++quadrant)
    {
        int x = quadrant % 2 == 0 ? 1 : -1;
        int y = quadrant < 2 ? 1 : -1;
        Length besideX = postHeight(heights, post + ivec2(x, 0));
        Length besideY = postHeight(heights, post + ivec2(0, y));
        Length across = postHeight(heights, post + ivec2(x, y));
        if (!isVoid(besideX) && !isVoid(besideY) && !isVoid(across))
        {
            east = east + real(x) * (besideX - here);
            north = north + real(y) * (besideY - here);
            count = count + real(1.0);
        }
    }
    // The cell's normal at its corner is (-dh/dx, -dh/dy, 1) times the cell's area, the same for
    // all.
    vec3 normal = vec3(-east * northSpacing, -north * eastSpacing,
                       max(count, real(1.0)) * eastSpacing * northSpacing);
    return normalize(normal);
}

// The mirror direction of a unit direction about a unit normal, both away from the surface.
vec3 mirrored(vec3 direction, vec3 normal)
{
    GLSL_ASSERT(isUnit(direction) && isUnit(normal));
    return normal * (real(2.0) * dot(normal, direction)) - direction;
}
