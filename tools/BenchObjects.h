#pragma once

#include "BenchOptions.h"

/// `terrainlight bench --objects`.
namespace osgTerrainLight::tool::bench
{
Status runObjects(const Options& options, const std::string& date);
} // namespace osgTerrainLight::tool::bench
