#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace osgTerrainLight
{

/// Folder of real and damaged rasters that is shared beside the checkout and not part of it.
inline std::string sharedDataFolder()
{
    return std::string(OTL_SHARED_DIR) + "/data";
}

inline std::string sharedData(const std::string& name)
{
    return sharedDataFolder() + "/" + name;
}

} // namespace osgTerrainLight

/// First line of a test that reads shared data.
#define OTL_SKIP_WITHOUT_SHARED_DATA()                                                             \
    if (!std::filesystem::is_directory(osgTerrainLight::sharedDataFolder()))                       \
    GTEST_SKIP() << "skipped: needs the shared data, and " << osgTerrainLight::sharedDataFolder()  \
                 << " is absent (set OTL_SHARED_DIR)"
