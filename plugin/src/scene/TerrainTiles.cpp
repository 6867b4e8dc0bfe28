#include "scene/TerrainTiles.h"

#include <osg/Notify>
#include <osgTerrain/GeometryTechnique>

#include <algorithm>
#include <chrono>
#include <utility>

namespace osgTerrainLight
{

namespace
{
std::string nameOf(const osgTerrain::TerrainTile& tile)
{
    const osgTerrain::TileID& id = tile.getTileID();
    if (!tile.getName().empty())
        return "terrain tile \"" + tile.getName() + "\"";
    if (!id.valid())
        return "terrain tile";
    return "terrain tile " + std::to_string(id.level) + "/" + std::to_string(id.x) + "/" +
           std::to_string(id.y);
}

TileVersion versionOf(const osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene)
{
    const osgTerrain::Layer* layer = tile.getElevationLayer();
    return {layer, layer ? layer->getModifiedCount() : 0,
            tile.getTerrain() ? tile.getTerrain()->getVerticalScale() : 1.0f, toScene};
}

/// Collects what a tile draws.
class PartFinder : public osg::NodeVisitor
{
public:
    explicit PartFinder(const FoundTile& found) : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN)
    {
        setNodeMaskOverride(~0u);
        for (osg::Node* node : found.above) // at its first traversal a tile looks for its Terrain
            pushOntoNodePath(node);
        _depth = getNodePath().size() + 1;
        found.tile->accept(*this); // the technique makes its geometry at the first traversal
    }

    std::vector<TilePart> parts;

    void apply(osg::Drawable& drawable) override
    {
        const osg::NodePath& path = getNodePath();
        const osg::NodePath below(path.begin() + static_cast<std::ptrdiff_t>(_depth), path.end());
        if (drawable.asGeometry())
            parts.push_back({drawable.asGeometry(), osg::computeLocalToWorld(below)});
    }

private:
    std::size_t _depth = 0;
};
} // namespace

void TerrainTiles::came(const FoundTile& found)
{
    settle();
    if (_registry.isTaken(found.tile->getStateSet()))
        return; // the host takes care of it
    // No other tile has it: hosts are not given a name that is promised to a terrain tile.
    const TileHandle handle = _registry.handleOf(*found.tile);
    SceneTile& tile = _registry.add(handle);
    tile.terrain = found.tile;
    tile.isNew = true;
    fades.place(tile, found.above);
    _tiles.push_back(handle);
    _new.push_back(handle);
}

/// Tiles that came are lit once all of them are known to one another. Those whose surroundings take
/// longer to read than the budget of a frame wait for the next one.
void TerrainTiles::begin(const TileFinder& finder)
{
    _reading = 0.0;
    for (const TileHandle& handle : std::exchange(_new, {}))
    {
        _came.push_back(handle);
        const SceneTile* tile = _registry.find(handle);
        const auto found = tile ? finder.find(tile->terrain.get()) : std::optional<FoundTile>();
        if (!found)
            continue;
        if (const auto heights = readTerrainTile(*tile->terrain, found->toScene))
            if (const auto ground = placeTerrainTile(*tile->terrain, found->toScene, heights->dem))
                _neighbours.set(handle, *ground);
    }
    while (!_came.empty() && hasTime())
    {
        SceneTile* tile = _registry.find(_came.front());
        _came.pop_front();
        if (tile && std::exchange(tile->isNew, false))
            if (const std::optional<FoundTile> found = finder.find(tile->terrain.get()))
                use(*tile, *found, true);
    }
}

bool TerrainTiles::hasTime() const
{
    const double budget = _scheduler->budget;
    return budget <= 0.0 || _reading < budget;
}

/// One tile that sees other ground now is lit again per update, from heights that are known.
void TerrainTiles::relight(const TileFinder& finder)
{
    if (!hasTime())
        return;
    const std::optional<TileHandle> stale = _neighbours.takeStale();
    SceneTile* tile = stale ? _registry.find(*stale) : nullptr;
    if (!tile || !tile->lit) // what is not lit yet will see what is there then
        return;
    if (const std::optional<FoundTile> found = finder.find(tile->terrain.get()))
        use(*tile, *found, true);
}

void TerrainTiles::changed(const FoundTile& found)
{
    settle();
    SceneTile* tile = _registry.find(_registry.handleOf(*found.tile));
    if (tile && tile->terrain == found.tile)
        fades.place(*tile, found.above);
    if (tile && tile->terrain == found.tile && !tile->isNew)
        use(*tile, found, false);
    else if (!tile)
        came(found);
}

void TerrainTiles::went(osgTerrain::TerrainTile& terrain)
{
    settle();
    const TileHandle handle = _registry.handleOf(terrain);
    SceneTile* tile = _registry.find(handle);
    if (!tile || tile->terrain != &terrain)
        return;
    undoWait(*tile);
    _binder.release(*tile);
    _neighbours.remove(handle);
    _registry.remove(handle);
    fades.follow(handle);
    _tiles.erase(std::find(_tiles.begin(), _tiles.end(), handle));
}

void TerrainTiles::update(const TileFinder& finder, unsigned updatesBelow)
{
    if (updatesBelow != _updatesBelow)
        _settling = std::max(_settling, 2); // it may look at geometry that is swapped a frame later
    _updatesBelow = updatesBelow;
    begin(finder);
    const bool all = _settling > 0;
    _settling = std::max(_settling - 1, 0);
    const std::size_t looks = all ? _tiles.size() : std::min(looksPerUpdate, _tiles.size());
    for (std::size_t i = 0; i < looks; ++i)
    {
        _next = (_next + 1) % _tiles.size();
        if (SceneTile* tile = _registry.find(_tiles[_next]))
            look(*tile, finder);
    }
    relight(finder);
    _searched = true;
}

void TerrainTiles::look(SceneTile& tile, const TileFinder& finder)
{
    if (tile.isNew || std::exchange(tile.waitsForNext, false))
        return;
    const osgTerrain::TerrainTile& terrain = *tile.terrain;
    if (tile.withoutGeometry || !(versionOf(terrain, tile.version.toScene) == tile.version))
        if (const std::optional<FoundTile> found = finder.find(&terrain))
            use(tile, *found, false);
    if (!tile.lit)
        return;
    LitTile& lit = *tile.lit;
    if (lit.needsOtherMargin(_scheduler->light()->settings))
    {
        if (const std::optional<FoundTile> found = finder.find(&terrain))
            use(tile, *found, true);
        return;
    }
    if (tile.binding)
        tile.binding->setHasColour(hasColour(terrain));
    const int width = lit.drawnWidth();
    const int height = lit.drawnHeight();
    if (tile.glossPicture.follow(pictureOf(terrain, glossLayer)))
    {
        lit.lighting().setGloss(
            lit.withMargin(readTerrainGloss(terrain, glossLayer, width, height)));
        _scheduler->touch();
    }
    if (albedoNeeded && tile.colours.follow(pictureOf(terrain, 0)))
    {
        lit.lighting().setAlbedo(lit.withMargin(readTerrainAlbedo(terrain, width, height)));
        _scheduler->touch();
    }
    if (tile.binding && tile.byTexCoord) // the technique makes new geometry for new neighbours
        if (const std::optional<FoundTile> found = finder.find(&terrain))
            addTileCoordinates(terrain, PartFinder(*found).parts);
}

/// True where the tile may have been drawn by threads that are still reading what binding it
/// changes. It then is DYNAMIC from the next frame on: updates wait for that to be drawn.
bool TerrainTiles::waits(SceneTile& tile, const std::vector<TilePart>& parts, bool fresh)
{
    osgTerrain::TerrainTile& terrain = *tile.terrain;
    const osg::StateSet* stateSet = terrain.getStateSet();
    // What comes below a node that has searched before is new to the scene.
    if ((_searched && fresh) || (stateSet && stateSet->getDataVariance() == osg::Object::DYNAMIC))
        return false;
    const bool coordinates =
        std::any_of(parts.begin(), parts.end(),
                    [](const TilePart& part)
                    { return !part.geometry->getTexCoordArray(ShadingTexture::coordinateSet); });
    if (!stateSet && (!coordinates || affineCoordinates(terrain, parts)))
        return false;
    tile.ownStateSet = !stateSet;
    tile.theirVariance = terrain.getOrCreateStateSet()->getDataVariance();
    terrain.getStateSet()->setDataVariance(osg::Object::DYNAMIC);
    return true;
}

/// False where another TerrainLighting lights this node. Where it only has the StateSet of a node
/// that this one is a copy of, the node gets a StateSet of its own.
bool TerrainTiles::isFree(SceneTile& tile)
{
    osgTerrain::TerrainTile& terrain = *tile.terrain;
    const osg::StateSet* stateSet = terrain.getStateSet();
    const ShadingBinding* other = ShadingBinding::on(stateSet);
    const bool isNodes = other && other != tile.binding.get() && !other->isRetired() &&
                         other->stateSet() == stateSet && stateSet->getNumParents() < 2;
    if (isNodes)
    {
        if (tile.lit)
            _binder.release(tile);
        tile.former.reset();
        // At the first look that one may not know yet that the node has moved.
        if (!std::exchange(tile.foundTaken, true))
        {
            settle();
            tile.waitsForNext = true;
        }
        else if (tile.problem.empty())
        {
            tile.theirVariance.reset();
            fail(tile, "another TerrainLighting lights it: needs a copy of the node for each");
        }
        return false;
    }
    tile.foundTaken = false;
    if (other && other != tile.binding.get() &&
        (other->stateSet() != stateSet || !other->isRetired()))
    {
        const osg::ref_ptr<osg::StateSet> own = other->without(*stateSet);
        const osg::ref_ptr<osg::StateSet> empty = new osg::StateSet;
        terrain.setStateSet(own->compare(*empty, true) == 0 ? nullptr : own.get());
    }
    return true;
}

void TerrainTiles::undoWait(SceneTile& tile)
{
    if (tile.theirVariance && tile.ownStateSet)
        tile.terrain->setStateSet(nullptr);
    else if (tile.theirVariance && tile.terrain->getStateSet())
        tile.terrain->getStateSet()->setDataVariance(*tile.theirVariance);
    tile.theirVariance.reset();
}

void TerrainTiles::fail(SceneTile& tile, const std::string& problem)
{
    if (!problem.empty())
        OSG_WARN << "osgTerrainLight: " << nameOf(*tile.terrain) << " is drawn unlit: " << problem
                 << std::endl;
    tile.problem = problem;
    tile.former.reset();
    _neighbours.remove(tile.handle);
    undoWait(tile);
}

void TerrainTiles::surround(SceneTile& tile, const FoundTile& found, TerrainHeights& heights)
{
    const std::optional<PlacedGround> ground =
        placeTerrainTile(*tile.terrain, found.toScene, heights.dem);
    if (!ground)
        return;
    _neighbours.set(tile.handle, *ground);
    const auto start = std::chrono::steady_clock::now();
    heights.windows = _neighbours.around(tile.handle, _scheduler->light()->settings.quality);
    if (heights.windows)
        _reading +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count();
}

void TerrainTiles::use(SceneTile& tile, const FoundTile& found, bool fresh)
{
    osgTerrain::TerrainTile& terrain = *tile.terrain;
    const TileVersion version = versionOf(terrain, found.toScene);
    const osg::BoundingSphere bound = inFrame(terrain.getBound(), found.toScene);
    if (tile.lit)
        tile.lit->setBound(bound);
    const bool same = !fresh && tile.version == version;
    if (same && !tile.withoutGeometry)
        return;
    if (!isFree(tile))
    {
        tile.version = {}; // not as it is: the next look comes here again
        tile.version.toScene = found.toScene;
        return;
    }
    const std::vector<TilePart> parts = PartFinder(found).parts;
    if (same && parts.empty())
        return;
    fades.keep(tile);
    _binder.release(tile);
    tile.withoutGeometry = false;
    tile.version = {};
    tile.version.toScene = found.toScene;
    if (version.layer && waits(tile, parts, fresh))
    {
        settle(); // its version is not this one: the next update comes here again
        tile.waitsForNext = true;
        return;
    }
    _binder.takeFrom(terrain.getStateSet());
    tile.version = version;
    if (!version.layer)
        return fail(tile, ""); // may come later
    Result<TerrainHeights> heights = readTerrainTile(terrain, found.toScene);
    if (!heights)
        return fail(tile, heights.error().message);
    tile.corner = cornerOf(terrain, found.toScene, heights->dem);
    if (tile.corner)
        tile.spacing = drawnSpacing(terrain, found.toScene, heights->dem);
    surround(tile, found, *heights);
    std::optional<ShadingCoordinates> coordinates = affineCoordinates(terrain, parts);
    tile.withoutGeometry = parts.empty();
    tile.byTexCoord = !coordinates;
    if (!coordinates)
    {
        addTileCoordinates(terrain, parts);
        coordinates = ShadingCoordinates();
    }
    coordinates->frame = tileFrame(terrain, parts);
    // Other techniques move vertices in shaders of their own.
    const bool stock = dynamic_cast<const osgTerrain::GeometryTechnique*>(
                           terrain.getTerrainTechnique()) != nullptr;
    _binder.bindTerrain(tile, *heights, nameOf(terrain), *coordinates,
                        defaultProgram && stock && !found.hasProgram);
    fades.begin(tile);
    tile.binding->setHasColour(hasColour(terrain));
    tile.lit->setBound(bound);
}

} // namespace osgTerrainLight
