#pragma once

#include "BenchOptions.h"
#include "BenchReport.h"

#include <string>
#include <utility>
#include <vector>

/// `terrainlight bench`: the files that it writes.
namespace osgTerrainLight::tool::bench
{
/// Finds out before the work which files cannot be written, or are asked for twice.
Status checkOutputs(const Options& options);

/// Paths and contents.
Status writeFiles(const std::vector<std::pair<std::string, std::string>>& files);

/// Writes what was asked for of a report that csvOf(), jsonOf() and svgOf() take. All contents are
/// made before the first file, so that a failure to draw leaves none.
template <class AnyReport>
Status writeFiles(const Options& options, const AnyReport& report)
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
        files.emplace_back(options.plot, std::move(*svg));
    }
    return writeFiles(files);
}

} // namespace osgTerrainLight::tool::bench
