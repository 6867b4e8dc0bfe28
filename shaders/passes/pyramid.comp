// One level of a pyramid from the next finer one (Nowrouzezahrai and Snyder 2009, section 5.2).
// Texels hold value times weight, weight; the weight is how much of them is valid.
//
// HEIGHTS stand on posts: a texel on every second one of the finer level, the first on the first,
// so that levels need no shift and odd sizes no exception; it is the mean under the linear
// B-spline. Radiance fills cells: a texel is the mean of four; FROM_CELLS: of radiance.comp.
// ON_POSTS: radiance that stands on posts. LAYERED: of a texture array; four values times the
// weight that the pyramid of heights has there.
layout(local_size_x = 8, local_size_y = 8) in;

#ifdef HEIGHTS
layout(rg32f, binding = 0) writeonly uniform image2D pyramid;
#elif defined(LAYERED)
layout(rgba16f, binding = 0) writeonly uniform image2DArray pyramid;
#else
layout(rgba16f, binding = 0) writeonly uniform image2D pyramid;
#endif
#ifdef LAYERED
uniform sampler2DArray finer;
#define IN_LAYER(place) ivec3(place, INVOCATION.z)
#else
uniform sampler2D finer;
#define IN_LAYER(place) place
#endif
uniform ivec4 from; // x, y, width, height of the finer level in its texture
uniform ivec4 to;   // of this level in `pyramid`

vec4 finerTexel(ivec2 place)
{
    bool inside = all(greaterThanEqual(place, ivec2(0))) && all(lessThan(place, from.zw));
    vec4 texel = texelFetch(finer, IN_LAYER(from.xy + clamp(place, ivec2(0), from.zw - 1)), 0);
#ifdef FROM_POSTS
    texel = isVoid(texel.x) ? vec4(0.0) : vec4(texel.x, 1.0, 0.0, 0.0);
#endif
#ifdef FROM_CELLS
    texel.a = texel.a > 0.0 ? 1.0 : 0.0;
#endif
    return inside ? texel : vec4(0.0);
}

void main()
{
    ivec2 place = ivec2(INVOCATION.xy);
    if (place.x >= to.z || place.y >= to.w)
        return;
    vec4 sum = vec4(0.0);
#if defined(HEIGHTS) || defined(ON_POSTS)
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            sum += (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25) *
                   finerTexel(2 * place + ivec2(x, y));
#else
    for (int i = 0; i < 4; ++i)
        sum += 0.25 * finerTexel(2 * place + ivec2(i % 2, i / 2));
#endif
#ifndef HEIGHTS
    sum = vec4(roundedToHalf(sum.rgb), roundedToHalf(sum.aaa).x);
#endif
    imageStore(pyramid, IN_LAYER(to.xy + place), sum);
}
