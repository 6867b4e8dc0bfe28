#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/Matrixd>
#include <osg/Shader>

namespace osgTerrainLight
{

/// The contract with an application's shaders (docs/SHADERS.md). The StateSet of a lit tile has the
/// shading texture, RGBA16F, scene-linear: rgb is irradiance / pi, so that the colour is albedo *
/// rgb, and a is the visible fraction of the sun. terrain_shading.glsl declares the uniforms that
/// are named here, and reads the texture.
struct ShadingTexture
{
    /// The default texture unit: the last one that fixed-function OpenGL guarantees.
    static constexpr unsigned defaultUnit = 7;
    /// The set of texture coordinates that holds tile coordinates, where the geometry has them.
    static constexpr unsigned coordinateSet = 7;

    /// The sampler2D of the shading texture.
    static constexpr const char* sampler = "osgTerrainLight_shading";
    /// The mat4 that leads from ShadingCoordinates::Source, as a vec4, to texture coordinates (x,
    /// y), such that each post falls on the centre of its texel.
    static constexpr const char* matrix = "osgTerrainLight_matrix";
    /// The float 2^exposure of LightingSettings. TerrainLighting sets it for all below it.
    static constexpr const char* exposure = "osgTerrainLight_exposure";

    /// The default texture unit of the light sent by gloss, where the ground is glossy, and the
    /// sampler2DArray that reads it: RGBA16F, 13 layers. Layers 0 … 11 are spherical harmonics of
    /// order 4 of the direction that light leaves in. Layer 12 has the parts of the normal to the
    /// east and north, the gloss and the exponent. terrain_gloss.glsl reads it.
    static constexpr unsigned glossUnit = 5;
    static constexpr const char* glossSampler = "osgTerrainLight_gloss";
    /// The vec3 unit vector towards the sun, and the vec3 irradiance on a surface that faces the
    /// sun; 0 where there is no sun. TerrainLighting sets both for all below it.
    static constexpr const char* sunDirection = "osgTerrainLight_sunDirection";
    static constexpr const char* sunIrradiance = "osgTerrainLight_sunIrradiance";
    /// The texture unit of the edge of the sun's shadow, where LightingSettings has shadowEdges,
    /// and the sampler2D that reads it: RGBA16F, a texel per post: the height over the
    /// shadow [m], negative in it, the softness of its edge [m], irradiance / pi over the sun's
    /// irradiance where nothing shades, and 1, or 0.5 where the shadow is too high to say where it
    /// ends; all 0 where void. terrain_shading.glsl reads it.
    static constexpr unsigned edgeUnit = 8;
    static constexpr const char* edgeSampler = "osgTerrainLight_edges";
    /// The bool that says whether it is there, and the vec2 number of its texels.
    static constexpr const char* hasEdges = "osgTerrainLight_hasEdges";
    static constexpr const char* posts = "osgTerrainLight_posts";
    /// The light that a tile has until its own is there, and fades from (SHADERS.md, "Light that
    /// fades in"): the float part that it has, 1 … 0; the texture units and sampler2Ds of its
    /// shading and of its edges of shadows, which are as those above; the mat4 that leads from the
    /// texture coordinates of the tile's shading to those of it; and the vec2 number of texels of
    /// its edges, 0 where there are none. Only a tile that fades uses the units.
    /// terrain_shading.glsl reads them.
    static constexpr const char* formerPart = "osgTerrainLight_formerPart";
    static constexpr unsigned formerUnit = 9;
    static constexpr const char* formerSampler = "osgTerrainLight_former";
    static constexpr const char* formerMatrix = "osgTerrainLight_formerMatrix";
    static constexpr unsigned formerEdgeUnit = 10;
    static constexpr const char* formerEdgeSampler = "osgTerrainLight_formerEdges";
    static constexpr const char* formerPosts = "osgTerrainLight_formerPosts";
    /// Along borders with tiles of a coarser level there is more of the former light, which is that
    /// of a tile above then: the bool that says whether; the vec4s of its parts on the western,
    /// southern, eastern and northern side, and at the south-western, south-eastern, north-western
    /// and north-eastern corner; the vec4 of the texture coordinates of the outermost posts that
    /// are drawn, south-western and north-eastern; and the vec2 number of bands of 8 posts in the
    /// texture. terrain_shading.glsl reads them.
    static constexpr const char* hasBorders = "osgTerrainLight_hasBorders";
    static constexpr const char* borders = "osgTerrainLight_borders";
    static constexpr const char* borderCorners = "osgTerrainLight_borderCorners";
    static constexpr const char* drawn = "osgTerrainLight_drawn";
    static constexpr const char* bands = "osgTerrainLight_bands";
    /// The texture unit of what placed objects leave of the light (PlacedObject.h), and the
    /// sampler2D that reads it: RGBA16F, of rgb and of the visible fraction of the sun, in texels
    /// of its own around the objects, one cluster of them below the other. Then the number of
    /// clusters on the tile, 0 … 8; the vec4s that lead from the texture coordinates of the
    /// shading to those of it, scale and offset; and the vec4s of the corners that they are within.
    /// Only a tile with objects uses the unit. terrain_shading.glsl reads them.
    static constexpr unsigned objectsUnit = 11;
    static constexpr const char* objectsSampler = "osgTerrainLight_objects";
    static constexpr const char* objectCount = "osgTerrainLight_objectCount";
    static constexpr const char* objectPlaces = "osgTerrainLight_objectPlaces";
    static constexpr const char* objectCorners = "osgTerrainLight_objectCorners";
    /// The mat3 that leads from the axes of the vertices to those of the tile: x east, y north, z
    /// up.
    static constexpr const char* frame = "osgTerrainLight_frame";
};

/// How a vertex of the application's terrain finds its place on the tile.
struct ShadingCoordinates
{
    enum class Source
    {
        Vertex,  ///< By gl_Vertex, the position as the geometry has it.
        TexCoord ///< By the texture coordinates of set ShadingTexture::coordinateSet.
    };
    Source source = Source::TexCoord;
    /// Leads from the source to tile coordinates: (0, 0) at the tile's south-western post, (1, 1)
    /// at its north-eastern post.
    osg::Matrixd toTile;
    /// The rotation from the axes of gl_Vertex to east, north and up of the tile. Gloss needs it.
    osg::Matrixd frame;
};

/// Makes terrain_shading.glsl a shader that an application adds to its own program. It has
/// vec2 terrainShadingCoordinate(vec4 source) and vec4 terrainShading(vec2 coordinate).
/// version: of GLSL, as in #version, ≥ 120.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createShadingShader(osg::Shader::Type type,
                                                                     int version = 120);

/// Makes terrain_gloss.glsl, and the library that it calls, a shader that an application adds to
/// its own program. It has vec3 terrainGloss(vec2 coordinate, vec3 toViewer). version: of GLSL, as
/// in #version, ≥ 330.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createGlossShader(osg::Shader::Type type,
                                                                   int version = 330);

} // namespace osgTerrainLight
