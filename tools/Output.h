#pragma once

#include "Metadata.h"
#include "core/Result.h"
#include "io/RasterWriter.h"

#include <string>
#include <vector>

/// Where a result goes.
namespace osgTerrainLight::tool
{

struct OutputOptions
{
    std::string path;
    std::string format;
    std::vector<std::string> creationOptions;
    bool quiet = false;
};

/// True where OpenEXR writes it, not GDAL: by its format, else by its extension.
bool isExr(const OutputOptions& output);

/// Finds out before the work what else would show after it: no such folder, driver or creation
/// option, a driver without floats. bands: of floats; 0 for a picture or EXR file.
Status checkOutput(const OutputOptions& output, int bands);

/// A mistake in the command line where both are one file.
void refuseSameFile(const std::string& input, const std::string& output);

/// The writer's options for an output.
RasterWriteOptions writeOptions(const OutputOptions& output, const Metadata& metadata);

} // namespace osgTerrainLight::tool
