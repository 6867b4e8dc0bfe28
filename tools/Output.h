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
/// option, a driver without floats or without this place. bands: of floats; 0 for a picture or EXR
/// file. frame: whose place the output has.
Status checkOutput(const OutputOptions& output, int bands, const RasterFrame& frame = {});

/// A mistake in the command line where the output, or a file beside it that it would replace
/// (.aux.xml, .ovr, .msk, and what its driver writes: headers, world files, .prj), is a file that
/// one of the inputs is made of. Empty inputs are none.
void refuseInputs(const std::vector<std::string>& inputs, const OutputOptions& output);

/// Empty, or why PROJ knows no CRS: its data are missing or of another version, as where PROJ_LIB
/// names another program's folder.
std::string projComplaint();

/// The writer's options for an output.
RasterWriteOptions writeOptions(const OutputOptions& output, const Metadata& metadata);

} // namespace osgTerrainLight::tool
