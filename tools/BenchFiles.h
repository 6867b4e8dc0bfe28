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

/// Writes what was asked for. All contents are made before the first file, so that a failure to
/// draw leaves none.
Status writeFiles(const Options& options, const Report& report);
/// Paths and contents.
Status writeFiles(const std::vector<std::pair<std::string, std::string>>& files);

} // namespace osgTerrainLight::tool::bench
