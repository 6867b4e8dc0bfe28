// What a host shader calls to light its terrain: colour = albedo * terrainShading(...).rgb.
// Works in vertex and fragment shaders from GLSL 1.20 on; the host puts #version first.

// RGBA16F: rgb = irradiance / pi, a = visible sun, 0 ... 1
uniform sampler2D osgTerrainLight_shading;
uniform mat4 osgTerrainLight_matrix;       // source to texture coordinates, posts at texel centres

// source: vec4 of what the tile was bound with, the vertex position or the tile coordinates, which
// run from (0, 0) at the south-western post to (1, 1) at the north-eastern one. Affine: may be
// computed per vertex.
vec2 terrainShadingCoordinate(vec4 source)
{
    return (osgTerrainLight_matrix * source).xy;
}

// Scene-linear. Bilinear between posts.
vec4 terrainShading(vec2 coordinate)
{
#if __VERSION__ >= 130
    return texture(osgTerrainLight_shading, coordinate);
#else
    return texture2D(osgTerrainLight_shading, coordinate);
#endif
}
