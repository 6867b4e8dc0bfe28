#include "scene/TileBinder.h"

#include "scene/DisplacedProgram.h"

#include <osg/Notify>

#include <utility>

namespace osgTerrainLight
{

void TileBinder::light(SceneTile& tile, LitTile* lit)
{
    tile.lit = lit;
    _scheduler->add(tile.lit);
}

osg::ref_ptr<osg::Program> TileBinder::programOf(const SceneTile& tile, bool wanted)
{
    if (!wanted)
        return nullptr;
    if (!_programs->get(false))
        _programs->create();
    return new TileProgram(_programs, _scheduler, tile.lit);
}

void TileBinder::bind(SceneTile& tile, osg::StateSet* stateSet,
                      const ShadingCoordinates& coordinates, osg::Program* program)
{
    tile.binding = std::make_shared<ShadingBinding>(stateSet, tile.lit->lighting().shading(),
                                                    units.shading, coordinates, program);
    followTextures(tile);
}

void TileBinder::bindHost(SceneTile& tile, const DemTile& dem, osg::StateSet* stateSet,
                          const ShadingCoordinates& coordinates, bool program)
{
    takeFrom(stateSet);
    light(tile, new LitTile("added tile", dem, _scheduler->light()));
    bind(tile, stateSet, coordinates, programOf(tile, program));
}

void TileBinder::bindPlaced(SceneTile& tile, const std::shared_ptr<const TileWindows>& windows)
{
    const HostGround& host = *tile.host;
    takeFrom(host.stateSet);
    const std::shared_ptr<const SceneLight> now = _scheduler->light();
    light(tile, windows ? new LitTile("added tile", windows, now)
                        : new LitTile("added tile", *host.ground.patch.dem, now));
    ShadingCoordinates onLit = host.coordinates;
    onLit.toTile = host.coordinates.toTile * tile.lit->fromDrawn();
    bind(tile, host.stateSet, onLit, programOf(tile, host.program));
}

void TileBinder::bindWaiting(SceneTile& tile)
{
    const HostGround& host = *tile.host;
    takeFrom(host.stateSet);
    tile.lit = new LitTile("added tile", *host.ground.patch.dem, _scheduler->light());
    bind(tile, host.stateSet, host.coordinates, programOf(tile, host.program));
}

void TileBinder::bindDynamic(SceneTile& tile, DynamicTerrain& terrain)
{
    osg::StateSet* stateSet = terrain.getOrCreateStateSet();
    takeFrom(stateSet);
    light(tile, new LitTile("dynamic terrain", terrain.getTile(), _scheduler->light()));
    const bool ours = dynamic_cast<const DisplacedProgram*>(
                          stateSet->getAttribute(osg::StateAttribute::PROGRAM)) != nullptr;
    const osg::ref_ptr<osg::Program> program =
        ours ? new DisplacedProgram(_programs, _scheduler, tile.lit) : nullptr;
    tile.dynamic = &terrain; // whose unit other textures must leave alone
    bind(tile, stateSet, {}, program);
    followHeights(tile);
}

void TileBinder::bindTerrain(SceneTile& tile, const TerrainHeights& heights,
                             const std::string& name, const ShadingCoordinates& coordinates,
                             bool program)
{
    const std::shared_ptr<const SceneLight> now = _scheduler->light();
    light(tile, heights.windows ? new LitTile(name, heights.windows, now, heights.turn)
                                : new LitTile(name, heights.dem, now));
    ShadingCoordinates onLit = coordinates;
    onLit.toTile = coordinates.toTile * tile.lit->fromDrawn();
    if (!tile.theirVariance)
        tile.ownStateSet = !tile.terrain->getStateSet();
    bind(tile, tile.terrain->getOrCreateStateSet(), onLit, programOf(tile, program));
    if (tile.theirVariance)
        tile.binding->setTheirVariance(*tile.theirVariance);
    tile.theirVariance.reset();
}

void TileBinder::release(SceneTile& tile)
{
    if (tile.lit)
    {
        _scheduler->remove(tile.lit);
        for (const StageCost& cost : tile.lit->lighting().costs())
            _pastDispatches[cost.name] += cost.dispatches;
    }
    if (tile.binding)
    {
        tile.binding->retire();
        _retired.push_back(
            {std::move(tile.binding),
             tile.ownStateSet ? tile.terrain : osg::ref_ptr<osgTerrain::TerrainTile>()});
    }
    tile.lit = nullptr;
    tile.binding = nullptr;
    tile.colours = {};
    tile.glossPicture = {};
    tile.problem.clear();
}

void TileBinder::retire()
{
    for (Retired& retired : _retired)
        --retired.updates;
    while (!_retired.empty() && _retired.front().updates <= 0)
    {
        take(_retired.front());
        _retired.pop_front();
    }
}

void TileBinder::take(Retired& retired)
{
    const osg::ref_ptr<osg::StateSet> stateSet = retired.binding->stateSet();
    retired.binding.reset();
    const osg::ref_ptr<osg::StateSet> empty = new osg::StateSet;
    if (retired.emptied && retired.emptied->getStateSet() == stateSet &&
        stateSet->compare(*empty, true) == 0)
        retired.emptied->setStateSet(nullptr);
}

void TileBinder::takeFrom(const osg::StateSet* stateSet)
{
    for (auto i = _retired.begin(); stateSet && i != _retired.end();)
        if (i->binding->stateSet() == stateSet)
        {
            take(*i);
            i = _retired.erase(i);
        }
        else
            ++i;
    ShadingBinding* others = ShadingBinding::on(stateSet);
    if (others && others->isRetired())
        others->takeOff();
}

void TileBinder::followTextures(SceneTile& tile)
{
    if (!tile.binding)
        return;
    followEdges(tile);
    followGloss(tile);
    followObjects(tile);
}

void TileBinder::followEdges(SceneTile& tile)
{
    const osg::ref_ptr<osg::Texture2D> edges = tile.lit->lighting().shadowEdges();
    const unsigned unit = ShadingTexture::edgeUnit;
    if (edges && (unit == tile.binding->unit() || unit == units.gloss ||
                  (tile.dynamic && tile.dynamic->getHeightUnit() == unit)))
    {
        tile.binding->setEdges(nullptr);
        OSG_WARN << "osgTerrainLight: " << tile.lit->name()
                 << ": drawn without edges of shadows: texture unit " << unit
                 << ", theirs, is that of the shading, of gloss or of heights" << std::endl;
        return;
    }
    if (edges == tile.binding->edges())
        return;
    tile.binding->setEdges(edges);
    if (edges)
    {
        tile.lit->forget(~0u);
        _scheduler->touch();
    }
}

void TileBinder::followObjects(SceneTile& tile)
{
    const auto drawn = tile.lit->lighting().drawnObjects(tile.lit->litContexts());
    if (!drawn)
        return;
    osg::ref_ptr<osg::Texture2D> factor = drawn->factor;
    const unsigned unit = ShadingTexture::objectsUnit;
    if (factor && (unit == tile.binding->unit() || unit == units.gloss ||
                   (tile.dynamic && tile.dynamic->getHeightUnit() == unit)))
    {
        factor = nullptr;
        if (!std::exchange(tile.saidObjects, true))
            OSG_WARN << "osgTerrainLight: " << tile.lit->name()
                     << ": drawn without what objects do to its light: texture unit " << unit
                     << ", theirs, is that of the shading, of gloss or of heights" << std::endl;
    }
    tile.binding->setObjects(factor, drawn->objects);
}

void TileBinder::followGloss(SceneTile& tile)
{
    const osg::ref_ptr<osg::Texture2DArray> light = tile.lit->lighting().glossLight();
    if (light == tile.binding->gloss())
        return;
    if (tile.dynamic && tile.dynamic->getHeightUnit() == units.gloss) // moved there meanwhile
    {
        OSG_WARN << "osgTerrainLight: dynamic terrain is drawn without gloss: its heights are in "
                    "texture unit "
                 << units.gloss << ", that of gloss" << std::endl;
        return;
    }
    tile.binding->setGloss(light, units.gloss);
    tile.lit->glossy = light.valid();
    if (light)
    {
        tile.lit->forget(~0u);
        _scheduler->touch();
    }
}

void TileBinder::followHeights(SceneTile& tile)
{
    const DynamicTerrain& terrain = *tile.dynamic;
    tile.binding->setHasColour(terrain.getStateSet() && terrain.getStateSet()->getTextureAttribute(
                                                            0, osg::StateAttribute::TEXTURE));
    if (terrain.getHeightRevision() == tile.heightRevision)
        return;
    tile.heightRevision = terrain.getHeightRevision();
    if (tile.heights == terrain.getHeightTexture())
        tile.lit->lighting().touchHeights();
    else
        tile.lit->lighting().setHeightTexture(terrain.getHeightTexture());
    tile.heights = terrain.getHeightTexture();
    _scheduler->touch();
}

} // namespace osgTerrainLight
