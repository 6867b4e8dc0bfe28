#pragma once

#include "core/Result.h"
#include "io/OverviewSource.h"

#include <osg/BoundingBox>
#include <osg/CoordinateSystemNode>
#include <osg/Matrixd>
#include <osgTerrain/Locator>

#include <string>

namespace osgTerrainLight
{

/// Where a raster in longitude and latitude lies on its ellipsoid. The frame of its scene is in
/// metres, x east, y north, z up, from the middle of the raster at height 0, as that of flat
/// terrain; the ground sinks away from there.
class Globe
{
public:
    /// An error where the raster's CRS has lengths. source: what messages call it.
    static Result<Globe> under(const OverviewSource& raster, const std::string& source);

    /// Of posts of a level, heights [m] above the ellipsoid. Its model coordinates are those of
    /// the scene.
    osg::ref_ptr<osgTerrain::Locator> locatorOf(const OverviewSource& raster, int level,
                                                const PostRect& posts) const;

    /// Of map coordinates and a height [m], in the frame of the scene.
    osg::Vec3d at(double mapX, double mapY, double height) const;
    /// From axes east, north and up at map coordinates and height 0 to the frame of the scene.
    osg::Matrixd axesAt(double mapX, double mapY) const;
    /// Of the raster, between two heights, in the frame of the scene.
    osg::BoundingBoxd extent(double lowest, double highest) const;
    /// Mean radius of the ellipsoid [m].
    double radius() const;

    /// The scene where it is on Earth: what stands below has geocentric coordinates.
    osg::ref_ptr<osg::CoordinateSystemNode> around(osg::Node& scene) const;

private:
    Globe() = default;

    osg::ref_ptr<osg::EllipsoidModel> _ellipsoid;
    std::string _crs; ///< WKT
    double _radiansPerUnit = 0.0;
    double _west = 0.0, _south = 0.0, _east = 0.0, _north = 0.0; ///< of its outermost posts [rad]
    osg::Matrixd _toScene;                                       ///< from geocentric coordinates
};

} // namespace osgTerrainLight
