// The near part of horizons, exact for the bilinear surface; completes what horizon_sweep.comp
// wrote. One invocation serves NEAR_POSTS posts that are neighbours along the minor axis.
layout(local_size_x = 16, local_size_y = 4) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
// R32F [m]: ground length of a step of direction x in row y
layout(r32f) readonly uniform image2D stepLengths;
layout(r16, binding = 0) uniform image2DArray horizon; // elevation codes

uniform ivec2 size; // posts
uniform int frame;
uniform int reach;
uniform vec4 direction; // as in horizon_sweep.comp

void main()
{
    bool north = direction.z != 0.0;
    int look = int(direction.y);
    int layer = int(direction.w);
    float drift = direction.x * float(look); // per step of the look direction
    ivec2 id = ivec2(INVOCATION.xy);
    int block = 8 * (north ? id.x : id.y);
    int along = north ? id.y : id.x;
    int breadth = north ? size.x : size.y;
    if (along >= (north ? size.y : size.x) || block >= breadth)
        return;

    // Mirrored so that the drift is positive: the block is then walked from its other end.
    int mirror = drift < 0.0 ? -1 : 1;
    int start = drift < 0.0 ? block + 7 : block;
    ivec2 first = north ? ivec2(start, along) : ivec2(along, start);
    NearRays rays;
    rays.major = north ? ivec2(0, look) : ivec2(look, 0);
    rays.minor = north ? ivec2(mirror, 0) : ivec2(0, mirror);
    rays.first = first + frame;
    rays.tangent = abs(drift);
    NearSlopes found = nearHorizon(heights, rays, reach);

    for (int i = 0; i < 8; ++i)
    {
        ivec2 post = first + rays.minor * i;
        if (post.x >= size.x || post.y >= size.y)
            continue;
        float code = VOID_CODE;
        if (!isVoid(postHeight(heights, post + frame)))
        {
            float stepLength = imageLoad(stepLengths, ivec2(layer, post.y)).x;
            code = codeOfElevation(elevationOfSlope(found.slopes[i] / stepLength));
            code = max(code, imageLoad(horizon, ivec3(post, layer)).x);
        }
        imageStore(horizon, ivec3(post, layer), vec4(code));
    }
}
