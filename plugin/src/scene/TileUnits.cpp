#include "scene/TileUnits.h"

namespace osgTerrainLight
{

std::string TileUnits::glossProblem(unsigned unit, const TileRegistry& registry) const
{
    std::string user = shading == unit ? "the shading" : "";
    registry.forEach(
        [&](const SceneTile& tile)
        {
            if (tile.dynamic && tile.dynamic->getHeightUnit() == unit)
                user = "the heights of a DynamicTerrain";
            else if (tile.binding && tile.binding->unit() == unit)
                user = "the shading";
        });
    return user.empty() ? ""
                        : "gloss needs texture unit " + std::to_string(unit) + ", which " + user +
                              (user == "the shading" ? " has" : " have");
}

} // namespace osgTerrainLight
