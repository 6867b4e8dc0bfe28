#include "osgdb/Register.h"

// OSG loads this module for the classes of namespace osgTerrainLight.
[[maybe_unused]] static const bool registered = (osgTerrainLight::registerSerializers(), true);
