#include "lighting/nodes/HorizonPass.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/GridDirection.h"

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

HorizonPass::HorizonPass(const DemTile& tile, osg::Texture2D* heights, const HorizonScheme& scheme,
                         int directionCount)
    : _width(tile.width()), _height(tile.height()), _northSpacing(tile.northSpacing),
      _eastSpacings(tile.eastSpacings), _nominalEastSpacing(tile.nominalEastSpacing()),
      _scheme(scheme), _near(new GpuPass("horizon_near"))
{
    assert(scheme.reach + 20 <= frame);
    for (int parity = 0; parity < scheme.linesAsked; ++parity)
    {
        std::vector<std::string> defines = {"HULL_SIZE " + std::to_string(hullSize),
                                            "ASKED " + std::to_string(scheme.linesAsked),
                                            "PARITY " + std::to_string(parity)};
        if (scheme.linesPerPost > 1)
            defines.push_back("DENSE");
        _sweeps.push_back(new GpuPass("horizon_sweep", defines));
    }
    _stepLengths = createFloatTexture(Raster<float>(directionCount, _height, 1.0f));
    _horizon = createLayeredTarget(_width, _height, directionCount, GL_R16);
    _dropped = createTarget(1, 1, GL_R32UI);
    std::vector<osg::ref_ptr<GpuPass>> passes = _sweeps;
    passes.push_back(_near);
    for (const auto& pass : passes)
    {
        pass->reads("heights", heights);
        pass->reads("stepLengths", _stepLengths);
        pass->set("size", _width, _height);
        pass->set("frame", int(frame));
        pass->set("reach", scheme.reach);
    }
    for (const auto& sweep : _sweeps)
    {
        sweep->set("linesPerPost", scheme.linesPerPost);
        sweep->writes(0, _horizon, GpuPass::Access::ReadWrite);
        sweep->writes(1, _dropped, GpuPass::Access::ReadWrite);
    }
    _near->writes(0, _horizon, GpuPass::Access::ReadWrite);
}

void HorizonPass::setDirections(const std::vector<MapDirection>& directions)
{
    assert(static_cast<int>(directions.size()) == _horizon->getTextureDepth());
    _directions.clear();
    _maxLines = 0;
    Raster<float> lengths(static_cast<int>(directions.size()), _height);
    std::vector<osg::Vec4f> table(256);
    for (std::size_t i = 0; i < directions.size(); ++i)
    {
        const GridDirection grid(_nominalEastSpacing, _northSpacing, directions[i]);
        const osg::Vec4f row(static_cast<float>(grid.drift), static_cast<float>(grid.look),
                             grid.north ? 1.0f : 0.0f, static_cast<float>(i));
        _directions.push_back(row);
        table[i] = row;

        const int steps = grid.north ? _height : _width;
        const int breadth = grid.north ? _width : _height;
        const double lines = _scheme.linesPerPost * (breadth + std::abs(grid.drift) * steps);
        _maxLines = std::max(_maxLines, 2 + static_cast<int>(lines));
        for (int row_ = 0; row_ < _height; ++row_)
        {
            const double east = _eastSpacings.size() == 1
                                    ? _eastSpacings.front()
                                    : _eastSpacings[static_cast<std::size_t>(row_)];
            lengths.at(static_cast<int>(i), row_) =
                static_cast<float>(grid.stepLength(east, _northSpacing));
        }
    }
    _stepLengths = createFloatTexture(lengths);
    for (const auto& sweep : _sweeps)
    {
        sweep->reads("stepLengths", _stepLengths);
        sweep->setBlock(table);
    }
    _near->reads("stepLengths", _stepLengths);
}

Status HorizonPass::dispatch(osg::State& state)
{
    assert(!_directions.empty());
    Status done = Nothing{};
    const int directions = static_cast<int>(_directions.size());
    const int batch = directionsPerDispatch(_width, _height, _scheme);
    for (const auto& sweep : _sweeps)
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
        const int blocksX = north ? (_width + 7) / 8 : _width;
        const int blocksY = north ? _height : (_height + 7) / 8;
        done = _near->dispatch(
            state, {GpuPass::groupsFor(blocksX, 16), GpuPass::groupsFor(blocksY, 4), 1});
    }
    return done;
}

std::size_t HorizonPass::hullBytes(int width, int height, const HorizonScheme& scheme)
{
    // Most lines that a direction can have, the diagonal's, to whole groups.
    const int lines = scheme.linesPerPost * (width + height) / scheme.linesAsked + 32;
    return static_cast<std::size_t>(lines) * hullSize * 8;
}

int HorizonPass::directionsPerDispatch(int width, int height, const HorizonScheme& scheme)
{
    return static_cast<int>(
        std::max<std::size_t>(1, hullBudget / hullBytes(width, height, scheme)));
}

std::size_t HorizonPass::workingBytes(int width, int height, const HorizonScheme& scheme,
                                      int directionCount)
{
    const int atOnce = std::min(directionsPerDispatch(width, height, scheme), directionCount);
    const std::size_t stepLengths =
        sizeof(float) * static_cast<std::size_t>(directionCount) * static_cast<std::size_t>(height);
    return stepLengths + sizeof(std::uint32_t) +
           static_cast<std::size_t>(atOnce) * hullBytes(width, height, scheme);
}

void HorizonPass::releaseGLObjects(osg::State* state) const
{
    for (const auto& sweep : _sweeps)
        sweep->releaseGLObjects(state);
    _near->releaseGLObjects(state);
    for (const osg::Texture* texture :
         {static_cast<osg::Texture*>(_stepLengths), static_cast<osg::Texture*>(_horizon),
          static_cast<osg::Texture*>(_dropped)})
        texture->releaseGLObjects(state);
}

void HorizonPass::resizeGLObjectBuffers(unsigned size)
{
    for (const auto& sweep : _sweeps)
        sweep->resizeGLObjectBuffers(size);
    _near->resizeGLObjectBuffers(size);
    _stepLengths->resizeGLObjectBuffers(size);
    _horizon->resizeGLObjectBuffers(size);
    _dropped->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
