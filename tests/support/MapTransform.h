#pragma once

#include <ogr_spatialref.h>

#include <memory>
#include <string>

namespace osgTerrainLight
{

/// From one CRS to another by PROJ, each as GDAL takes it ("EPSG:4326"); x is east or the
/// longitude.
inline std::unique_ptr<OGRCoordinateTransformation> transformation(const std::string& from,
                                                                   const std::string& to)
{
    OGRSpatialReference source, target;
    source.SetFromUserInput(from.c_str());
    target.SetFromUserInput(to.c_str());
    source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    target.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return std::unique_ptr<OGRCoordinateTransformation>(
        OGRCreateCoordinateTransformation(&source, &target));
}

} // namespace osgTerrainLight
