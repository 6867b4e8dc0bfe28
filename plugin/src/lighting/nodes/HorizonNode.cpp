#include "lighting/nodes/HorizonNode.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/TileWindows.h"
#include "lighting/nodes/AzimuthRays.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
/// Vertices of a line's hull: 8 bytes each, private to the invocation.
constexpr int hullSize = 64;
/// Hulls of one dispatch [bytes]: directions are dispatched in batches that stay below.
constexpr std::size_t hullBudget = std::size_t(24) << 20;
} // namespace

HorizonScheme HorizonScheme::of(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return {4, 1, 1};
    case HorizonQuality::Best:
        return {24, 2, 2};
    default:
        return {8, 1, 1};
    }
}

HorizonScheme HorizonScheme::ofSun(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return {8, 1, 1};
    case HorizonQuality::Best:
        return {64, 2, 2};
    default:
        return {32, 2, 2};
    }
}

HorizonNode::HorizonNode(const std::string& name, const TileSurface& surface,
                         const HorizonScheme& scheme, int directionCount, Directions directions)
    : Node(name), _surface(&surface), _scheme(scheme), _wanted(std::move(directions)),
      _horizon(writes(own(new Resource(name, surface.perPost(GL_R16, directionCount))))),
      _dropped(own(new Resource("dropped vertices", {1, 1, 0, GL_R32UI}))),
      _stepLengths(own(new Resource("step lengths"))), _near(own(new GpuPass("horizon_near")))
{
    assert(surface.frame() >= frame && scheme.reach + 20 <= frame);
    reads(surface.heights());
    for (int parity = 0; parity < scheme.linesAsked; ++parity)
    {
        std::vector<std::string> defines = {"HULL_SIZE " + std::to_string(hullSize),
                                            "ASKED " + std::to_string(scheme.linesAsked),
                                            "PARITY " + std::to_string(parity)};
        if (scheme.linesPerPost > 1)
            defines.push_back("DENSE");
        for (const std::string& define : surface.farDefines())
            defines.push_back(define);
        _sweeps.push_back(own(new GpuPass("horizon_sweep", defines)));
    }
    std::vector<GpuPass*> passes = _sweeps;
    passes.push_back(_near);
    for (GpuPass* pass : passes)
    {
        surface.bind(*pass);
        pass->reads("stepLengths", _stepLengths);
        pass->set("reach", scheme.reach);
        pass->writes(0, _horizon, GpuPass::Access::ReadWrite);
    }
    for (GpuPass* sweep : _sweeps)
    {
        sweep->set("linesPerPost", scheme.linesPerPost);
        sweep->writes(1, _dropped, GpuPass::Access::ReadWrite);
        surface.bindFar(*sweep);
    }
}

void HorizonNode::setDirectionCount(int count)
{
    _horizon->setLayout(_surface->perPost(GL_R16, count));
}

int HorizonNode::linesOf(const GridDirection& grid) const
{
    const int steps = grid.north ? _surface->height() : _surface->width();
    const int breadth = grid.north ? _surface->width() : _surface->height();
    const double lines = _scheme.linesPerPost * (breadth + std::abs(grid.drift) * steps);
    return 2 + static_cast<int>(lines) + (_surface->windows() ? 1 : 0);
}

/// Takes up the directions.
void HorizonNode::aim()
{
    const DemTile& tile = _surface->tile();
    const std::vector<MapDirection> wanted = _wanted();
    assert(static_cast<int>(wanted.size()) == _horizon->layout().layers);
    const auto isSame = [](const MapDirection& a, const MapDirection& b)
    { return a.east == b.east && a.north == b.north; };
    if (_stepLengths->texture() &&
        std::equal(wanted.begin(), wanted.end(), _aimed.begin(), _aimed.end(), isSame))
        return; // a run that goes on
    _aimed = wanted;
    _directions.clear();
    _maxLines = 0;
    Raster<float> lengths(static_cast<int>(wanted.size()), tile.height());
    std::vector<osg::Vec4f> table(256);
    for (std::size_t i = 0; i < wanted.size(); ++i)
    {
        const GridDirection grid(tile, wanted[i]);
        table[i].set(static_cast<float>(grid.drift), static_cast<float>(grid.look),
                     grid.north ? 1.0f : 0.0f,
                     static_cast<float>(lineShift(*_surface, grid, _scheme.linesPerPost)));
        _directions.push_back(table[i]);
        _directions.back().w() = static_cast<float>(i);
        _maxLines = std::max(_maxLines, linesOf(grid));
        for (int row = 0; row < tile.height(); ++row)
            lengths.at(static_cast<int>(i), row) =
                static_cast<float>(grid.stepLength(tile.eastSpacing(row), tile.northSpacing));
    }
    _stepLengths->set(createFloatTexture(lengths));
    for (GpuPass* sweep : _sweeps)
        sweep->setBlock(table);
}

Status HorizonNode::run(osg::State& state)
{
    aim();
    const int width = _surface->width();
    const int height = _surface->height();
    Status done = Nothing{};
    const int directions = static_cast<int>(_directions.size());
    const int batch = directionsPerDispatch(width, height, _scheme);
    for (GpuPass* sweep : _sweeps)
        for (int first = 0; done && first < directions; first += batch)
        {
            sweep->set("firstDirection", first);
            done = sweep->dispatch(state,
                                   {GpuPass::groupsFor(_maxLines / _scheme.linesAsked + 1, 32), 1,
                                    static_cast<unsigned>(std::min(batch, directions - first))});
        }
    for (std::size_t i = 0; done && i < _directions.size(); ++i)
    {
        const bool north = _directions[i].z() != 0.0f;
        _near->set("direction", _directions[i]);
        const int blocksX = north ? (width + 7) / 8 : width;
        const int blocksY = north ? height : (height + 7) / 8;
        done = _near->dispatch(
            state, {GpuPass::groupsFor(blocksX, 16), GpuPass::groupsFor(blocksY, 4), 1});
    }
    return done;
}

std::size_t HorizonNode::hullBytes(int width, int height, const HorizonScheme& scheme)
{
    // Most lines that a direction can have, the diagonal's, to whole groups.
    const int lines = scheme.linesPerPost * (width + height) / scheme.linesAsked + 32;
    return static_cast<std::size_t>(lines) * hullSize * 8;
}

int HorizonNode::directionsPerDispatch(int width, int height, const HorizonScheme& scheme)
{
    return static_cast<int>(
        std::max<std::size_t>(1, hullBudget / hullBytes(width, height, scheme)));
}

std::size_t HorizonNode::hullBytes(int width, int height, const HorizonScheme& scheme,
                                   int directionCount)
{
    const int atOnce = std::min(directionsPerDispatch(width, height, scheme), directionCount);
    return static_cast<std::size_t>(atOnce) * hullBytes(width, height, scheme);
}

std::size_t HorizonNode::workingBytes() const
{
    return hullBytes(_surface->width(), _surface->height(), _scheme, _horizon->layout().layers);
}

std::size_t HorizonNode::workingBytes(int width, int height, const HorizonScheme& scheme,
                                      int directionCount)
{
    const std::size_t stepLengths =
        sizeof(float) * static_cast<std::size_t>(directionCount) * static_cast<std::size_t>(height);
    return stepLengths + sizeof(std::uint32_t) + hullBytes(width, height, scheme, directionCount);
}

} // namespace osgTerrainLight
