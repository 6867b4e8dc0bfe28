#include "io/CompositeDem.h"

#include "io/Bilinear.h"
#include "io/CompositeGrid.h"
#include "io/PlacedHeights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Posts a side of what is read of a layer: bilinear samples leave out posts of a denser one.
int sideOf(const PlacedLayer& source, double step, int maxSide)
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
    const DemLayer& layerOf(const PlacedLayer& source) const { return _layers[source.number]; }

    /// The result, or which of the sources cannot be used, and was left out.
    std::optional<std::size_t> compose()
    {
        if (_sources.size() == 1)
            return take(0,
                        readDrawn(layerOf(_sources[0]).path, layerOf(_sources[0]).read, _maxSide));
        for (std::size_t i = 0; i < _sources.size(); ++i)
            if (const auto error = place(layerOf(_sources[i]).path, _sources[0].info, _sources[i]))
                return bad(i, *error);
        const CompositeGrid grid = gridOf(_sources, _maxSide);
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
    std::vector<PlacedLayer> _sources;
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
