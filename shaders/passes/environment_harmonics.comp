// An environment in spherical harmonics of order ORDER, group by group; harmonics_sum.comp adds the
// groups. A texel has one radiance over all it covers, and is integrated as that: a constant gives
// one coefficient.
//
// Each invocation adds its texels in registers, and the group's are added once at the end.
layout(local_size_x = 32) in;

const int COUNT = ORDER * ORDER;
// Column i: coefficient i, row: group. RGBA32F.
layout(rgba32f, binding = 0) writeonly uniform image2D partials;
// that a texel is cut in for the quadrature, where there are few: each way, or in height
uniform int parts;
shared vec3 sums[COUNT][32];

#ifdef CUBE
uniform samplerCube environment; // radiance, read at texels' centres

// Integrals of the basis over a texel, by two Gauss nodes each way and part. On a face from -1 to 1
// the solid angle is du dv / (1 + u^2 + v^2)^(3/2); a difference of arc tangents would lose digits.
ShTerms termsOfTexel(int face, ivec2 texel, float size)
{
    ShTerms sum;
    for (int i = 0; i < COUNT; ++i)
        sum.y[i] = 0.0;
    float width = 2.0 / (size * float(parts));
    for (int k = 0; k < 4 * parts * parts; ++k)
    {
        vec2 node = (vec2(k % 2, k / 2 % 2) - 0.5) * 0.57735026918962576451 + 0.5;
        vec2 place = vec2(texel * parts + ivec2(k / 4 % parts, k / 4 / parts)) + node;
        vec3 d = cubeDirection(face, place.x * width - 1.0, place.y * width - 1.0);
        float near = inversesqrt(dot(d, d));
        ShTerms there = shTerms(d * near);
        float weight = 0.25 * width * width * near * near * near;
        for (int i = 0; i < COUNT; ++i)
            sum.y[i] += weight * there.y[i];
    }
    return sum;
}

void main()
{
    int id = int(gl_LocalInvocationIndex);
    int size = textureSize(environment, 0).x;
    int count = 6 * size * size;
    vec3 sum[COUNT];
    for (int i = 0; i < COUNT; ++i)
        sum[i] = vec3(0.0);
    for (int index = 32 * int(gl_WorkGroupID.x) + id; index < count;
         index += 32 * int(gl_NumWorkGroups.x))
    {
        ivec2 texel = ivec2(index % size, index / size % size);
        int face = index / size / size;
        vec2 centre = (2.0 * vec2(texel) + 1.0) / float(size) - 1.0;
        vec3 radiance = textureLod(environment, cubeDirection(face, centre.x, centre.y), 0.0).rgb;
        ShTerms terms = termsOfTexel(face, texel, float(size));
        for (int i = 0; i < COUNT; ++i)
            sum[i] += terms.y[i] * radiance;
    }
    for (int i = 0; i < COUNT; ++i)
        sums[i][id] = sum[i];
    barrier();
    for (int i = id; i < COUNT; i += 32)
    {
        vec3 whole = vec3(0.0);
        for (int j = 0; j < 32; ++j)
            whole += sums[i][j];
        imageStore(partials, ivec2(i, int(gl_WorkGroupID.x)), vec4(whole, 1.0));
    }
}
#else
// Columns counter-clockwise from east, rows from the nadir to the zenith, of equal angles.
uniform sampler2D environment;
uniform float heading; // [rad], clockwise, -pi ... pi

// Integrals of the elevation's part of the basis over a row, at +m: three Gauss nodes in each part.
ShTerms termsOfRow(int row, float rows)
{
    ShTerms sum;
    for (int i = 0; i < COUNT; ++i)
        sum.y[i] = 0.0;
    for (int k = 0; k < 3 * parts; ++k)
    {
        float node = 0.5 + 0.38729833462074168852 * float(k % 3 - 1);
        float place = float(row) + (float(k / 3) + node) / float(parts);
        float level = sin(PI * min(place, rows - place) / rows);
        ShTerms there = shTerms(vec3(level, 0.0, -cos(PI * place / rows)));
        float weight = PI / (rows * float(parts)) * (k % 3 == 1 ? 4.0 : 2.5) / 9.0 * level;
        for (int i = 0; i < COUNT; ++i)
            sum.y[i] += weight * there.y[i];
    }
    return sum;
}

void main()
{
    int id = int(gl_LocalInvocationIndex);
    ivec2 size = textureSize(environment, 0);
    float width = 2.0 * PI / float(size.x);
    vec3 sum[COUNT];
    for (int i = 0; i < COUNT; ++i)
        sum[i] = vec3(0.0);
    for (int row = int(gl_WorkGroupID.x); row < size.y; row += int(gl_NumWorkGroups.x))
    {
        // Of radiance times cos and sin(m azimuth) at columns' middles.
        vec3 cosines[ORDER];
        vec3 sines[ORDER];
        for (int m = 0; m < ORDER; ++m)
        {
            cosines[m] = vec3(0.0);
            sines[m] = vec3(0.0);
        }
        for (int column = id; column < size.x; column += 32)
        {
            vec3 radiance = texelFetch(environment, ivec2(column, row), 0).rgb;
            float phi = width * (float(column) + 0.5) - PI;
            vec2 one = -vec2(cos(phi), sin(phi)); // of phi + pi
            vec2 turned = vec2(1.0, 0.0);
            for (int m = 0; m < ORDER; ++m)
            {
                cosines[m] += turned.x * radiance;
                sines[m] += turned.y * radiance;
                turned =
                    vec2(turned.x * one.x - turned.y * one.y, turned.y * one.x + turned.x * one.y);
            }
        }
        ShTerms terms = termsOfRow(row, float(size.y));
        for (int l = 0; l < ORDER; ++l)
            for (int m = 0; m < ORDER; ++m)
                if (m <= l)
                {
                    sum[l * (l + 1) - m] += terms.y[l * (l + 1) + m] * sines[m]; // 0 where m is
                    sum[l * (l + 1) + m] += terms.y[l * (l + 1) + m] * cosines[m];
                }
    }
    for (int i = 0; i < COUNT; ++i)
        sums[i][id] = sum[i];
    barrier();
    for (int i = id; i < COUNT; i += 32)
    {
        vec3 whole = sums[i][0];
        for (int j = 1; j < 32; ++j)
            whole += sums[i][j];
        sums[i][0] = whole;
    }
    barrier();
    for (int i = id; i < COUNT; i += 32)
    {
        int band = int(sqrt(float(i) + 0.5));
        int order = i - band * (band + 1);
        float m = float(abs(order));
        // The mean over a column; and all is turned clockwise, which mixes m and -m.
        float across = order == 0 ? width : 2.0 * sin(0.5 * width * m) / m;
        vec3 turned = cos(m * heading) * sums[i][0] +
                      sin(float(order) * heading) * sums[band * (band + 1) - order][0];
        imageStore(partials, ivec2(i, int(gl_WorkGroupID.x)), vec4(across * turned, 1.0));
    }
}
#endif
