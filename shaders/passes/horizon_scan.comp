// Horizons of chosen posts by an exhaustive scan of their rays: cost is posts x directions x steps,
// so for a few posts only; what the sweep is measured against.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D posts;      // R32F, 2 x count: column, row
// R32F, 4 x count: as the first three of horizon_sweep.comp's, and the lowest slope that matters
// [m per step]; 0: all do
uniform sampler2D directions;
layout(r32f, binding = 0) writeonly uniform image2D slopes; // [m per step], post x direction

uniform ivec2 size; // posts of the tile
uniform int frame;
uniform float highest; // post [m]
uniform ivec2 count; // posts, directions

void main()
{
    ivec2 id = ivec2(INVOCATION.xy);
    if (id.x >= count.x || id.y >= count.y)
        return;
    ivec2 post =
        ivec2(texelFetch(posts, ivec2(0, id.x), 0).x, texelFetch(posts, ivec2(1, id.x), 0).x);
    int look = int(texelFetch(directions, ivec2(1, id.y), 0).x);
    float drift = texelFetch(directions, ivec2(0, id.y), 0).x * float(look);
    bool north = texelFetch(directions, ivec2(2, id.y), 0).x != 0.0;

    int turn = drift < 0.0 ? -1 : 1;
    ivec2 major = north ? ivec2(0, look) : ivec2(look, 0);
    ivec2 minor = north ? ivec2(turn, 0) : ivec2(0, turn);
    ivec2 ahead = ivec2(post.x, post.y); // posts to the edge of the data
    if (major.x + minor.x > 0)
        ahead.x = size.x - 1 - post.x;
    if (major.y + minor.y > 0)
        ahead.y = size.y - 1 - post.y;
    int steps = north ? ahead.y : ahead.x;
    float room = float(north ? ahead.x : ahead.y);
    // The ray may leave by its side before its end; a row crossing can stand in the step after.
    if (room < abs(drift) * float(steps))
        steps = min(steps, int(room / abs(drift)) + 1);
    float lowest = texelFetch(directions, ivec2(3, id.y), 0).x;
    float rise = highest - postHeight(heights, post + frame);
    // Farther away than this no post rises above the lowest slope. A row crossing can stand up to a
    // step before the column that ends its step.
    if (rise < lowest * float(steps))
        steps = min(steps, int(rise / lowest) + 2);
    float slope = horizonAlongRay(heights, post + frame, major, minor, abs(drift), steps);
    imageStore(slopes, id, vec4(slope));
}
