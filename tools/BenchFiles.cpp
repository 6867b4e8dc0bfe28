#include "BenchFiles.h"

#include "io/InputFiles.h"
#include "io/PendingFile.h"

#include <filesystem>
#include <fstream>
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
    PendingFile file(path);
    if (Status created = file.create(true); !created)
        return created;
    std::ofstream stream(file.path(), std::ios::binary);
    stream << content;
    stream.close();
    if (!stream)
        return Error{ErrorCode::Failed, path + ": cannot be written: " +
                                            file.reason("", static_cast<double>(content.size()))};
    return file.commit();
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
        if (const std::string same = sameFile(filesOf(options.input), path); !same.empty())
            throw CLI::ValidationError(option, path + " is " + same +
                                                   ", which INPUT is made of: needs another name");
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

Status writeFiles(const std::vector<std::pair<std::string, std::string>>& files)
{
    for (const auto& [path, content] : files)
        if (Status written = writeText(path, content); !written)
            return written;
    return Nothing{};
}

} // namespace osgTerrainLight::tool::bench
