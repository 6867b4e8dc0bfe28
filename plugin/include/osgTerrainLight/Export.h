#pragma once

/// Symbol visibility of the osgTerrainLight library.
#if defined(_WIN32)
#if defined(OSGTERRAINLIGHT_BUILD)
#define OSGTERRAINLIGHT_EXPORT __declspec(dllexport)
#else
#define OSGTERRAINLIGHT_EXPORT __declspec(dllimport)
#endif
#else
#define OSGTERRAINLIGHT_EXPORT __attribute__((visibility("default")))
#endif
