// What a host shader calls for glossy terrain: colour = albedo * terrainShading(...).rgb +
// terrainGloss(...). Comes after shaders/lib (createGlossShader); GLSL 3.30 on.

// RGBA16F: 12 layers of harmonics; normal, gloss, exponent
uniform sampler2DArray osgTerrainLight_gloss;
// of which alpha is read, the visible fraction of the sun
uniform sampler2D osgTerrainLight_shading;
uniform vec3 osgTerrainLight_sunDirection;     // unit: x east, y north, z up
uniform vec3 osgTerrainLight_sunIrradiance;    // on a surface that faces it; 0 where there is none
uniform float osgTerrainLight_formerPart; // as in terrain_shading.glsl; former light has no gloss

// coordinate: as terrainShading's. toViewer: unit, in the tile's frame: x east, y north, z up.
// Scene-linear radiance sent there by gloss: sky and terrain through harmonics of order 4, the sun
// sharply.
vec3 terrainGloss(vec2 coordinate, vec3 toViewer)
{
    if (osgTerrainLight_formerPart >= 1.0)
        return vec3(0.0);
    ShVector basis = shBasis(toViewer);
    vec3 sent = vec3(0.0);
    for (int c = 0; c < 3; ++c)
        for (int j = 0; j < 4; ++j)
            sent[c] +=
                dot(texture(osgTerrainLight_gloss, vec3(coordinate, float(4 * c + j))), basis.c[j]);
    vec4 surface = texture(osgTerrainLight_gloss, vec3(coordinate, 12.0));
    vec3 normal = vec3(surface.xy, sqrt(max(1.0 - dot(surface.xy, surface.xy), 0.0)));
    vec3 mirror = 2.0 * dot(normal, toViewer) * normal - toViewer;
    float visible = texture(osgTerrainLight_shading, coordinate).a *
                    step(0.0, dot(normal, osgTerrainLight_sunDirection));
    float cosine = max(dot(mirror, osgTerrainLight_sunDirection), 1.0e-6);
    float lobe = (surface.w + 1.0) / (2.0 * PI) * pow(cosine, surface.w);
    // Order 4 rings below 0.
    sent = max(sent, 0.0) + osgTerrainLight_sunIrradiance * (visible * surface.z * lobe);
    return sent * (1.0 - osgTerrainLight_formerPart);
}
