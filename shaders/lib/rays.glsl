// Straight rays over the grid of posts, and how high the surface stands along them: the walk that
// bounces, gloss, Legendre light and pyramid horizons share.

// A direction on the grid.
struct GridRay
{
    ivec2 major; // one post along the axis that the ray crosses faster
    ivec2 minor; // one post along the other, to the east or north
    ivec2 side;  // minor or its opposite: where the ray drifts
    real drift;  // [posts] along minor per step, -1 ... 1
    vec2 step;   // [posts] east and north
};

// turn: drift per step of a look of 1, -1 ... 1; look: 1 or -1, the sense along the major axis;
// north: the major axis is northward.
GridRay gridRay(real turn, int look, bool north)
{
    GLSL_ASSERT(abs(turn) <= real(1.0) && (look == 1 || look == -1));
    GridRay ray;
    ray.major = north ? ivec2(0, look) : ivec2(look, 0);
    ray.minor = north ? ivec2(1, 0) : ivec2(0, 1);
    ray.drift = turn * real(look);
    ray.side = ray.drift < real(0.0) ? ivec2(0, 0) - ray.minor : ray.minor;
    ray.step = north ? vec2(ray.drift, real(look)) : vec2(real(look), ray.drift);
    return ray;
}

// Height [m] where a ray from a post crosses a line of posts, after a whole number of steps >= 0.
// VOID_HEIGHT where the crossing is outside of the posts or beside a void.
Length heightAtStep(HeightMap heights, ivec2 post, GridRay ray, int steps, ivec2 size, int frame)
{
    GLSL_ASSERT(steps >= 0);
    real offset = ray.drift * real(steps);
    real whole = floor(offset);
    ivec2 place = post + ray.major * steps + ray.minor * int(whole);
    bool inside = place.x >= 0 && place.y >= 0 && place.x < size.x && place.y < size.y;
    // Beside the last post is the frame, which is void.
    ivec2 texel = ivec2(max(min(place.x, size.x - 1), 0) + frame,
                        max(min(place.y, size.y - 1), 0) + frame);
    Length height = crossingHeight(postHeight(heights, texel),
                                   postHeight(heights, texel + ray.minor), offset - whole);
    return inside && !isVoid(height) ? height : VOID_HEIGHT;
}

// Slope [m per step] of the cell that a ray leaves its post through, at the post. texel: of the
// post; here: its height. NO_HORIZON beside a void.
Slope ownCellSlope(HeightMap heights, ivec2 texel, Length here, GridRay ray)
{
    Length ahead = postHeight(heights, texel + ray.major);
    Length beside = postHeight(heights, texel + ray.side);
    return isVoid(ahead) || isVoid(beside) ? NO_HORIZON
                                           : ahead - here + abs(ray.drift) * (beside - here);
}

// Whether a place [posts] is on the surface. room [posts] >= 0: for rounding, so that the last post
// of a ray along an edge is.
bool onSurface(vec2 place, ivec2 size, real room)
{
    return place.x >= -room && place.y >= -room && place.x <= real(size.x - 1) + room &&
           place.y <= real(size.y - 1) + room;
}

// The pyramid of heights: level n >= 1 has a texel on every 2^n-th post, height times weight and
// weight; all levels stand in one texture, `level` is x, y, width, height of one of them.

// The level for a sample, nearest to `octaves` above the posts; a half is up, whichever way the
// division that made it was rounded. count: of levels, the posts included.
int pyramidLevel(real octaves, int count)
{
    GLSL_ASSERT(count >= 1);
    return max(min(int(floor(octaves + real(0.5001))), count - 1), 0);
}

// Where a place [posts] on the surface is in the texture [texels], for a filtered read.
vec2 pyramidTexel(ivec4 level, vec2 place, int number)
{
    GLSL_ASSERT(number >= 0 && number < 31);
    real side = real(1 << number);
    return vec2(real(level.x) + place.x / side + real(0.5),
                real(level.y) + place.y / side + real(0.5));
}

// The same in a pyramid of what cells send, whose texels cover 2^n cells each way.
vec2 cellPyramidTexel(ivec4 level, vec2 place, int number)
{
    GLSL_ASSERT(number >= 0 && number < 31);
    real side = real(1 << number);
    return vec2(real(level.x) + clamp(place.x / side, real(0.5), real(level.z) - real(0.5)),
                real(level.y) + clamp(place.y / side, real(0.5), real(level.w) - real(0.5)));
}

// Height [m] of a read of the pyramid; VOID_HEIGHT where half of it or more is void.
Length pyramidHeight(vec2 read)
{
    return read.y > real(0.5) ? read.x / read.y : VOID_HEIGHT;
}

// (height above `here` times weight, weight) of a read.
vec2 pyramidRise(vec2 read, Length here)
{
    return vec2(read.x - here * read.y, read.y);
}

// Slope of such a rise at a distance [m] > 0; NO_HORIZON where half of it or more is void.
Slope slopeOfRise(vec2 rise, real distance, Length stepLength)
{
    GLSL_ASSERT(distance > real(0.0) && stepLength > real(0.0));
    return rise.y > real(0.5) ? rise.x / (rise.y * distance * stepLength) : NO_HORIZON;
}

// Slope of a horizon's elevation code, void or steeper than 89.95 degrees too.
Slope slopeOfCode(real code)
{
    return tan(
        clamp(elevationOfCode(max(code, real(1.0) / real(65535.0))), real(-1.57), real(1.57)));
}

// Slope at which a slice of azimuth meets the surface's own plane. normal: unit, facing up.
Slope planeSlope(vec3 normal, real cosine, real sine)
{
    GLSL_ASSERT(isUnit(normal) && normal.z > real(0.0) && isUnitPair(cosine, sine));
    return -(normal.x * cosine + normal.y * sine) / normal.z;
}
