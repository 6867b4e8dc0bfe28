#include "osgdb/Register.h"

// OSG loads this module for the extensions terrainlight and earth.
[[maybe_unused]] static const bool registered = (osgTerrainLight::registerReader(), true);
