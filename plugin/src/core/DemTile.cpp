#include <osgTerrainLight/DemTile.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

DemTile::DemTile(int width, int height, double spacing)
    : northSpacing(spacing), eastSpacings{spacing}, _width(width), _height(height),
      _heights(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f),
      _valid(_heights.size(), 0)
{
    assert(width > 0 && height > 0 && spacing > 0.0);
}

void DemTile::setHeight(int column, int row, float heightAboveOrigin)
{
    // No terrain of any body is higher; beyond it the void sentinel of the GPU texture begins.
    constexpr float limit = 1.0e6f;
    if (!(std::abs(heightAboveOrigin) <= limit))
    {
        setVoid(column, row);
        return;
    }
    _heights[index(column, row)] = heightAboveOrigin;
    _valid[index(column, row)] = 1;
}

void DemTile::setVoid(int column, int row)
{
    _heights[index(column, row)] = 0.0f;
    _valid[index(column, row)] = 0;
}

std::size_t DemTile::validCount() const
{
    return static_cast<std::size_t>(std::count(_valid.begin(), _valid.end(), std::uint8_t(1)));
}

std::string DemTile::complaint() const
{
    const auto isLegal = [](double spacing) { return std::isfinite(spacing) && spacing > 0.0; };
    const auto height = static_cast<std::size_t>(_height);
    if (_width < 1 || _height < 1)
        return "tile has " + std::to_string(_width) + " x " + std::to_string(_height) +
               " posts: needs at least one";
    if (!isLegal(northSpacing))
        return "northSpacing = " + std::to_string(northSpacing) + " m: needs more than 0";
    if (eastSpacings.size() != 1 && eastSpacings.size() != height)
        return "eastSpacings has " + std::to_string(eastSpacings.size()) +
               " entries: needs 1, or one per row, " + std::to_string(height);
    for (const double spacing : eastSpacings)
        if (!isLegal(spacing))
            return "eastSpacings has " + std::to_string(spacing) + " m: needs more than 0";
    if (!std::isfinite(heightOrigin))
        return "heightOrigin is not finite";
    return {};
}

double DemTile::eastSpacing(int row) const
{
    return eastSpacings.size() == 1 ? eastSpacings.front()
                                    : eastSpacings[static_cast<std::size_t>(row)];
}

double DemTile::nominalEastSpacing() const
{
    return eastSpacing(_height / 2);
}

double DemTile::sinkAt(int column, int row, double bodyRadius) const
{
    if (!(bodyRadius > 0.0))
        return 0.0;
    const double east = (column - 0.5 * (_width - 1)) * eastSpacing(row);
    const double north = (row - 0.5 * (_height - 1)) * northSpacing;
    return (east * east + north * north) / (2.0 * bodyRadius);
}

} // namespace osgTerrainLight
