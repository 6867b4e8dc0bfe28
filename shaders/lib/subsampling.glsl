// Light that is gathered at one post of every block of stride * stride posts, and shaded at all of
// them with their own normals (NS09, section 7).

// The post that stands for a block: its first valid one, row by row; its first where none is.
// stride: >= 1; block: its first post is inside of size.
ivec2 postOfBlock(HeightMap heights, ivec2 block, int stride, ivec2 size, int frame)
{
    GLSL_ASSERT(stride >= 1 && block.x >= 0 && block.y >= 0);
    GLSL_ASSERT(block.x * stride < size.x && block.y * stride < size.y);
    ivec2 first = ivec2(block.x * stride, block.y * stride);
    ivec2 post = first;
    for (int i = stride * stride - 1; i >= 0; --i)
    {
        ivec2 candidate = first + ivec2(i % stride, i / stride);
        bool inside = candidate.x < size.x && candidate.y < size.y;
        ivec2 read =
            ivec2(min(candidate.x, size.x - 1) + frame, min(candidate.y, size.y - 1) + frame);
        if (inside && !isVoid(postHeight(heights, read)))
            post = candidate;
    }
    return post;
}

// How much the light of one of the four blocks about a post counts there: bilinear, and less the
// farther it stands off the post's own plane, so that light does not bleed over edges. corner: 0 or
// 1 in x and y; share: of the way from corner 0 to corner 1, 0 ... 1; across [m]: from the post to
// the block; normal: of the post; spacing [m] > 0: of posts. Never quite 0: a post whose nearest
// blocks are void takes what there is.
real blockWeight(ivec2 corner, vec2 share, vec3 across, vec3 normal, Length spacing)
{
    GLSL_ASSERT((corner.x == 0 || corner.x == 1) && (corner.y == 0 || corner.y == 1));
    GLSL_ASSERT(min(share.x, share.y) >= real(0.0) && max(share.x, share.y) <= real(1.0));
    GLSL_ASSERT(isUnit(normal) && spacing > real(0.0));
    real east = corner.x == 0 ? real(1.0) - share.x : share.x;
    real north = corner.y == 0 ? real(1.0) - share.y : share.y;
    real off = dot(across, normal) / spacing;
    return max(east * north, real(1.0e-3)) / (real(1.0) + real(0.5) * off * off);
}
