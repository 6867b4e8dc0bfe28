#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "gpu/WorkGraph.h"

#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{

struct TileWindows;

/// Heights of one tile and of what surrounds it on the GPU, and the distances between its posts.
///
/// Texels of a tile with windows: post (0, 0) is at (frame, frame), as in a tile without, and the
/// ring lies in the frame. Coarser levels stand in a texture of their own, each once per CrestAxis,
/// with void texels around it.
class TileSurface : public GpuWork
{
public:
    /// frame: void posts on every side. bodyRadius [m]: as in LightingSettings. changing: a node
    /// writes the heights (FrameHeightsNode); else they are the tile's, for good.
    TileSurface(const DemTile& tile, int frame, double bodyRadius = 0.0, bool changing = false);
    TileSurface(std::shared_ptr<const TileWindows> windows, int frame, double bodyRadius);
    /// A frame that has room for the ring, and is at least as wide as asked.
    static int frameOf(const TileWindows& windows, int atLeast);

    const DemTile& tile() const { return _tile; }
    int width() const { return _tile.width(); }
    int height() const { return _tile.height(); }
    int frame() const { return _frame; }
    double bodyRadius() const { return _bodyRadius; }
    bool isChanging() const { return _isChanging; }

    /// R32F [m above the tile's heightOrigin], framed, row 0 south (createHeightTexture).
    Resource* heights() const { return _heights; }
    /// R32F [m], one texel per row (createSpacingTexture).
    Resource* eastSpacings() const { return _eastSpacings; }

    /// Null where nothing surrounds the tile.
    const TileWindows* windows() const { return _windows.get(); }
    /// Coarser levels around the tile.
    int farLevels() const { return static_cast<int>(_places.size()); }
    /// Posts from one end of the outermost window to the other, along the longer side.
    int reach() const;
    /// For passes whose lines come from beyond the tile: none where nothing surrounds it.
    std::vector<std::string> farDefines() const;
    /// Sets windowPosts, windowTexels, farLevels and farHeights of shaders/windows.glsl.
    void bindFar(GpuPass& pass) const;
    /// RGBA16F: what the ground of the coarser levels sends, by level, of FarLevel::posts each;
    /// laid out as the heights for the axis east.
    osg::ref_ptr<Resource> createFarLight(std::vector<Raster<Rgb>> levels) const;

    /// Sets heights, eastSpacings, northSpacing, size and frame, as all passes name them.
    void bind(GpuPass& pass) const;
    /// Groups of 8 x 8 that cover the posts, or one of every stride x stride.
    GpuPass::Groups groups(int stride = 1) const;
    /// Of a texture of a texel per post.
    TextureLayout perPost(GLint format, int layers = 0) const;

private:
    ~TileSurface() override = default;

    /// Where a level stands in the texture.
    struct Place
    {
        int x = 0, y = 0, northX = 0, northY = 0; ///< of its first post, by CrestAxis
    };
    void layOut();
    double sinkAt(double column, double row, double eastSpacing) const;
    osg::ref_ptr<osg::Texture> createHeights() const;
    osg::ref_ptr<osg::Texture> createFar() const;

    const std::shared_ptr<const TileWindows> _windows;
    const DemTile _tile;
    const int _frame;
    const double _bodyRadius;
    const bool _isChanging;
    std::vector<Place> _places; ///< by level, of windows
    int _farWidth = 1, _farHeight = 1;
    Resource *_heights, *_eastSpacings;
    Resource* _far = nullptr; ///< R32F [m above the tile's heightOrigin]
};

} // namespace osgTerrainLight
