// An environment in spherical harmonics of order ORDER, group by group; harmonics_sum.comp adds the groups.
// A texel has one radiance over all it covers, and is integrated as that: a constant gives one coefficient.
layout(local_size_x = 64) in;

const int COUNT = ORDER * ORDER;
// Column i: coefficient i, row: group. RGBA32F.
layout(rgba32f, binding = 0) writeonly uniform image2D partials;
uniform int parts; // that a texel is cut in for the quadrature, where there are few: each way, or in height

#ifdef CUBE
uniform samplerCube environment; // radiance, read at texels' centres
shared vec3 radiances[64];
shared float terms[COUNT][64];

// Integrals of the basis over a texel, by two Gauss nodes each way and part. On a face from -1 to 1
// the solid angle is du dv / (1 + u^2 + v^2)^(3/2); a difference of arc tangents would lose digits.
ShTerms termsOfTexel(int face, ivec2 texel, float size)
{
    ShTerms sum;
    for (int i = 0; i < 36; ++i)
        sum.y[i] = 0.0;
    float width = 2.0 / (size * float(parts));
    for (int k = 0; k < 4 * parts * parts; ++k)
    {
        vec2 node = (vec2(k % 2, k / 2 % 2) - 0.5) * 0.57735026918962576451 + 0.5;
        vec2 place = vec2(texel * parts + ivec2(k / 4 % parts, k / 4 / parts)) + node;
        vec3 d = cubeDirection(face, place.x * width - 1.0, place.y * width - 1.0);
        float near = inversesqrt(dot(d, d));
        ShTerms there = shTerms(d * near, ORDER);
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
    vec3 sum = vec3(0.0);
    for (int first = 64 * int(gl_WorkGroupID.x); first < count; first += 64 * int(gl_NumWorkGroups.x))
    {
        int index = min(first + id, count - 1);
        ivec2 texel = ivec2(index % size, index / size % size);
        int face = index / size / size;
        vec2 centre = (2.0 * vec2(texel) + 1.0) / float(size) - 1.0;
        vec3 radiance = textureLod(environment, cubeDirection(face, centre.x, centre.y), 0.0).rgb;
        radiances[id] = first + id < count ? radiance : vec3(0.0);
        ShTerms mine = termsOfTexel(face, texel, float(size));
        for (int i = 0; i < COUNT; ++i)
            terms[i][id] = mine.y[i];
        barrier();
        vec3 part = vec3(0.0);
        for (int j = 0; j < 64; ++j)
            part += terms[min(id, COUNT - 1)][j] * radiances[j];
        sum += part;
        barrier();
    }
    if (id < COUNT)
        imageStore(partials, ivec2(id, int(gl_WorkGroupID.x)), vec4(sum, 1.0));
}
#else
// Columns counter-clockwise from east, rows from the nadir to the zenith, of equal angles.
uniform sampler2D environment;
uniform float heading; // [rad], clockwise, -pi ... pi
shared vec3 cosines[ORDER][64];
shared vec3 sines[ORDER][64];
shared float elevations[COUNT][3];

void main()
{
    int id = int(gl_LocalInvocationIndex);
    ivec2 size = textureSize(environment, 0);
    float width = 2.0 * PI / float(size.x);
    int band = int(sqrt(float(min(id, COUNT - 1)) + 0.5)); // this invocation's coefficient
    int order = min(id, COUNT - 1) - band * (band + 1);
    int m = abs(order);
    vec3 sum = vec3(0.0);
    for (int row = int(gl_WorkGroupID.x); row < size.y; row += int(gl_NumWorkGroups.x))
    {
        // Of cos and sin(m azimuth) times radiance over the columns; each is as wide for all of an m.
        vec3 c[ORDER];
        vec3 s[ORDER];
        for (int i = 0; i < ORDER; ++i)
        {
            c[i] = vec3(0.0);
            s[i] = vec3(0.0);
        }
        for (int column = id; column < size.x; column += 64)
        {
            vec3 radiance = texelFetch(environment, ivec2(column, row), 0).rgb;
            float phi = width * (float(column) + 0.5) - PI;
            vec2 one = -vec2(cos(phi), sin(phi)); // of phi + pi
            vec2 turned = vec2(1.0, 0.0);
            for (int i = 0; i < ORDER; ++i)
            {
                c[i] += turned.x * radiance;
                s[i] += turned.y * radiance;
                turned = vec2(turned.x * one.x - turned.y * one.y, turned.y * one.x + turned.x * one.y);
            }
        }
        for (int i = 0; i < ORDER; ++i)
        {
            cosines[i][id] = c[i];
            sines[i][id] = s[i];
        }
        // Of the elevation's part of the basis over the row: three Gauss nodes in each part.
        if (id < 3)
        {
            float node = 0.5 + 0.38729833462074168852 * float(id - 1);
            float weight = PI / float(size.y * parts) * (id == 1 ? 4.0 : 2.5) / 9.0;
            for (int i = 0; i < COUNT; ++i)
                elevations[i][id] = 0.0;
            for (int part = 0; part < parts; ++part)
            {
                float place = float(row) + (float(part) + node) / float(parts);
                float level = sin(PI * min(place, float(size.y) - place) / float(size.y));
                ShTerms there = shTerms(vec3(level, 0.0, -cos(PI * place / float(size.y))), ORDER);
                for (int i = 0; i < COUNT; ++i)
                    elevations[i][id] += weight * level * there.y[i];
            }
        }
        barrier();
        vec3 across = vec3(0.0);
        for (int j = 0; j < 64; ++j)
            across += order < 0 ? sines[m][j] : cosines[m][j];
        int own = band * (band + 1) + m;
        sum += across * (elevations[own][0] + elevations[own][1] + elevations[own][2]);
        barrier();
    }
    // The mean of cos(m azimuth) over a column; and all turned clockwise.
    sum *= m == 0 ? width : 2.0 * sin(0.5 * width * float(m)) / float(m);
    cosines[0][id] = sum;
    barrier();
    int other = band * (band + 1) - order;
    vec3 mixed = cos(float(m) * heading) * sum +
                 sin(float(order) * heading) * cosines[0][min(other, COUNT - 1)];
    if (id < COUNT)
        imageStore(partials, ivec2(id, int(gl_WorkGroupID.x)), vec4(mixed, 1.0));
}
#endif
