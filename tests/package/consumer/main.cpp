#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/LightingSettings.h>

#include <iostream>

// Calls into the library, so that linking and loading are proved and not only compiling.
int main()
{
    osgTerrainLight::DemTile tile(3, 2, 30.0);
    tile.setHeight(1, 1, 12.5f);
    const osgTerrainLight::ParameterRange* range =
        osgTerrainLight::ParameterRange::find("azimuths");
    if (!range || tile.postCount() != 6 || tile.validCount() != 1)
    {
        std::cerr << "the installed library answers wrongly\n";
        return 1;
    }
    const osgTerrainLight::LightingSettings settings;
    std::cout << "quality " << osgTerrainLight::toString(settings.quality) << ", " << range->name
              << " " << settings.azimuths << " of " << range->maximum << "\n";
    return 0;
}
