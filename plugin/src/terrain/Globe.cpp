#include "terrain/Globe.h"

#include "io/AngularCrs.h"

#include <osg/Math>
#include <osg/MatrixTransform>

#include <cmath>
#include <optional>

namespace osgTerrainLight
{

namespace
{
/// Model coordinates are those of the scene: geometry is then made along its axes, and its bounding
/// boxes are tight.
class SceneLocator : public osgTerrain::Locator
{
public:
    SceneLocator() = default;
    /// middle: longitude of the raster's [rad].
    SceneLocator(const osg::Matrixd& toScene, double middle)
        : _toScene(toScene), _toWorld(osg::Matrixd::inverse(toScene)), _middle(middle)
    {
    }
    SceneLocator(const SceneLocator& other, const osg::CopyOp& copyop)
        : osgTerrain::Locator(other, copyop), _toScene(other._toScene), _toWorld(other._toWorld),
          _middle(other._middle)
    {
    }
    osg::Object* cloneType() const override { return new SceneLocator; }
    osg::Object* clone(const osg::CopyOp& copyop) const override
    {
        return new SceneLocator(*this, copyop);
    }

    bool convertLocalToModel(const osg::Vec3d& local, osg::Vec3d& model) const override
    {
        if (!Locator::convertLocalToModel(local, model))
            return false;
        model = model * _toScene;
        return true;
    }
    bool convertModelToLocal(const osg::Vec3d& model, osg::Vec3d& local) const override
    {
        if (!Locator::convertModelToLocal(model * _toWorld, local))
            return false;
        // Longitudes of places are -180 ... 180 degrees; those of rasters may be any. A narrow tile
        // has the place where it is nearest to the tile, a wide one where it is nearest to the
        // raster.
        const double turn = 2.0 * osg::PI / getTransform()(0, 0);
        const double nearest =
            turn > 2.0 ? 0.5 : (_middle - getTransform()(3, 0)) / getTransform()(0, 0);
        local.x() += turn * std::round((nearest - local.x()) / turn);
        return true;
    }

private:
    ~SceneLocator() override = default;

    osg::Matrixd _toScene, _toWorld;
    double _middle = 0.0;
};
} // namespace

Result<Globe> Globe::under(const OverviewSource& raster, const std::string& source)
{
    const DemTile corners = raster.cornersOf(0, raster.terrain());
    const std::optional<AngularCrs> crs = angularCrs(corners.crs);
    if (!crs)
        return Error{ErrorCode::NotSupported,
                     source +
                         ": geocentric terrain needs longitude and latitude, and this raster " +
                         (corners.crs.empty() ? "has no CRS" : "is of another map") +
                         ": gdalwarp -t_srs EPSG:4326 makes a copy that has them"};
    Globe globe;
    globe._ellipsoid = new osg::EllipsoidModel(crs->semiMajor, crs->semiMinor);
    globe._crs = corners.crs;
    globe._radiansPerUnit = crs->radiansPerUnit;
    globe._west = corners.mapOriginX * crs->radiansPerUnit;
    globe._south = corners.mapOriginY * crs->radiansPerUnit;
    globe._east = (corners.mapOriginX + corners.mapStepX) * crs->radiansPerUnit;
    globe._north = (corners.mapOriginY + corners.mapStepY) * crs->radiansPerUnit;
    osg::Matrixd toWorld;
    globe._ellipsoid->computeLocalToWorldTransformFromLatLongHeight(
        0.5 * (globe._south + globe._north), 0.5 * (globe._west + globe._east), 0.0, toWorld);
    globe._toScene = osg::Matrixd::inverse(toWorld);
    return globe;
}

osg::ref_ptr<osgTerrain::Locator> Globe::locatorOf(const OverviewSource& raster, int level,
                                                   const PostRect& posts) const
{
    const DemTile corners = raster.cornersOf(level, posts);
    const osg::ref_ptr<osgTerrain::Locator> locator =
        new SceneLocator(_toScene, 0.5 * (_west + _east));
    locator->setCoordinateSystemType(osgTerrain::Locator::GEOCENTRIC);
    locator->setEllipsoidModel(_ellipsoid);
    locator->setTransformAsExtents(corners.mapOriginX * _radiansPerUnit,
                                   corners.mapOriginY * _radiansPerUnit,
                                   (corners.mapOriginX + corners.mapStepX) * _radiansPerUnit,
                                   (corners.mapOriginY + corners.mapStepY) * _radiansPerUnit);
    return locator;
}

osg::Vec3d Globe::at(double mapX, double mapY, double height) const
{
    osg::Vec3d world;
    _ellipsoid->convertLatLongHeightToXYZ(mapY * _radiansPerUnit, mapX * _radiansPerUnit, height,
                                          world.x(), world.y(), world.z());
    return world * _toScene;
}

osg::Matrixd Globe::axesAt(double mapX, double mapY) const
{
    osg::Matrixd toWorld;
    _ellipsoid->computeLocalToWorldTransformFromLatLongHeight(mapY * _radiansPerUnit,
                                                              mapX * _radiansPerUnit, 0.0, toWorld);
    return toWorld * _toScene;
}

osg::BoundingBoxd Globe::extent(double lowest, double highest) const
{
    constexpr int places = 16; // along a side
    osg::BoundingBoxd box;
    for (int i = 0; i <= places; ++i)
        for (int j = 0; j <= places; ++j)
            for (const double height : {lowest, highest})
                box.expandBy(at((_west + (_east - _west) * i / places) / _radiansPerUnit,
                                (_south + (_north - _south) * j / places) / _radiansPerUnit,
                                height));
    return box;
}

double Globe::radius() const
{
    return (2.0 * _ellipsoid->getRadiusEquator() + _ellipsoid->getRadiusPolar()) / 3.0;
}

osg::ref_ptr<osg::CoordinateSystemNode> Globe::around(osg::Node& scene) const
{
    const osg::ref_ptr<osg::CoordinateSystemNode> node = new osg::CoordinateSystemNode("WKT", _crs);
    node->setEllipsoidModel(_ellipsoid);
    const osg::ref_ptr<osg::MatrixTransform> toWorld =
        new osg::MatrixTransform(osg::Matrixd::inverse(_toScene));
    toWorld->addChild(&scene);
    node->addChild(toWorld);
    return node;
}

} // namespace osgTerrainLight
