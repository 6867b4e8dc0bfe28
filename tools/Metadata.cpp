#include "Metadata.h"

#include "Console.h"

namespace osgTerrainLight::tool
{
void add(Metadata& metadata, const std::string& name, const std::string& value)
{
    metadata.emplace_back("TERRAINLIGHT_" + name, value);
}

void addReading(Metadata& metadata, const DemReadOptions& read)
{
    if (read.band != 1)
        add(metadata, "BAND", std::to_string(read.band));
    if (const auto& window = read.window)
        add(metadata, "SRCWIN",
            std::to_string(window->column) + "," + std::to_string(window->row) + "," +
                std::to_string(window->width) + "," + std::to_string(window->height));
    if (read.cellSize)
        add(metadata, "CELL_SIZE", text(*read.cellSize));
    if (!read.heightUnit.empty())
        add(metadata, "UNIT", read.heightUnit);
    if (read.heightFactor != 1.0)
        add(metadata, "Z_FACTOR", text(read.heightFactor));
}

void addSun(Metadata& metadata, const SkyLight& sky)
{
    for (const char* name : {"sun-azimuth", "sun-elevation", "sun-radius"})
        addSetting(metadata, name, sky);
}

void addPlace(Metadata& metadata, const EarthPlace& place)
{
    add(metadata, "PLACE", text(place.longitude) + "," + text(place.latitude));
    add(metadata, "CONVERGENCE", text(place.convergence));
}

void addAreaLights(Metadata& metadata, const SkyLight& sky)
{
    if (sky.skyEnabled && sky.environment)
    {
        addSetting(metadata, "sky-heading", sky);
        addSetting(metadata, "sky-gain", sky);
    }
    else if (sky.skyEnabled && sky.skyModel == SkyModel::Clear)
        addSetting(metadata, "turbidity", sky);
    if (sky.skyEnabled && !sky.skyHarmonics.empty())
        addSetting(metadata, "sky-harmonics", sky);
    if (!sky.keyLights.empty())
        addSetting(metadata, "key-lights", sky);
}

} // namespace osgTerrainLight::tool
