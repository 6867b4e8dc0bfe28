#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/TileSource.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace osgTerrainLight
{

/// Heights of a rectangle of ground that a host has loaded, at any spacing.
struct TerrainPatch
{
    std::shared_ptr<const DemTile> dem;
    /// Of post (0, 0) on the map, and the steps between posts, > 0 [m, or radians].
    double west = 0.0, south = 0.0, eastStep = 1.0, northStep = 1.0;
    double lift = 0.0; ///< what is added to all heights [m]

    double east() const { return west + eastStep * (dem->width() - 1); }
    double north() const { return south + northStep * (dem->height() - 1); }
    /// Whether its posts are much closer together than those of the other.
    bool isFinerThan(const TerrainPatch& other) const { return eastStep < 0.75 * other.eastStep; }
};

/// Ground that counts where no patch is: it is read when it is needed, from a rectangle of the map.
struct BaseGround
{
    double west = 0.0, south = 0.0, east = 0.0, north = 0.0; ///< [m, or radians]
    /// Heights [m above the map's 0], row 0 in the south, NaN where void, of columns × rows posts
    /// from (west, south) on, in these steps. All of them lie in the rectangle. Empty where they
    /// cannot be read: then they are void.
    std::function<std::vector<float>(double west, double south, double eastStep, double northStep,
                                     int columns, int rows)>
        heights;
};

/// What surrounds a tile, from what is loaded around it: patches at several spacings, which may
/// overlap, as parents and children of a quadtree do.
///
/// Level 0 has the tile's own posts and goes on in their steps. Where several patches are, the one
/// with the tile's spacing counts, else the finest of those that are coarser, else the coarsest of
/// those that are finer, else the base: what is drawn at the tile's level does not change where
/// finer patches come. Heights between posts are bilinear. Coarse levels are crests of posts two
/// levels finer, as those of OverviewSource. Tiles at one level whose posts lie on one grid have
/// the same coarse posts. A pass over the posts of a window costs nanoseconds for each.
class PatchSource : public TileSource
{
public:
    /// patches: all of one map, in any order, the tile among them or not. eastMetres: metres per
    /// unit of the map eastwards at a northing; null: the tile's own in all rows.
    PatchSource(const TerrainPatch& tile, std::vector<TerrainPatch> patches,
                std::function<double(double)> eastMetres = {},
                std::optional<BaseGround> base = std::nullopt);

    /// Of the tile.
    const PostRect& place() const { return _place; }

    int width() const override { return whole; }
    int height() const override { return whole; }
    PostRect terrain() const override { return _place; }
    int lastLevel() const override { return last; }
    PostRect extent(int level) const override;
    double heightOrigin() const override { return _tile.dem->heightOrigin; }
    double northSpacing() const override { return _tile.dem->northSpacing; }
    double eastSpacing(int row) const override;
    Result<Raster<float>> readPosts(const PostRect& posts) override
    {
        return readSurface(0, posts);
    }
    Result<Raster<float>> readLevel(int level, CrestAxis axis, const PostRect& posts) override;
    Result<Raster<float>> readSurface(int level, const PostRect& posts) override;

private:
    static constexpr int last = 16;
    /// Posts are counted from a place that all tiles of a level have in common, within a terrain
    /// that is larger than any.
    static constexpr int half = 1 << 20, whole = 1 << 22;

    double eastOf(int column) const
    {
        return _tile.west + (column - _place.column) * _tile.eastStep;
    }
    void readBase(int step, const PostRect& posts, Raster<float>& heights) const;
    double northOf(int row) const { return _tile.south + (row - _place.row) * _tile.northStep; }

    TerrainPatch _tile;
    std::vector<TerrainPatch> _patches; ///< those that count most last, the tile the very last
    std::function<double(double)> _eastMetres;
    std::optional<BaseGround> _base;
    PostRect _place, _extent; ///< of level 0
    /// What crests were made of last: those along the other axis are of the same posts.
    int _readLevel = -1;
    PostRect _readPosts;
    Raster<float> _read;
};

} // namespace osgTerrainLight
