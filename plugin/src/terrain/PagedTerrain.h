#pragma once

#include "core/Result.h"
#include "io/MapReader.h"
#include "io/OverviewSource.h"
#include "terrain/Globe.h"
#include <osgTerrainLight/LightingSettings.h>

#include <osg/BoundingBox>
#include <osg/MatrixTransform>
#include <osg/Node>
#include <osgDB/Callbacks>
#include <osgDB/Options>

#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace osgTerrainLight
{

struct TileWindows;

/// A picture that is draped over terrain.
struct DrapedColour
{
    std::string path;
    double opacity = 1.0; ///< 0 … 1
};

/// Terrain of a raster of any size: a quadtree of osgTerrain tiles below osg::PagedLOD, read in the
/// threads of the viewer's osgDB::DatabasePager. Each tile comes with the terrain around it
/// (TileWindows), so that its light depends on the raster alone, and not on what else is loaded.
///
/// The frame is that of createTerrain(): metres from the middle of the raster. On a globe the tiles
/// are bent, each is lit in a frame of its own, and the frame is that of Globe. A tile has 256
/// cells a side; its four children are drawn in its place where one of its cells would have more
/// than two pixels.
class PagedTerrain : public osgDB::ReadFileCallback
{
public:
    /// quality: of the light, which says how far tiles see at full resolution.
    PagedTerrain(std::unique_ptr<OverviewSource> source, std::vector<DrapedColour> colours,
                 HorizonQuality quality, std::optional<Globe> globe = {});

    /// The coarsest tile. An error where it cannot be read.
    Result<osg::ref_ptr<osg::Node>> root();

    /// Of the raster, in the frame of the nodes [m]; heights as far as they were looked at.
    osg::BoundingBoxd extent() const;
    const OverviewSource& source() const { return *_source; }

    /// The four tiles below one; name: as tiles have it for their PagedLOD.
    osgDB::ReaderWriter::ReadResult readNode(const std::string& name,
                                             const osgDB::Options* options) override;

    /// A tile of the source, whose level 0 is the finest.
    struct Place
    {
        int level, x, y;
    };

private:
    ~PagedTerrain() override = default;
    Result<osg::ref_ptr<osg::Node>> tile(const Place& place);
    osg::ref_ptr<osg::MatrixTransform> drawn(const Place& place,
                                             const std::shared_ptr<const TileWindows>& windows,
                                             const PostRect& there);
    /// What says when a tile's children are drawn in its place.
    struct Sphere
    {
        osg::Vec3d centre; ///< in the frame of the nodes
        double radius;     ///< [m]
        double cells;      ///< that its diameter is long
    };
    Sphere flatSphere(const Place& place, const DemTile& dem, const PostRect& posts,
                      const PostRect& there) const;
    osg::Vec3d middleOf(const Place& place) const;
    std::vector<ColourImage> coloursOf(const Place& place);

    std::mutex _reading; ///< of the source
    const std::unique_ptr<OverviewSource> _source;
    const std::vector<DrapedColour> _colours;
    const HorizonQuality _quality;
    const std::optional<Globe> _globe;
    std::mutex _telling;
    std::set<std::string> _told; ///< colours that could not be read
};

} // namespace osgTerrainLight
