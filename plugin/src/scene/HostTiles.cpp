#include "scene/HostTiles.h"

#include "io/AngularCrs.h"
#include "scene/TileValues.h"

#include <osg/Notify>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();
constexpr float highestPost = 1.0e6f; ///< as in DemTile [m]

/// Asks the host, and holds off what it does wrong. Said once for all tiles.
class AskedHeights
{
public:
    AskedHeights(Surroundings surroundings, double radiansPerUnit)
        : _surroundings(std::move(surroundings)), _unit(radiansPerUnit)
    {
    }

    BaseGround ground(const std::shared_ptr<AskedHeights>& self) const
    {
        return {_surroundings.west * _unit, _surroundings.south * _unit, _surroundings.east * _unit,
                _surroundings.north * _unit,
                [self](double west, double south, double eastStep, double northStep, int columns,
                       int rows) {
                    return self->read({west, south, eastStep, northStep, columns, rows});
                }};
    }

private:
    /// grid: in units of the patches.
    std::vector<float> read(PostGrid grid)
    {
        grid.west /= _unit;
        grid.south /= _unit;
        grid.eastStep /= _unit;
        grid.northStep /= _unit;
        const std::size_t posts =
            static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
        std::vector<float> heights;
        std::string problem;
        try
        {
            heights = _surroundings.heights(grid);
            if (heights.size() != posts)
                problem = "it returned " + std::to_string(heights.size()) + " heights: needs " +
                          std::to_string(posts);
        }
        catch (const std::exception& exception)
        {
            problem = std::string("it threw: ") + exception.what();
        }
        catch (...)
        {
            problem = "it threw";
        }
        if (!problem.empty())
        {
            if (!std::exchange(_said, true))
                OSG_WARN << "osgTerrainLight: terrain is lit without some of its surroundings: the "
                            "function that reads their heights failed: "
                         << problem << std::endl;
            return {};
        }
        for (float& height : heights)
            if (!(std::abs(height) <= highestPost))
                height = missing;
        return heights;
    }

    const Surroundings _surroundings;
    const double _unit;
    bool _said = false;
};

std::shared_ptr<const DemTile> withHeights(const DemTile& dem, const std::vector<float>& heights)
{
    auto changed = std::make_shared<DemTile>(dem);
    auto next = heights.begin();
    for (int row = 0; row < dem.height(); ++row)
        for (int column = 0; column < dem.width(); ++column)
            changed->setHeight(column, row, *next++);
    return changed;
}

void bring(SceneTile& tile)
{
    TileLight& lighting = tile.lit->lighting();
    if (!tile.host->albedo.empty())
        lighting.setAlbedo(tile.lit->withMargin(rasterOf(tile, tile.host->albedo)));
    if (!tile.host->gloss.empty())
        lighting.setGloss(tile.lit->withMargin(rasterOf(tile, tile.host->gloss)));
}
} // namespace

std::optional<PlacedGround> HostTiles::placeOf(const DemTile& dem, const TileHandle& name)
{
    const DemTile unplaced;
    // A tile with a post per metre may lie there. That of a host that sets no coordinates is then
    // the only one on its map.
    const bool mayBeThere = dem.eastSpacings == unplaced.eastSpacings &&
                            dem.northSpacing == unplaced.northSpacing &&
                            (!dem.crs.empty() || (name.x == 0 && name.y == 0));
    const bool isSet = mayBeThere || dem.mapOriginX != unplaced.mapOriginX ||
                       dem.mapOriginY != unplaced.mapOriginY || dem.mapStepX != unplaced.mapStepX ||
                       dem.mapStepY != unplaced.mapStepY;
    if (!isSet || (dem.crs.empty() && name.level < 0) || dem.width() < 2 || dem.height() < 2 ||
        !std::isfinite(dem.mapOriginX) || !std::isfinite(dem.mapOriginY) ||
        !(dem.mapStepX > 0.0 && dem.mapStepY > 0.0) || !std::isfinite(dem.mapStepX) ||
        !std::isfinite(dem.mapStepY))
        return std::nullopt;
    PlacedGround ground;
    double unit = 1.0;
    if (const std::optional<AngularCrs> angular = angularCrs(dem.crs))
    {
        unit = angular->radiansPerUnit;
        ground.semiMajor = angular->semiMajor;
        ground.semiMinor = angular->semiMinor;
    }
    ground.crs = dem.crs;
    ground.patch = {std::make_shared<const DemTile>(dem),
                    dem.mapOriginX * unit,
                    dem.mapOriginY * unit,
                    dem.mapStepX * unit,
                    dem.mapStepY * unit,
                    0.0};
    return ground;
}

void HostTiles::add(SceneTile& tile, const PlacedGround& ground, osg::StateSet* stateSet,
                    const ShadingCoordinates& coordinates, bool program)
{
    tile.host = std::make_unique<HostGround>();
    tile.host->ground = ground;
    tile.host->stateSet = stateSet;
    tile.host->coordinates = coordinates;
    tile.host->program = program;
    tile.isNew = true;
    _binder.bindWaiting(tile);
    _neighbours.set(tile.handle, ground);
    _due.push_back(tile.handle);
}

void HostTiles::remove(const SceneTile& tile)
{
    _neighbours.remove(tile.handle);
    _due.erase(std::remove(_due.begin(), _due.end(), tile.handle), _due.end());
}

void HostTiles::setHeights(SceneTile& tile, const std::vector<float>& heights)
{
    TerrainPatch& patch = tile.host->ground.patch;
    patch.dem = withHeights(*patch.dem, heights);
    _neighbours.set(tile.handle, tile.host->ground);
    if (std::find(_due.begin(), _due.end(), tile.handle) == _due.end())
        _due.push_back(tile.handle);
}

void HostTiles::setSurroundings(const Surroundings& surroundings)
{
    std::optional<BaseGround> base;
    if (surroundings.heights)
    {
        const std::optional<AngularCrs> angular = angularCrs(surroundings.crs);
        _radiansPerUnit = angular ? angular->radiansPerUnit : 1.0;
        const auto asked = std::make_shared<AskedHeights>(surroundings, _radiansPerUnit);
        base = asked->ground(asked);
    }
    _neighbours.setBase(std::move(base), surroundings.crs);
}

void HostTiles::changeSurroundings(double west, double south, double east, double north,
                                   double highest)
{
    const double unit = _radiansPerUnit;
    _neighbours.changeBase(west * unit, south * unit, east * unit, north * unit, highest);
}

bool HostTiles::hasTime() const
{
    const double budget = _scheduler->budget;
    return budget <= 0.0 || _reading < budget;
}

/// Margins and rings are of other sizes where there are bounces now, or another quality.
void HostTiles::followSettings()
{
    const LightingSettings& settings = _scheduler->light()->settings;
    if (_bounces == (settings.bounces > 0) && _quality == settings.quality)
        return;
    _bounces = settings.bounces > 0;
    _quality = settings.quality;
    _registry.forEach(
        [this](const SceneTile& tile)
        {
            if (tile.host && tile.lit->isSurrounded() &&
                std::find(_due.begin(), _due.end(), tile.handle) == _due.end())
                _due.push_back(tile.handle);
        });
}

/// Lights it again, from all that is known now.
void HostTiles::surround(SceneTile& tile)
{
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<const TileWindows> windows =
        _neighbours.around(tile.handle, _scheduler->light()->settings.quality);
    _reading +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const bool fresh = std::exchange(tile.isNew, false);
    if (!fresh && !windows && !tile.lit->isSurrounded())
    {
        const DemTile& dem = *tile.host->ground.patch.dem;
        std::vector<float> heights = dem.heights();
        for (std::size_t i = 0; i < heights.size(); ++i)
            if (dem.validity()[i] == 0)
                heights[i] = missing;
        tile.lit->lighting().setHeights(heights);
        _scheduler->touch();
        return;
    }
    if (!fresh)
        _fades.keep(tile);
    _binder.release(tile);
    _binder.bindPlaced(tile, windows);
    bring(tile);
    _fades.begin(tile);
}

/// All that came is known before the first of it is lit. One tile that sees other ground now is lit
/// again per update.
void HostTiles::update()
{
    _reading = 0.0;
    followSettings();
    while (!_due.empty() && hasTime())
    {
        SceneTile* tile = _registry.find(_due.front());
        _due.pop_front();
        if (tile)
            surround(*tile);
    }
    if (!hasTime())
        return;
    const std::optional<TileHandle> stale = _neighbours.takeStale();
    if (SceneTile* tile = stale ? _registry.find(*stale) : nullptr)
        surround(*tile);
}

} // namespace osgTerrainLight
