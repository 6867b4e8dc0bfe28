#pragma once

#include "core/Result.h"
#include "io/DemReader.h"

#include <array>
#include <string>

namespace osgTerrainLight
{

/// Keys of maps and reader options that say how heights are read.
constexpr std::array<const char*, 3> readOptionNames = {"cell_size", "unit", "z_factor"};

/// Sets one of them from text. Errors name key, value and what is needed.
Status setReadOption(DemReadOptions& options, const std::string& name, const std::string& value);

} // namespace osgTerrainLight
