// Sky-view factor of every post from its horizons: the irradiance, over pi, of a uniform sky of
// radiance 1 above the horizontal (TW10 Eq. 5), or one of the two other definitions in use.
// SKY_TABLE: the light of a sky of any radiance instead.
layout(local_size_x = 8, local_size_y = 8) in;

// R32F [m], framed by `frame` void posts, row 0 south
layout(r32f) readonly uniform image2D heights;
uniform sampler2D eastSpacings; // R32F [m], one texel per row
// elevation codes, layer k looks towards 2*pi*k/m from east
layout(r16) readonly uniform image2DArray horizon;
#ifdef SKY_TABLE
layout(rgba16f, binding = 0) writeonly uniform image2D skyLight; // irradiance / pi
#else
layout(r32f, binding = 0) writeonly uniform image2D skyView;
#endif

uniform ivec2 size; // posts
uniform int frame;
uniform int azimuths;
uniform int definition; // 0 surface, 1 horizontal, 2 solid angle
uniform float northSpacing; // [m]

void main()
{
    ivec2 post = ivec2(INVOCATION.xy);
    if (post.x >= size.x || post.y >= size.y)
        return;
    if (isVoid(postHeight(heights, post + frame)))
    {
#ifdef SKY_TABLE
        imageStore(skyLight, post, vec4(0.0));
#else
        imageStore(skyView, post, vec4(-1.0));
#endif
        return;
    }
    vec3 normal = postNormal(heights, post + frame,
                             texelFetch(eastSpacings, ivec2(0, post.y), 0).x, northSpacing);
    float width = 2.0 * PI / float(azimuths);
    SkyShare sum = SkyShare(0.0);
    for (int k = 0; k < azimuths; ++k)
    {
        float phi = width * float(k);
        float elevation = elevationOfCode(imageLoad(horizon, ivec3(post, k)).x);
#ifdef SKY_TABLE
        sum += skyShare(elevation, normal, cos(phi), sin(phi), width, k);
#else
        sum += skySlice(elevation, normal, cos(phi), sin(phi), width, definition);
#endif
    }
#ifdef SKY_TABLE
    imageStore(skyLight, post, vec4(roundedToHalf(sum), 1.0));
#else
    imageStore(skyView, post, vec4(sum));
#endif
}
