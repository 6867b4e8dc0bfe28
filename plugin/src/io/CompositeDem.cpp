#include "io/CompositeDem.h"

#include "io/Bilinear.h"
#include "io/PlacedHeights.h"
#include "io/PostsToPixels.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// A layer on the map of the first one, in posts of that.
struct Source
{
    std::size_t number = 0;
    DemInfo info;
    double west = 0.0, east = 0.0, south = 0.0, north = 0.0; ///< edges of the outermost pixels
    double step = 1.0;                                       ///< between its own posts
};

class Crs
{
public:
    explicit Crs(const std::string& wkt)
    {
        _isThere = !wkt.empty() && _reference.SetFromUserInput(wkt.c_str()) == OGRERR_NONE;
        _reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    }
    const OGRSpatialReference* get() const { return _isThere ? &_reference : nullptr; }

private:
    OGRSpatialReference _reference;
    bool _isThere;
};

/// Where pixels of a layer lie is measured at so many places along each side.
constexpr int lattice = 65;

/// Why the layer cannot be placed on the first one's map; else nothing, and it is placed.
std::optional<Error> place(const std::string& path, const DemInfo& first, Source& source)
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

/// Of the composite, in posts of the first layer.
struct Grid
{
    double west = -0.5, south = -0.5;
    double step = 1.0;
    RasterFrame frame;
};

Grid gridOf(const std::vector<Source>& sources, int maxSide)
{
    Grid grid;
    double west = grid.west, south = grid.south, east = west, north = south;
    for (const Source& source : sources)
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

/// Posts a side of what is read of a layer: bilinear samples leave out posts of a denser one.
int sideOf(const Source& source, double step, int maxSide)
{
    const int longest = std::max(source.info.rasterWidth, source.info.rasterHeight);
    if (step < 1.5 * source.step)
        return std::min(longest, 2 * maxSide);
    return std::clamp(static_cast<int>(std::ceil(longest * source.step / step - 1.0e-6)), 2,
                      maxSide);
}

/// Takes heights of a layer where it has some. heights: of the grid, from the south-west.
void cover(std::vector<double>& heights, const RasterFrame& grid, const DemFile& layer)
{
    const RasterFrame& frame = layer.frame;
    const DemTile& tile = layer.tile;
    const auto toPixels =
        PostsToPixels::between(grid, Crs(grid.crs).get(), frame, Crs(frame.crs).get());
    const auto at = [&](int column, int row)
    {
        return tile.isValid(column, row) ? tile.heightOrigin + double(tile.heightAt(column, row))
                                         : missing;
    };
    for (int row = 0; row < grid.height; ++row)
    {
        const PostsToPixels::Places places = toPixels->row(0.0, 1.0, grid.width, row);
        for (int column = 0; column < grid.width; ++column)
        {
            const auto i = static_cast<std::size_t>(column);
            const double x = frame.westFirst ? places.x[i] : frame.width - 1 - places.x[i];
            const double y = frame.northUp ? frame.height - 1 - places.y[i] : places.y[i];
            const double height = bilinear(x, y, frame.width, frame.height, at);
            if (!std::isnan(height))
                heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) + i] =
                    height;
        }
    }
}

class Compositor
{
public:
    Compositor(const std::vector<DemLayer>& layers, int maxSide)
        : _layers(layers), _maxSide(maxSide)
    {
    }

    CompositeDem read()
    {
        for (std::size_t i = 0; i < _layers.size(); ++i)
            if (Result<DemInfo> info = describeDem(_layers[i].path, _layers[i].read))
            {
                _sources.emplace_back();
                _sources.back().number = i;
                _sources.back().info = std::move(*info);
            }
            else
                leaveOut(i, info.error());
        // Without the layer that was found bad, others may have another map.
        while (!_result.tile && !_sources.empty())
            if (const std::optional<std::size_t> bad = compose())
                _sources.erase(_sources.begin() + static_cast<std::ptrdiff_t>(*bad));
        return std::move(_result);
    }

private:
    void leaveOut(std::size_t number, const Error& reason)
    {
        _result.leftOut.emplace_back(number, reason);
    }
    const DemLayer& layerOf(const Source& source) const { return _layers[source.number]; }

    /// The result, or which of the sources cannot be used, and was left out.
    std::optional<std::size_t> compose()
    {
        if (_sources.size() == 1)
            return take(0,
                        readDrawn(layerOf(_sources[0]).path, layerOf(_sources[0]).read, _maxSide));
        for (std::size_t i = 0; i < _sources.size(); ++i)
            if (const auto error = place(layerOf(_sources[i]).path, _sources[0].info, _sources[i]))
                return bad(i, *error);
        const Grid grid = gridOf(_sources, _maxSide);
        std::vector<double> heights(static_cast<std::size_t>(grid.frame.width) *
                                        static_cast<std::size_t>(grid.frame.height),
                                    missing);
        std::vector<std::string> notes;
        for (std::size_t i = 0; i < _sources.size(); ++i)
        {
            const DemLayer& layer = layerOf(_sources[i]);
            DemReadOptions options = layer.read;
            options.byMapScale = false;
            const Result<DemFile> file =
                readDemReduced(layer.path, options, sideOf(_sources[i], grid.step, _maxSide));
            if (!file)
                return bad(i, file.error());
            cover(heights, grid.frame, *file);
            for (const std::string& note : file->notes)
                notes.push_back(layer.path + ": " + note);
        }
        notes.push_back(std::to_string(_sources.size()) + " layers of heights make one of " +
                        std::to_string(grid.frame.width) + " x " +
                        std::to_string(grid.frame.height) + " posts");
        _result.notes = std::move(notes);
        const std::string& path = layerOf(_sources[0]).path;
        const Result<GroundSpacing> ground =
            measureGround(path, Crs(grid.frame.crs).get(), grid.frame);
        if (!ground)
            return bad(0, ground.error());
        return take(0,
                    placeHeights(path, grid.frame, *ground, {},
                                 [&](int column, int row)
                                 {
                                     return heights[static_cast<std::size_t>(row) *
                                                        static_cast<std::size_t>(grid.frame.width) +
                                                    static_cast<std::size_t>(column)];
                                 }));
    }

    std::optional<std::size_t> bad(std::size_t source, const Error& reason)
    {
        leaveOut(_sources[source].number, reason);
        return source;
    }

    /// What was read from the source on.
    std::optional<std::size_t> take(std::size_t source, Result<DemFile> file)
    {
        if (!file)
            return bad(source, file.error());
        for (const std::string& note : file->notes)
            _result.notes.push_back(layerOf(_sources[source]).path + ": " + note);
        _result.tile = std::move(file->tile);
        return std::nullopt;
    }

    const std::vector<DemLayer>& _layers;
    int _maxSide;
    std::vector<Source> _sources;
    CompositeDem _result;
};
} // namespace

Result<DemFile> readDrawn(const std::string& path, const DemReadOptions& options, int maxSide)
{
    Result<DemFile> file = readDemReduced(path, options, maxSide);
    if (file && (file->tile.width() < 2 || file->tile.height() < 2))
        return Error{ErrorCode::Invalid, path + ": has " + std::to_string(file->tile.width()) +
                                             " x " + std::to_string(file->tile.height()) +
                                             " posts; needs at least 2 x 2 to be drawn"};
    return file;
}

CompositeDem readComposite(const std::vector<DemLayer>& layers, int maxSide)
{
    return Compositor(layers, maxSide).read();
}

} // namespace osgTerrainLight
