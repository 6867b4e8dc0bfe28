#pragma once

#include <osgTerrainLight/DemTile.h>

#include "gpu/WorkGraph.h"

namespace osgTerrainLight
{

/// Heights of one tile on the GPU, and the distances between its posts.
class TileSurface : public GpuWork
{
public:
    /// frame: void posts on every side. bodyRadius [m]: as in LightingSettings. changing: a node
    /// writes the heights (FrameHeightsNode); else they are the tile's, for good.
    TileSurface(const DemTile& tile, int frame, double bodyRadius = 0.0, bool changing = false);

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

    /// Sets heights, eastSpacings, northSpacing, size and frame, as all passes name them.
    void bind(GpuPass& pass) const;
    /// Groups of 8 x 8 that cover the posts, or one of every stride x stride.
    GpuPass::Groups groups(int stride = 1) const;
    /// Of a texture of a texel per post.
    TextureLayout perPost(GLint format, int layers = 0) const;

private:
    ~TileSurface() override = default;

    const DemTile _tile;
    const int _frame;
    const double _bodyRadius;
    const bool _isChanging;
    Resource *_heights, *_eastSpacings;
};

} // namespace osgTerrainLight
