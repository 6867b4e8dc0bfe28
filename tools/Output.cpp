#include "Output.h"

#include "Console.h"

#include <CLI/CLI.hpp>
#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <filesystem>

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
    {
        Result<RasterWriter> writer =
            RasterWriter::open(output.path, pixel, {{}}, writeOptions(options, {}));
        if (!writer)
            return writer.error();
    } // the writer goes, and what it made with it
    if (bands == 0)
        return Nothing{};

    const std::string parent = CPLGetPath(output.path.c_str());
    const std::string name = CPLGetFilename(output.path.c_str());
    const std::string folder = CPLFormFilename(
        parent.c_str(), CPLSPrintf(".%s.probe-%d", name.c_str(), int(CPLGetCurrentProcessID())),
        nullptr);
    const std::string path = folder + "/" + name;
    VSIMkdir(folder.c_str(), 0755);
    const std::vector<RasterBand> floats(static_cast<std::size_t>(bands),
                                         {{}, Raster<float>(1, 1)});
    Status written = writeRaster(path, pixel, floats, writeOptions(options, {}));
    VSIRmdirRecursive(folder.c_str());
    if (written)
        return written;
    std::string message = written.error().message;
    // GDAL names the file in the folder.
    for (std::size_t at = 0; (at = message.find(folder, at)) != std::string::npos;)
    {
        const std::size_t end = message.find("/" + name, at);
        message.replace(at, end == std::string::npos ? end : end + 1 + name.size() - at,
                        output.path);
        at += output.path.size();
    }
    return Error{written.error().code, message};
}

void refuseSameFile(const std::string& input, const std::string& output)
{
    std::error_code ignored;
    if (input == output || std::filesystem::equivalent(input, output, ignored))
        throw CLI::ValidationError("OUTPUT", output + " is the input file: needs another name");
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
