#include "Output.h"

#include "Console.h"
#include "io/GdalErrors.h"
#include "io/InputFiles.h"
#include "io/PendingFile.h"

#include <CLI/CLI.hpp>
#include <cpl_conv.h>
#include <cpl_multiproc.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>

namespace osgTerrainLight::tool
{
namespace
{
namespace fs = std::filesystem;
}

bool isExr(const OutputOptions& output)
{
    return output.format.empty() ? EQUAL(fs::path(output.path).extension().c_str(), ".exr")
                                 : EQUAL(output.format.c_str(), "EXR");
}

Status checkOutput(const OutputOptions& output, int bands, const RasterFrame& frame)
{
    if (output.path.rfind("/vsi", 0) == 0)
        return Error{ErrorCode::NotSupported,
                     output.path + ": a result is written at random and then renamed, which GDAL's "
                                   "virtual file systems cannot do, and what is in /vsimem/ ends "
                                   "with the program; needed the name of a file on disk"};
    if (isExr(output) && !output.creationOptions.empty())
        return Error{ErrorCode::NotSupported,
                     output.path + ": OpenEXR files have no creation options (-co)"};
    RasterFrame pixel = frame;
    pixel.width = std::clamp(frame.width, 1, 2); // some formats need two
    pixel.height = std::clamp(frame.height, 1, 2);
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
        if (Status written = writer->writeBand(band, Raster<float>(pixel.width, pixel.height));
            !written)
            return written;
    const Result<bool> keepsEpoch = writer->rehearse();
    if (!keepsEpoch)
        return keepsEpoch.error();
    if (!*keepsEpoch)
        warn(output.path + ": this format does not keep the CRS's coordinate epoch, " +
             text(frame.coordinateEpoch));
    return Nothing{};
}

namespace
{
/// Names of the files that the driver makes of a pixel with a place, as they would be called.
std::vector<std::string> filesBeside(const OutputOptions& output)
{
    const std::string place = withoutLinks(output.path);
    const fs::path parent = fs::path(place).parent_path();
    const std::string name = fs::path(place).filename().string();
    std::vector<std::string> files = {output.path};
    for (const char* sidecar : {".aux.xml", ".ovr", ".msk"})
        files.push_back(place + sidecar);
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
        files.push_back((parent / made[i]).string());
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
        const bool isInput =
            file == output.path && std::find(inputs.begin(), inputs.end(), same) != inputs.end();
        throw CLI::ValidationError(
            "OUTPUT", file +
                          (isInput               ? " is the input file " + same
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
