#include "scene/TileValues.h"

#include <algorithm>

namespace osgTerrainLight
{

namespace
{
bool isWithin(float value, float minimum, float maximum)
{
    return value >= minimum && value <= maximum; // not NaN
}
} // namespace

bool isTileSized(const SceneTile& tile, std::size_t posts)
{
    return posts == static_cast<std::size_t>(tile.lit->drawnWidth()) *
                        static_cast<std::size_t>(tile.lit->drawnHeight());
}

bool areAlbedo(const SceneTile& tile, const std::vector<Rgb>& values)
{
    const auto isLegal = [](const Rgb& post)
    {
        return std::all_of(post.begin(), post.end(),
                           [](float channel) { return isWithin(channel, 0.0f, 1.0f); });
    };
    return (values.empty() || isTileSized(tile, values.size())) &&
           std::all_of(values.begin(), values.end(), isLegal);
}

bool areGloss(const SceneTile& tile, const std::vector<std::array<float, 2>>& values)
{
    const auto isLegal = [](const std::array<float, 2>& post)
    { return isWithin(post[0], 0.0f, 1.0f) && isWithin(post[1], 1.0f, 64.0f); };
    return (values.empty() || isTileSized(tile, values.size())) &&
           std::all_of(values.begin(), values.end(), isLegal);
}

} // namespace osgTerrainLight
