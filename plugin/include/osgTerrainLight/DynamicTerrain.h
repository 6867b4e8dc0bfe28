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

/// Terrain whose heights may change in every frame: waves, erosion, craters. It is a grid with a
/// vertex per post of a DemTile, which the vertex shader moves to its height. It is lit, and lit
/// anew when heights have changed, once it stands below a TerrainLighting and was given to its
/// addTile().
///
/// Its frame has x east and y north [m] from the middle of the tile, and z up [m above the tile's
/// heightOrigin]. A triangle is not drawn while one of its corners is void. Drawing needs
/// OpenGL 3.3 with the compatibility profile. Without light the terrain shows its colours under a
/// lamp at the eye. Its colours are the picture in texture unit 0 of its StateSet, with the
/// south-western post at (0, 0) and the north-eastern post at (1, 1); it is white where there is no
/// picture. Intersections, and all that reads vertices on the CPU, find the heights that the
/// terrain was made with.
///
/// A program that is put on its StateSet draws it instead: see createHeightShader().
///
/// Call all methods where the scene graph may be changed: in the update or event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT DynamicTerrain : public osg::Group
{
public:
    /// Changes the heights. It is called once per frame, in the update traversal, and must not
    /// throw. time: the frame's simulation time [s]. heights: width × height values [m above
    /// heightOrigin], row 0 in the south, NaN where void, as the last call left them; change them
    /// in place. A height that is not finite or beyond ±1e6 m is void. Return whether any height
    /// has changed: where none has, nothing is uploaded or lit.
    using HeightCallback = std::function<bool(double time, int width, int height, float* heights)>;

    /// The default texture unit of the heights.
    static constexpr unsigned heightUnit = 6;
    /// The name of the sampler2D that reads the heights.
    static constexpr const char* heightSampler = "osgTerrainLight_heights";

    DynamicTerrain();
    /// Spacings and first heights are those of the tile. A tile of fewer than 2 × 2 posts draws
    /// nothing, and neither does one where DemTile::complaint() finds something wrong.
    explicit DynamicTerrain(const DemTile& tile);
    /// A copy has the same tile, heights, callback, range and texture unit, the same texture of the
    /// application, and a mesh and a height texture of its own. It has not been added to a
    /// lighting.
    DynamicTerrain(const DynamicTerrain& other,
                   const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, DynamicTerrain);

    /// The tile that it was made with, which never changes.
    const DemTile& getTile() const;

    /// Sets what changes the heights. Without a callback they stay as they are.
    void setHeightCallback(HeightCallback callback);

    /// Takes the heights from a texture of the application instead of the callback; null gives them
    /// back to the callback. The texture is R32F and has a texel per post, row 0 in the south [m
    /// above heightOrigin]. Its heights never come to the CPU. Write it in each context, before a
    /// camera of render order PRE_RENDER −1000 draws, and call dirtyHeights() in the update of that
    /// frame. Returns false, with a warning, where the size or format is another, or the minifying
    /// filter uses mipmaps.
    bool setHeightTexture(osg::Texture2D* texture);

    /// Says that the content of the height texture has changed, or will have when the next frame is
    /// drawn.
    void dirtyHeights();

    /// Sets the heights between which the terrain is drawn [m above heightOrigin], lowest <=
    /// highest, for culling and for the near and far plane. The default is the range of all heights
    /// that the tile and the callback have given, so call it where the heights come from a texture.
    void setHeightRange(float lowest, float highest);

    /// Sets the texture unit of the heights, for the vertex shader, 0 … 31; the default is
    /// heightUnit. A unit that has another texture is refused with a warning. TerrainLighting
    /// refuses terrain whose heights are in the unit of its shading or of its gloss.
    void setHeightUnit(unsigned unit);
    unsigned getHeightUnit() const;

    /// The texture that the mesh and its lighting read: that of the application, else the terrain's
    /// own.
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

/// Makes terrain_heights.glsl a shader that an application adds to its own program. It has
/// vec2 terrainHeight(vec2 tileCoordinate): the height [m above heightOrigin], and whether it is
/// void. version: of GLSL, as in #version, >= 330.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createHeightShader(osg::Shader::Type type,
                                                                    int version = 330);

} // namespace osgTerrainLight
