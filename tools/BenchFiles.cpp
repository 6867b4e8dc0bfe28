#include "BenchFiles.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_multiproc.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace osgTerrainLight::tool::bench
{
namespace
{

std::filesystem::path placeOf(const std::string& path)
{
    std::error_code ignored;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
}

/// The file appears under its name when it is complete.
Status writeText(const std::string& path, const std::string& content)
{
    const DeferredSignals deferred;
    const std::string partial = CPLFormFilename(
        CPLGetPath(path.c_str()),
        CPLSPrintf(".%s.partial-%d", CPLGetFilename(path.c_str()), int(CPLGetCurrentProcessID())),
        nullptr);
    const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
    VSILFILE* file = VSIFOpenL(partial.c_str(), "wb");
    bool written = file && VSIFWriteL(content.data(), 1, content.size(), file) == content.size();
    written = file && VSIFCloseL(file) == 0 && written;
    if (written && VSIRename(partial.c_str(), path.c_str()) == 0)
        return Nothing{};
    const std::string reason = std::generic_category().message(errno);
    VSIUnlink(partial.c_str());
    return Error{ErrorCode::Failed, path + ": cannot be written: " + reason};
}

} // namespace

Status checkOutputs(const Options& options)
{
    namespace fs = std::filesystem;
    std::vector<std::pair<std::string, std::string>> used;
    if (!options.input.empty())
        used.emplace_back("INPUT", options.input);
    for (const auto& [option, path] : {std::pair<std::string, std::string>{"--csv", options.csv},
                                       {"--json", options.json},
                                       {"--plot", options.plot}})
    {
        if (path.empty())
            continue;
        std::error_code ignored;
        for (const auto& [otherOption, other] : used)
            // The one sees links, the other files that do not exist yet.
            if (fs::equivalent(path, other, ignored) || placeOf(path) == placeOf(other))
                throw CLI::ValidationError(option, path + " is the file of " + otherOption +
                                                       ": needs another name");
        used.emplace_back(option, path);
        // The format matters not: what is found out is whether a file can be made there.
        OutputOptions output;
        output.path = path;
        output.format = "GTiff";
        if (Status writable = checkOutput(output, 0); !writable)
            return writable;
    }
    return options.plot.empty() ? Status(Nothing{}) : checkPlotter();
}

Status writeFiles(const Options& options, const Report& report)
{
    std::vector<std::pair<std::string, std::string>> files;
    if (!options.csv.empty())
        files.emplace_back(options.csv, csvOf(report));
    if (!options.json.empty())
        files.emplace_back(options.json, jsonOf(report));
    if (!options.plot.empty())
    {
        Result<std::string> svg = svgOf(report);
        if (!svg)
            return Error{svg.error().code, options.plot + ": " + svg.error().message};
        files.emplace_back(options.plot, *svg);
    }
    for (const auto& [path, content] : files)
        if (Status written = writeText(path, content); !written)
            return written;
    return Nothing{};
}

} // namespace osgTerrainLight::tool::bench
