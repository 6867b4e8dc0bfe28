#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>

#include <osg/BoundingBox>
#include <osg/Group>
#include <osg/Shader>
#include <osg/Texture2D>

#include <functional>
#include <memory>

namespace osgTerrainLight
{

/// Terrain whose heights may change in every frame: waves, erosion, craters. A grid with a vertex
/// per post of a DemTile, moved to its heights in the vertex shader; lit, and lit anew when heights
/// have changed, once it stands below a TerrainLighting and was given to its addTile().
///
/// Frame: x east, y north [m] from the middle of the tile, z up [m above the tile's heightOrigin].
/// A triangle with a void corner is not drawn, now void or from the start; a post that gets a
/// height has triangles again. Needs OpenGL 3.3 with the compatibility profile to be drawn; without
/// light it has its colours under a lamp at the eye. A picture in texture unit 0 of its StateSet is
/// its colours, south-western post at (0, 0) and north-eastern at (1, 1); white where there is
/// none. Intersections and what else reads vertices on the CPU find the heights that it was made
/// with.
///
/// Where a program is put on its StateSet, that one draws it: see createHeightShader().
///
/// Methods are called where the scene graph may be changed: in update and event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT DynamicTerrain : public osg::Group
{
public:
    /// Called in every update traversal, once per frame; must not throw. time: the frame's
    /// simulation time [s]. heights: width × height values [m above heightOrigin], row 0 south, NaN
    /// where void; as the last call left them, to be changed in place. What is not finite or beyond
    /// ±1e6 m is void. Returns whether any has changed: where it is false, nothing is uploaded or
    /// lit.
    using HeightCallback = std::function<bool(double time, int width, int height, float* heights)>;

    /// Texture unit of the heights where none is asked for.
    static constexpr unsigned heightUnit = 6;
    /// sampler2D: the texture in it.
    static constexpr const char* heightSampler = "osgTerrainLight_heights";

    DynamicTerrain();
    /// Spacings and first heights are the tile's. Tiles of fewer than 2 × 2 posts draw nothing.
    explicit DynamicTerrain(const DemTile& tile);
    /// A copy has the same tile, heights, callback, range and units, a mesh and a height texture of
    /// its own, but the same texture of the host; it has not been added to a lighting.
    DynamicTerrain(const DynamicTerrain& other,
                   const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, DynamicTerrain);

    /// As it was made; never changes.
    const DemTile& getTile() const;

    /// Empty: heights stay as they are.
    void setHeightCallback(HeightCallback callback);

    /// Heights from a texture of the host, R32F, a texel per post, row 0 south [m above
    /// heightOrigin], instead of the callback; null: the callback's again. They never come to the
    /// CPU. Whoever writes it does so in each context, before a camera of render order PRE_RENDER
    /// −1000 draws, and calls dirtyHeights() in the update of the frame. False, with a warning,
    /// where size or format is another or the minifying filter uses mipmaps.
    bool setHeightTexture(osg::Texture2D* texture);

    /// The height texture's content has changed, or will have when the next frame is drawn.
    void dirtyHeights();

    /// Heights between which it is drawn [m above heightOrigin], lowest <= highest, for culling and
    /// near and far plane. Without it: the range of all heights that it has had from tile and
    /// callback; so a host with a texture gives it.
    void setHeightRange(float lowest, float highest);

    /// Texture unit of the heights, for the vertex shader, 0 … 31. Default heightUnit.
    /// TerrainLighting refuses terrain whose heights are in the unit of its shading.
    void setHeightUnit(unsigned unit);
    unsigned getHeightUnit() const;

    /// What the mesh and its lighting read: the host's texture, else one of ours.
    osg::Texture2D* getHeightTexture() const;
    /// Counts changes of heights.
    unsigned getHeightRevision() const;

    osg::BoundingBox getBoundingBox() const;

    void traverse(osg::NodeVisitor& visitor) override;
    void releaseGLObjects(osg::State* state = nullptr) const override;
    void resizeGLObjectBuffers(unsigned size) override;

protected:
    ~DynamicTerrain() override;

private:
    void create();
    void include(float lowest, float highest);
    void follow(osg::NodeVisitor& visitor);

    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

/// terrain_heights.glsl as a shader that a host adds to its program and calls:
/// vec2 terrainHeight(vec2 tileCoordinate), the height [m above heightOrigin] and whether it is
/// void. version: of GLSL, as in #version, >= 330.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createHeightShader(osg::Shader::Type type,
                                                                    int version = 330);

} // namespace osgTerrainLight
