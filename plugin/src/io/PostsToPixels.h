#pragma once

#include "core/Result.h"
#include "io/RasterFrame.h"

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

class OGRSpatialReference;

namespace osgTerrainLight
{

/// Takes posts of one raster, in the order of a tile, to pixels of another one with any CRS, and
/// back.
class PostsToPixels
{
public:
    /// NaN where there is none. (0, 0): the middle of the first pixel.
    struct Places
    {
        std::vector<double> x, y;
    };

    /// Nothing where PROJ has no way from one to the other. crs: null where a raster has none; both
    /// have one, or none has: map coordinates are then the same. Of the other raster's frame the
    /// file's order counts.
    static std::optional<PostsToPixels> between(const RasterFrame& posts,
                                                const OGRSpatialReference* crsOfPosts,
                                                const RasterFrame& raster,
                                                const OGRSpatialReference* crsOfRaster);

    /// Of posts in one row, `step` apart from the first column on. Out by at most a hundredth of a
    /// pixel, for the sake of speed.
    Places row(double firstColumn, double step, int count, double row) const;
    /// Posts of pixels; a longitude nearest to the middle of the raster of posts.
    Places posts(const Places& pixels) const;
    /// Whether the other raster goes around the whole body.
    bool isWholeTurn() const { return _turn > 0.0 && _width > _turn - 1.0; }
    /// Posts halfway around the body; 0 where their map is not of degrees.
    double halfTurnOfPosts() const { return 0.5 * _turnOfPosts; }

private:
    struct Release
    {
        void operator()(void* transformer) const;
    };
    using Transformer = std::unique_ptr<void, Release>;

    PostsToPixels() = default;

    RasterFrame _frame; ///< of the posts
    std::array<double, 6> _transform{};
    int _width = 0;
    double _turn = 0.0;        ///< pixels around the body; 0: not of degrees
    double _turnOfPosts = 0.0; ///< posts around it
    Transformer _exact, _quick;
};

} // namespace osgTerrainLight
