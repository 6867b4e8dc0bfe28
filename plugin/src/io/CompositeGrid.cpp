#include "io/CompositeGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
/// Where pixels of a layer lie is measured at so many places along each side.
constexpr int lattice = 65;
} // namespace

Crs::Crs(const std::string& wkt)
{
    _isThere = !wkt.empty() && _reference.SetFromUserInput(wkt.c_str()) == OGRERR_NONE;
    _reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
}

std::optional<Error> place(const std::string& path, const DemInfo& first, PlacedLayer& source)
{
    const RasterFrame& frame = source.info.frame;
    const auto invalid = [&](const std::string& reason) {
        return Error{ErrorCode::Invalid, path + ": " + reason};
    };
    if (!first.frame.hasGeoTransform || !frame.hasGeoTransform)
        return invalid("layers cannot be placed by each other where one has no geotransform");
    if (first.frame.crs.empty() != frame.crs.empty())
        return invalid("of this layer and the first one only one has a CRS; needed both or none");
    const auto toPixels = PostsToPixels::between(first.frame, Crs(first.frame.crs).get(), frame,
                                                 Crs(frame.crs).get());
    if (!toPixels)
        return invalid("there is no way from CRS \"" + source.info.crsName + "\" to \"" +
                       first.crsName + "\"");
    PostsToPixels::Places pixels;
    for (int row = 0; row < lattice; ++row)
        for (int column = 0; column < lattice; ++column)
        {
            pixels.x.push_back(frame.width * static_cast<double>(column) / (lattice - 1) - 0.5);
            pixels.y.push_back(frame.height * static_cast<double>(row) / (lattice - 1) - 0.5);
        }
    const PostsToPixels::Places posts = toPixels->posts(pixels);
    source.west = source.south = std::numeric_limits<double>::infinity();
    source.east = source.north = -source.west;
    for (std::size_t i = 0; i < posts.x.size(); ++i)
        if (!std::isnan(posts.x[i]))
        {
            source.west = std::min(source.west, posts.x[i]);
            source.east = std::max(source.east, posts.x[i]);
            source.south = std::min(source.south, posts.y[i]);
            source.north = std::max(source.north, posts.y[i]);
        }
    const double x = 0.5 * (frame.width - 1);
    const double y = 0.5 * (frame.height - 1);
    const PostsToPixels::Places middle = toPixels->posts({{x, x + 1.0, x}, {y, y, y + 1.0}});
    const auto distanceTo = [&](std::size_t i)
    { return std::hypot(middle.x[i] - middle.x[0], middle.y[i] - middle.y[0]); };
    source.step = std::min(distanceTo(1), distanceTo(2));
    if (!(source.step > 0.0))
        return invalid("lies outside what the CRS of the first layer, \"" + first.crsName +
                       "\", can show");
    return std::nullopt;
}

CompositeGrid gridOf(const std::vector<PlacedLayer>& sources, int maxSide)
{
    CompositeGrid grid;
    double west = grid.west, south = grid.south, east = west, north = south;
    for (const PlacedLayer& source : sources)
    {
        west = std::min(west, source.west);
        south = std::min(south, source.south);
        east = std::max(east, source.east);
        north = std::max(north, source.north);
        grid.step = std::min(grid.step, source.step);
    }
    // A tenth for rounding, and for spacings that differ within a layer: posts of the first layer
    // then stay where they are.
    if (grid.step > 0.9)
        grid.step = 1.0;
    constexpr double rounding = 1.0e-6;
    const auto cells = [&](double length)
    { return std::max(0.0, std::ceil(length / grid.step - rounding)); };
    grid.west -= grid.step * cells(grid.west - west);
    grid.south -= grid.step * cells(grid.south - south);
    const double width = east - grid.west;
    const double height = north - grid.south;
    grid.step = std::max(grid.step, std::max(width, height) / maxSide);

    const RasterFrame& first = sources.front().info.frame;
    RasterFrame& frame = grid.frame;
    frame = first;
    frame.width = std::clamp(static_cast<int>(cells(width)), 2, maxSide);
    frame.height = std::clamp(static_cast<int>(cells(height)), 2, maxSide);
    frame.northUp = frame.westFirst = true;
    const double stepX = std::abs(first.geoTransform[1]) * grid.step;
    const double stepY = std::abs(first.geoTransform[5]) * grid.step;
    frame.geoTransform = {first.mapX(grid.west),
                          stepX,
                          0.0,
                          first.mapY(grid.south + grid.step * frame.height),
                          0.0,
                          -stepY};
    return grid;
}

} // namespace osgTerrainLight
