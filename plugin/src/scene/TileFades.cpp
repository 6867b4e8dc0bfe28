#include "scene/TileFades.h"

#include <osgTerrain/Layer>
#include <osgTerrain/Locator>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
using Stage = TileState::Stage;

const osgTerrain::Locator& locatorOf(const SceneTile& tile)
{
    return *tile.terrain->getElevationLayer()->getLocator();
}

osg::Vec3d modelOf(const SceneTile& tile, double east, double north)
{
    osg::Vec3d model;
    locatorOf(tile).convertLocalToModel(osg::Vec3d(east, north, 0.0), model);
    return model;
}

std::array<osg::Vec3d, 3> cornersOf(const SceneTile& tile)
{
    if (!tile.terrain) // a host's, whose place stays
        return {osg::Vec3d(0.0, 0.0, 0.0), {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    return {modelOf(tile, 0.0, 0.0), modelOf(tile, 1.0, 0.0), modelOf(tile, 0.0, 1.0)};
}

/// Within a thousandth of the tile.
bool areSame(const std::array<osg::Vec3d, 3>& a, const std::array<osg::Vec3d, 3>& b)
{
    const double most = 1.0e-3 * (a[1] - a[0]).length();
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!((a[i] - b[i]).length() <= most))
            return false;
    return true;
}

/// From places on a tile to texture coordinates of its light.
osg::Matrixd toTexture(const SceneTile& tile)
{
    return tile.lit->fromDrawn() * texelCentres(*tile.lit->lighting().shading());
}

/// From places on a tile to those on another one, which covers it. None where the other does not
/// cover it, or the way is not affine to a hundredth of the other's size over its posts: then it
/// would show.
std::optional<osg::Matrixd> wayTo(const SceneTile& tile, const SceneTile& other)
{
    const osg::Matrixd change = tile.version.toScene * osg::Matrixd::inverse(other.version.toScene);
    const auto onOther = [&](double east, double north)
    {
        osg::Vec3d place;
        locatorOf(other).convertModelToLocal(modelOf(tile, east, north) * change, place);
        return place;
    };
    const osg::Vec3d corner = onOther(0.0, 0.0);
    const osg::Vec3d east = onOther(1.0, 0.0) - corner;
    const osg::Vec3d north = onOther(0.0, 1.0) - corner;
    const osg::Matrixd way(east.x(), east.y(), 0.0, 0.0, north.x(), north.y(), 0.0, 0.0, 0.0, 0.0,
                           1.0, 0.0, corner.x(), corner.y(), 0.0, 1.0);
    const double posts = std::max(other.lit->lighting().width(), other.lit->lighting().height());
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.5}})
    {
        const osg::Vec3d place = onOther(x, y);
        const osg::Vec3d found = osg::Vec3d(x, y, 0.0) * way;
        const bool inside =
            place.x() > -0.01 && place.y() > -0.01 && place.x() < 1.01 && place.y() < 1.01;
        if (!(inside && std::abs(found.x() - place.x()) * posts < 0.01 &&
              std::abs(found.y() - place.y()) * posts < 0.01))
            return std::nullopt;
    }
    return way;
}

/// Of the tile's own where that is there, else what it waits with.
std::optional<FormerLight> lightOf(const SceneTile& tile)
{
    if (!tile.lit || !tile.binding || !tile.lit->failure().empty())
        return std::nullopt;
    if (tile.lit->state().stage != Stage::Lit)
        return tile.former;
    FormerLight light;
    light.shading = tile.lit->lighting().shading();
    light.edges = tile.binding->edges();
    light.toTexture = toTexture(tile);
    light.contexts = tile.lit->litContexts();
    return light;
}

void end(SceneTile& tile)
{
    if (tile.binding)
        tile.binding->setFade(1.0);
    if (tile.lit)
        tile.lit->setFormer(std::nullopt);
    tile.former.reset();
}
} // namespace

void TileFades::keep(SceneTile& tile) const
{
    if (tile.lit)
        tile.former = lightOf(tile);
}

std::optional<FormerLight> TileFades::above(const SceneTile& tile) const
{
    for (TileHandle handle = tile.handle; handle.level > 0;)
    {
        handle = TileHandle::at(handle.level - 1, handle.x / 2, handle.y / 2);
        const SceneTile* other = _registry.find(handle);
        if (!other || !other->terrain)
            continue;
        // Of the two lights that a tile fades between the nearer one.
        const bool early = other->former && other->former->fading && part(*other) < 0.5;
        std::optional<FormerLight> light = early ? other->former : lightOf(*other);
        const std::optional<osg::Matrixd> way = light ? wayTo(tile, *other) : std::nullopt;
        if (!way)
            continue;
        light->toTexture = *way * light->toTexture;
        light->fading.reset();
        return light;
    }
    return std::nullopt;
}

void TileFades::begin(SceneTile& tile)
{
    const std::array<osg::Vec3d, 3> corners = cornersOf(tile);
    if (tile.former && !areSame(corners, tile.corners))
        tile.former.reset();
    tile.corners = corners;
    if (!tile.former && tile.terrain)
        tile.former = above(tile);
    if (!tile.former)
        return;
    // Who has put a texture there keeps it, and the tile is drawn unlit meanwhile.
    const osg::StateSet& stateSet = *tile.binding->stateSet();
    for (const unsigned unit : {ShadingTexture::formerUnit, ShadingTexture::formerEdgeUnit})
        if (unit == tile.binding->unit() || unit == _units.gloss ||
            stateSet.getTextureAttribute(unit, osg::StateAttribute::TEXTURE))
        {
            tile.former.reset();
            return;
        }
    tile.former->fading.reset();
    tile.binding->setFormer(*tile.former,
                            osg::Matrixd::inverse(toTexture(tile)) * tile.former->toTexture);
    tile.lit->setFormer(tile.former->contexts);
    if (std::find(_tiles.begin(), _tiles.end(), tile.handle) == _tiles.end())
        _tiles.push_back(tile.handle);
}

bool TileFades::follow(SceneTile& tile) const
{
    if (!tile.former || !tile.lit)
        return false; // bound again, it begins again
    FormerLight& former = *tile.former;
    LitTile& lit = *tile.lit;
    if (!lit.isFormerEverywhere() || !lit.failure().empty())
    {
        end(tile);
        return false;
    }
    const bool isLit = lit.state().stage == Stage::Lit;
    if (isLit != former.fading.has_value())
    {
        former.fading = isLit ? std::optional<double>(_now) : std::nullopt;
        tile.binding->setFade(0.0);
        lit.setFormer(former.contexts, isLit);
    }
    if (!isLit)
        return true;
    if (const double own = part(tile); own < 1.0)
        tile.binding->setFade(own);
    else
        end(tile);
    return tile.former.has_value();
}

double TileFades::part(const SceneTile& tile) const
{
    const double passed = _now - *tile.former->fading;
    return passed < seconds ? passed / seconds : 1.0;
}

/// By simulation time, so that a flight that is recorded with a fixed time per frame is the same
/// each time. Where that stands still, by reference time: else light would stay a former one.
void TileFades::advance(const osg::FrameStamp* stamp)
{
    if (!stamp)
    {
        _now += seconds;
        return;
    }
    const double simulation = stamp->getSimulationTime() - _simulation;
    const double reference = stamp->getReferenceTime() - _reference;
    _now += simulation > 0.0 ? simulation : std::max(reference, 0.0);
    _simulation = stamp->getSimulationTime();
    _reference = stamp->getReferenceTime();
}

void TileFades::update(const osg::FrameStamp* stamp)
{
    advance(stamp);
    _tiles.erase(std::remove_if(_tiles.begin(), _tiles.end(),
                                [this](const TileHandle& handle)
                                {
                                    SceneTile* tile = _registry.find(handle);
                                    return !tile || !follow(*tile);
                                }),
                 _tiles.end());
}

void TileFades::releaseGLObjects(osg::State* state) const
{
    for (const TileHandle& handle : _tiles)
        if (const SceneTile* tile = _registry.find(handle); tile && tile->former)
            for (const osg::Texture2D* texture :
                 {tile->former->shading.get(), tile->former->edges.get()})
                if (texture)
                    texture->releaseGLObjects(state);
}

} // namespace osgTerrainLight
