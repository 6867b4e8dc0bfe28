#include "io/AngularCrs.h"

#include "io/GdalErrors.h"

#include <ogr_spatialref.h>

namespace osgTerrainLight
{

std::optional<AngularCrs> angularCrs(const std::string& crs)
{
    const GdalErrors errors;
    OGRSpatialReference reference;
    // No file and no address: the text may come from a file of somebody else.
    if (crs.empty() ||
        reference.SetFromUserInput(crs.c_str(),
                                   OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
            OGRERR_NONE ||
        !reference.IsGeographic())
        return std::nullopt;
    return AngularCrs{reference.GetAngularUnits(), reference.GetSemiMajor(),
                      reference.GetSemiMinor()};
}

} // namespace osgTerrainLight
