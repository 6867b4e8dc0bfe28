#pragma once

#include <osgTerrainLight/Export.h>

namespace osgTerrainLight
{

/// What OSG's plugin modules call. They hold no code of their own, so that a process has one copy
/// of the library; a program that links the library's objects calls these itself and needs no
/// module. Not installed. A second call does nothing.
OSGTERRAINLIGHT_EXPORT void registerReader();
OSGTERRAINLIGHT_EXPORT void registerSerializers();

} // namespace osgTerrainLight
