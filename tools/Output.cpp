#include "Output.h"

#include "Console.h"
#include "io/GdalErrors.h"
#include "io/InputFiles.h"

#include <CLI/CLI.hpp>
#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <ogr_spatialref.h>

#include <algorithm>
#include <cstdint>

namespace osgTerrainLight::tool
{

bool isExr(const OutputOptions& output)
{
    return output.format.empty() ? EQUAL(CPLGetExtension(output.path.c_str()), "exr")
                                 : EQUAL(output.format.c_str(), "EXR");
}

Status checkOutput(const OutputOptions& output, int bands)
{
    if (isExr(output) && !output.creationOptions.empty())
        return Error{ErrorCode::NotSupported,
                     output.path + ": OpenEXR files have no creation options (-co)"};
    RasterFrame pixel;
    pixel.width = pixel.height = 1;
    OutputOptions options = output;
    if (isExr(output)) // not GDAL's to write: the folder is what matters
        options.format = "GTiff";
    const DeferredSignals deferred;
    const std::vector<BandLabel> labels(static_cast<std::size_t>(std::max(bands, 1)));
    Result<RasterWriter> writer =
        RasterWriter::open(output.path, pixel, labels, writeOptions(options, {}));
    if (!writer || bands == 0)
        return writer ? Status(Nothing{}) : Status(writer.error());
    for (int band = 1; band <= bands; ++band)
        if (Status written = writer->writeBand(band, Raster<float>(1, 1)); !written)
            return written;
    return writer->rehearse();
}

namespace
{
/// Names of the files that the driver makes of a pixel with a place, as they would be called.
std::vector<std::string> filesBeside(const OutputOptions& output)
{
    const std::string parent = CPLGetPath(output.path.c_str());
    const std::string name = CPLGetFilename(output.path.c_str());
    std::vector<std::string> files = {output.path};
    for (const char* sidecar : {".aux.xml", ".ovr", ".msk"})
        files.push_back(output.path + sidecar);
    if (isExr(output))
        return files;
    RasterFrame pixel;
    pixel.width = pixel.height = 1;
    pixel.hasGeoTransform = true;
    pixel.crs = SRS_WKT_WGS84_LAT_LONG;
    const std::string folder = CPLSPrintf("/vsimem/terrainlight-%d", int(CPLGetCurrentProcessID()));
    VSIMkdir(folder.c_str(), 0755);
    // What fails here is told by checkOutput().
    const bool isPicture = !writeRaster(folder + "/" + name, pixel, {{{}, Raster<float>(1, 1)}},
                                        writeOptions(output, {}));
    if (isPicture)
        static_cast<void>(writeRgb8(folder + "/" + name, pixel, std::vector<std::uint8_t>(3),
                                    writeOptions(output, {})));
    const CPLStringList made(VSIReadDir(folder.c_str()));
    for (int i = 0; i < made.size(); ++i)
        files.push_back(parent.empty() ? made[i]
                                       : CPLFormFilename(parent.c_str(), made[i], nullptr));
    VSIRmdirRecursive(folder.c_str());
    return files;
}
} // namespace

void refuseInputs(const std::vector<std::string>& inputs, const OutputOptions& output)
{
    std::vector<std::string> files;
    for (const std::string& input : inputs)
    {
        if (input == output.path && !input.empty())
            throw CLI::ValidationError("OUTPUT",
                                       output.path + " is the input file: needs another name");
        const std::vector<std::string> more = filesOf(input);
        files.insert(files.end(), more.begin(), more.end());
    }
    for (const std::string& file : filesBeside(output))
    {
        const std::string same = sameFile(files, file);
        if (same.empty())
            continue;
        const bool isInput = file == output.path && same == inputs.front();
        throw CLI::ValidationError(
            "OUTPUT", file +
                          (isInput               ? " is the input file"
                           : file == output.path ? " is " + same + ", which an input is made of"
                                                 : ", written beside " + output.path + ", is " +
                                                       same + ", which an input is made of") +
                          ": needs another name");
    }
}

std::string projComplaint()
{
    const GdalErrors errors;
    OGRSpatialReference crs;
    if (crs.importFromEPSG(4326) == OGRERR_NONE)
        return {};
    return "PROJ's data (proj.db) cannot be read: " + errors.first() +
           "; needed PROJ_LIB and PROJ_DATA to be unset, or to name the folder of PROJ's own data";
}

RasterWriteOptions writeOptions(const OutputOptions& output, const Metadata& metadata)
{
    RasterWriteOptions options;
    options.driver = output.format;
    options.creationOptions = output.creationOptions;
    options.metadata = metadata;
    return options;
}

} // namespace osgTerrainLight::tool
