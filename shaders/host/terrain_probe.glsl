// What a host shader calls to light an object that has a LightProbe: colour = albedo *
// terrainProbeDiffuse(...) + gloss * terrainProbeGlossy(...). Works from GLSL 1.20 on; the host
// puts #version first. Directions are unit vectors in the tile's frame: x east, y north, z up.

// rgb = irradiance / pi by normal, a = visible sun, 0 ... 1
uniform samplerCube osgTerrainLight_probeDiffuse;
// rgb = radiance through a lobe about each direction
uniform samplerCube osgTerrainLight_probeGlossy;
uniform float osgTerrainLight_probeExponent;      // of that lobe
uniform vec3 osgTerrainLight_sunDirection;
uniform vec3 osgTerrainLight_sunIrradiance; // on a surface that faces it; 0 where there is none

vec4 terrainProbe(samplerCube map, vec3 direction)
{
#if __VERSION__ >= 130
    return texture(map, direction);
#else
    return textureCube(map, direction);
#endif
}

// Irradiance / pi on a surface of the given normal: sky and ground through harmonics, the sun
// sharply.
vec3 terrainProbeDiffuse(vec3 normal)
{
    vec4 light = terrainProbe(osgTerrainLight_probeDiffuse, normal);
    float facing = max(dot(normal, osgTerrainLight_sunDirection), 0.0) / 3.14159265;
    return light.rgb + osgTerrainLight_sunIrradiance * (light.a * facing);
}

// Radiance that a lobe of the probe's exponent about the mirror direction gathers.
vec3 terrainProbeGlossy(vec3 normal, vec3 toViewer)
{
    vec3 mirror = 2.0 * dot(normal, toViewer) * normal - toViewer;
    vec4 light = terrainProbe(osgTerrainLight_probeGlossy, mirror);
    float facing = step(0.0, dot(normal, osgTerrainLight_sunDirection));
    float cosine = max(dot(mirror, osgTerrainLight_sunDirection), 1.0e-6);
    float s = osgTerrainLight_probeExponent;
    float lobe = (s + 1.0) / 6.28318531 * pow(cosine, s);
    return light.rgb + osgTerrainLight_sunIrradiance * (light.a * facing * lobe);
}
