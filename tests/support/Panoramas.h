#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace osgTerrainLight
{

/// One of the eight panoramas of Debian's blender-data (CC0, 1024 x 512, by Greg Zaal): city,
/// courtyard, forest, interior, night, studio, sunrise, sunset.
inline std::string panorama(const std::string& name)
{
    return "/usr/share/blender/datafiles/studiolights/world/" + name + ".exr";
}

#define OTL_SKIP_WITHOUT_PANORAMAS()                                                               \
    if (!std::filesystem::exists(osgTerrainLight::panorama("sunrise")))                            \
    GTEST_SKIP() << "skipped: needs panoramas, and " << osgTerrainLight::panorama("sunrise")       \
                 << " is absent (install Debian's package blender-data)"

} // namespace osgTerrainLight
