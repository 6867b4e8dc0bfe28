#pragma once

#include "core/TileSource.h"
#include "io/DemReader.h"

#include <array>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

namespace osgTerrainLight
{

class RasterHeights;

/// Terrain of a GDAL raster of any size as a quadtree, opened without reading it: what a viewer
/// needs, where RasterSource reads all of the raster once and is exact.
///
/// Tiles of a level are 2^cellsLog2 cells (one more post) a side; the coarsest level, root(), is
/// one tile. The raster lies in the north-west of that, so that posts of every level are those that
/// overviews by the nearest pixel hold, and are read from them (within a post of their level,
/// where the raster.s size is no multiple of it). Posts of overviews made otherwise are taken as
/// they are: an average stands half a post of its level to the south-east. Coarse
/// levels around tiles (readLevel) are crests of posts two levels finer, at most: what lies between
/// those is not seen. Blocks of them are kept. For one thread at a time.
class OverviewSource : public TileSource
{
public:
    /// options: window, progress and maxPosts do not count.
    static Result<std::unique_ptr<OverviewSource>>
    open(const std::string& path, const DemReadOptions& options, int cellsLog2 = 8);
    /// Of a raster that is open, and of which nothing was read; all of it is lit.
    static Result<std::unique_ptr<OverviewSource>> open(std::unique_ptr<RasterHeights> heights,
                                                        int cellsLog2 = 8);
    ~OverviewSource() override;

    int root() const { return _root; }
    /// Of tile (x, y) from the south-west.
    PostRect placeOf(int x, int y) const;
    int cells() const { return 1 << _cellsLog2; }

    int width() const override { return (cells() << _root) + 1; }
    int height() const override { return width(); }
    PostRect terrain() const override { return _extents[0]; }
    int lastLevel() const override { return _root + 2; }
    PostRect extent(int level) const override { return _extents[static_cast<std::size_t>(level)]; }
    double heightOrigin() const override;
    double northSpacing() const override;
    double eastSpacing(int row) const override;
    Result<Raster<float>> readPosts(const PostRect& posts) override;
    Result<Raster<float>> readLevel(int level, CrestAxis axis, const PostRect& posts) override;
    Result<Raster<float>> readSurface(int level, const PostRect& posts) override;

    /// Of the whole raster.
    const RasterFrame& frame() const;
    /// All of the raster in the quadtree, poles and beyond too; terrain() may be less.
    PostRect raster() const { return {_west, _south, frame().width, frame().height}; }
    const DemInfo& info() const;
    /// Heights by place, x east and y north of the raster's middle [m], above the datum [m], as the
    /// nearest post of the coarsest tile tells; NaN where it is void. They do not need the source.
    Result<std::function<double(double, double)>> coarseHeights();
    /// The same of one place, bilinear between the posts of level 0; reads four of them.
    Result<double> heightAt(double x, double y);
    /// A level tile of 2 × 2 posts at the corners of a rectangle: where it lies on the map.
    DemTile cornersOf(int level, const PostRect& posts) const;
    /// Between columns in the middle of the raster [m].
    double middleEastSpacing() const;
    double lowest() const { return _lowest; } ///< of heights that were looked at [m]
    double highest() const { return _highest; }
    const std::vector<std::string>& notes() const { return _notes; }

private:
    OverviewSource();
    /// Of a level by CrestAxis, `side` posts a side from (x · side, y · side).
    using Block = std::array<Raster<float>, 2>;
    static constexpr int side = 64;
    static constexpr std::size_t mostBlocks = 1024; ///< 32 MiB
    using Key = std::tuple<int, int, int>;
    Result<std::shared_ptr<const Block>> block(int level, int x, int y);
    Result<std::shared_ptr<const Block>> makeBlock(int level, int x, int y);

    std::unique_ptr<RasterHeights> _heights;
    int _cellsLog2 = 8, _root = 0;
    int _west = 0, _south = 0; ///< the raster's first post in the quadtree
    std::vector<PostRect> _extents;
    double _lowest = 0.0, _highest = 0.0;
    std::vector<std::string> _notes;
    std::list<Key> _used; ///< most recent first
    std::map<Key, std::pair<std::shared_ptr<const Block>, std::list<Key>::iterator>> _blocks;
};

} // namespace osgTerrainLight
