#include "io/CacheFolder.h"

#include <cstdlib>

namespace osgTerrainLight
{

std::string userCacheFolder()
{
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && cache[0] == '/')
        return std::string(cache) + "/osgterrainlight";
    if (const char* home = std::getenv("HOME"); home && home[0] == '/')
        return std::string(home) + "/.cache/osgterrainlight";
    return {};
}

} // namespace osgTerrainLight
