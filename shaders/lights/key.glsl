// Area lights at the edge of the sky: all functions give 0 without KEY_LIGHTS.
#ifdef KEY_LIGHTS
uniform sampler2DArray keyHorizon; // elevation codes, a layer per slice, light after light
uniform int keyCount;              // 1 ... 8
// Of each light: azimuth of its first slice [rad, counter-clockwise from east; the others follow
// clockwise], width of a slice, lowest >= 0 and highest elevation [rad].
uniform vec4 keyPlaces[8];
uniform vec4 keyRadiances[8]; // rgb; a = number of slices

// Irradiance / pi of a post by all key lights, as a surface of the given normal.
vec3 keyLight(ivec2 post, vec3 normal)
{
    vec3 light = vec3(0.0);
    int layer = 0;
    for (int i = 0; i < keyCount; ++i)
    {
        vec4 place = keyPlaces[i];
        float sum = 0.0;
        for (int slice = 0; slice < int(keyRadiances[i].a); ++slice)
        {
            float phi = place.x - place.y * float(slice);
            Angle elevation = elevationOfCode(texelFetch(keyHorizon, ivec3(post, layer), 0).x);
            sum += keySlice(elevation, place.z, place.w, normal, cos(phi), sin(phi), place.y);
            ++layer;
        }
        light += keyRadiances[i].rgb * sum;
    }
    return light;
}

// Adds what a post receives of them in harmonics, per colour.
ShVector[3] addKeyHarmonics(ShVector incident[3], ivec2 post, vec3 normal)
{
    int layer = 0;
    for (int i = 0; i < keyCount; ++i)
        for (int slice = 0; slice < int(keyRadiances[i].a); ++slice)
        {
            float across = keyPlaces[i].y;
            float phi = keyPlaces[i].x - across * float(slice);
            Slope plane = planeSlope(normal, cos(phi), sin(phi));
            Angle elevation = elevationOfCode(texelFetch(keyHorizon, ivec3(post, layer), 0).x);
            vec2 hidden = risingDirection(max(tan(clamp(elevation, -1.57, 1.57)), plane));
            vec2 lowest = vec2(cos(keyPlaces[i].z), sin(keyPlaces[i].z));
            vec2 highest = vec2(cos(keyPlaces[i].w), sin(keyPlaces[i].w));
            // Integrals of cos(m azimuth) over the slice's width.
            vec4 even = vec4(across, 2.0 * sin(0.5 * across), sin(across),
                             2.0 / 3.0 * sin(1.5 * across));
            AzimuthTerms terms = weighTerms(azimuthTerms(cos(phi), sin(phi)), even, vec4(0.0));
            vec4 visible = visibleBetween(hidden, lowest, highest);
            for (int c = 0; c < 3; ++c)
                incident[c] = addSlice(incident[c], keyRadiances[i][c] * visible, terms);
            ++layer;
        }
    return incident;
}
#else
vec3 keyLight(ivec2 post, vec3 normal)
{
    return vec3(0.0);
}

ShVector[3] addKeyHarmonics(ShVector incident[3], ivec2 post, vec3 normal)
{
    return incident;
}
#endif
