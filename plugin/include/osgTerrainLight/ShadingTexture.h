#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/Matrixd>
#include <osg/Shader>

namespace osgTerrainLight
{

/// The contract with host shaders (docs/SHADERS.md). A lit tile's StateSet carries the shading
/// texture, RGBA16F, scene-linear: rgb = irradiance / pi, so that colour = albedo * rgb; a =
/// visible fraction of the sun. terrain_shading.glsl declares the uniforms named here and reads it.
struct ShadingTexture
{
    /// Texture unit where none is asked for: the last one that fixed-function OpenGL guarantees.
    static constexpr unsigned defaultUnit = 7;
    /// Set of texture coordinates that holds tile coordinates where geometry has them.
    static constexpr unsigned coordinateSet = 7;

    /// sampler2D: the shading texture.
    static constexpr const char* sampler = "osgTerrainLight_shading";
    /// mat4: from ShadingCoordinates::Source, as vec4, to texture coordinates (x, y) such that each
    /// post falls on its texel's centre.
    static constexpr const char* matrix = "osgTerrainLight_matrix";
    /// float: 2^exposure, of LightingSettings; on TerrainLighting and so on all below it.
    static constexpr const char* exposure = "osgTerrainLight_exposure";

    /// Where the ground is glossy: texture unit of light sent by gloss, RGBA16F, 13 layers, and its
    /// sampler2DArray. terrain_gloss.glsl reads it; 0 … 11 are spherical harmonics of order 4 of
    /// the direction that light leaves in, 12 the normal's parts to east and north, gloss and
    /// exponent.
    static constexpr unsigned glossUnit = 5;
    static constexpr const char* glossSampler = "osgTerrainLight_gloss";
    /// vec3, on TerrainLighting: unit vector towards the sun, and what a surface that faces it
    /// receives; 0 where there is no sun.
    static constexpr const char* sunDirection = "osgTerrainLight_sunDirection";
    static constexpr const char* sunIrradiance = "osgTerrainLight_sunIrradiance";
    /// mat3: from the axes of vertices to the tile's, x east, y north, z up.
    static constexpr const char* frame = "osgTerrainLight_frame";
};

/// How a vertex of the host's terrain finds its place on the tile.
struct ShadingCoordinates
{
    enum class Source
    {
        Vertex,  ///< gl_Vertex, the position as the geometry holds it
        TexCoord ///< texture coordinates of set ShadingTexture::coordinateSet
    };
    Source source = Source::TexCoord;
    /// From source to tile coordinates: (0, 0) at the tile's south-western post, (1, 1) at its
    /// north-eastern one.
    osg::Matrixd toTile;
    /// A rotation, from the axes of gl_Vertex to east, north and up of the tile: for gloss.
    osg::Matrixd frame;
};

/// terrain_shading.glsl as a shader that a host adds to its program and calls:
/// vec2 terrainShadingCoordinate(vec4 source) and vec4 terrainShading(vec2 coordinate).
/// version: of GLSL, as in #version, ≥ 120.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createShadingShader(osg::Shader::Type type,
                                                                     int version = 120);

/// terrain_gloss.glsl, after the shader library that it calls: vec3 terrainGloss(vec2 coordinate,
/// vec3 toViewer). version: ≥ 330.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createGlossShader(osg::Shader::Type type,
                                                                   int version = 330);

} // namespace osgTerrainLight
