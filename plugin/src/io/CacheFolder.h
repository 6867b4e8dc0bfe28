#pragma once

#include <string>

namespace osgTerrainLight
{

/// This user's folder of caches, which need not exist; empty where the system tells of none.
std::string userCacheFolder();

} // namespace osgTerrainLight
