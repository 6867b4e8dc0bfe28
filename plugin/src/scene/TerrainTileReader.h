#pragma once

#include "core/Raster.h"
#include "core/Result.h"
#include "scene/TileNeighbours.h"
#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/ShadingTexture.h>
#include <osgTerrainLight/SkyLight.h>

#include <osg/Geometry>
#include <osg/Image>
#include <osg/Referenced>
#include <osg/Vec2d>
#include <osgTerrain/TerrainTile>

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

struct TileWindows;

/// The DEM that a tile's height field was made from, as the tile's user data: it knows what a
/// height field does not, such as each row's east spacing, and what surrounds the tile.
class DemData : public osg::Referenced
{
public:
    explicit DemData(const DemTile& dem) : _tile(dem) {}
    /// middle: of the posts that are of the terrain, on the tile, 0 … 1.
    explicit DemData(std::shared_ptr<const TileWindows> around,
                     const osg::Vec2d& middle = osg::Vec2d(0.5, 0.5))
        : _windows(std::move(around)), _middle(middle)
    {
    }

    const DemTile& tile() const;
    /// Null where nothing surrounds the tile.
    const std::shared_ptr<const TileWindows>& windows() const { return _windows; }
    const osg::Vec2d& middle() const { return _middle; }

private:
    ~DemData() override = default;

    const DemTile _tile;
    const std::shared_ptr<const TileWindows> _windows;
    const osg::Vec2d _middle{0.5, 0.5};
};

/// A drawn part of a tile, and where it stands in the tile.
struct TilePart
{
    osg::ref_ptr<osg::Geometry> geometry;
    osg::Matrixd toTile; ///< from the geometry's frame to the tile's
};

/// Heights of a tile, and what surrounds it.
struct TerrainHeights
{
    DemTile dem;
    std::shared_ptr<const TileWindows> windows; ///< null where nothing does
    /// The rotation from the axes of TerrainLighting to the tile's own: of paged terrain of ours
    /// that lies on a globe, whose light comes from one sun.
    std::optional<osg::Matrixd> turn = {};
};

/// Heights of a tile in metres, through its elevation layer and locator. toScene: from the tile's
/// frame to that of TerrainLighting. An error where rows do not run east, or heights not up.
Result<TerrainHeights> readTerrainTile(osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene);

/// Where the tile's heights lie on its map: in the frame of TerrainLighting [m], or in radians
/// where its locator has these. None where the tile comes with what surrounds it. dem: its heights
/// as readTerrainTile() has read them.
std::optional<PlacedGround> placeTerrainTile(const osgTerrain::TerrainTile& tile,
                                             const osg::Matrixd& toScene, const DemTile& dem);

/// Of post (0, 0) where its height with heightOrigin is 0, in the frame of TerrainLighting [m];
/// none where the locator has longitude and latitude.
std::optional<osg::Vec3d> cornerOf(const osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene,
                                   const DemTile& dem);

/// Between columns and rows as they are drawn there [m]. Precondition: cornerOf() is known.
osg::Vec2d drawnSpacing(const osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene,
                        const DemTile& dem);

/// The tile's first colour layer as an albedo per post: a picture over the tile's whole extent, its
/// bytes sRGB. Empty where it has none, one that is no picture, or one compressed for the GPU.
Raster<Rgb> readTerrainAlbedo(const osgTerrain::TerrainTile& tile, int width, int height);

/// Gloss and exponent per post from a colour layer (TerrainLighting::setGlossLayer()): a picture
/// over the tile's whole extent, its values linear. Empty where the tile has no such layer, one
/// that is no picture, or one compressed for the GPU.
Raster<std::array<float, 2>> readTerrainGloss(const osgTerrain::TerrainTile& tile, int layer,
                                              int width, int height);

/// The picture of a colour layer; null where there is none.
const osg::Image* pictureOf(const osgTerrain::TerrainTile& tile, int layer);

/// True where the first colour layer is a picture.
bool hasColour(const osgTerrain::TerrainTile& tile);

/// How the vertices of the parts find their place on the tile: by position where the locator is
/// affine, else nothing is returned.
std::optional<ShadingCoordinates> affineCoordinates(const osgTerrain::TerrainTile& tile,
                                                    const std::vector<TilePart>& parts);

/// The rotation from the axes of the parts' vertices to the tile's: east, north, up.
osg::Matrixd tileFrame(const osgTerrain::TerrainTile& tile, const std::vector<TilePart>& parts);

/// Gives the parts' vertices tile coordinates, in set ShadingTexture::coordinateSet, where they
/// have none yet. Only for geometry that has not been drawn.
void addTileCoordinates(const osgTerrain::TerrainTile& tile, const std::vector<TilePart>& parts);

} // namespace osgTerrainLight
