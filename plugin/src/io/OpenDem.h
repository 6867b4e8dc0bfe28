#pragma once

#include "io/DemReader.h"
#include "io/GroundSpacing.h"

#include <gdal_priv.h>

namespace osgTerrainLight
{

class GdalErrors;

/// An open raster whose metadata passed every check.
struct OpenDem
{
    GDALDatasetUniquePtr dataset;
    GDALRasterBand* band = nullptr;
    DemInfo info;
    GroundSpacing ground;
};

/// limited: whether the size is, since heights will be read. dataset: of the path, where it is open
/// already.
Result<OpenDem> openDem(const std::string& path, const DemReadOptions& options, bool limited,
                        const GdalErrors& errors, GDALDatasetUniquePtr dataset = nullptr);

} // namespace osgTerrainLight
