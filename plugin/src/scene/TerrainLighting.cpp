#include <osgTerrainLight/TerrainLighting.h>

#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/LightProbe.h>
#include <osgTerrainLight/PlacedObject.h>

#include "core/SettingsTable.h"
#include "gpu/ShaderLibrary.h"
#include "scene/ComputeNode.h"
#include "scene/HostTiles.h"
#include "scene/ObjectRegistry.h"
#include "scene/ProbeList.h"
#include "scene/SceneUniforms.h"
#include "scene/TerrainTiles.h"
#include "scene/TileValues.h"

#include <osg/Notify>
#include <osgUtil/CullVisitor>

#include <cmath>
#include <set>

namespace osgTerrainLight
{

namespace
{
void warn(const std::string& sentence)
{
    OSG_WARN << "osgTerrainLight: " << sentence << std::endl;
}

/// Where what has the StateSet is drawn, in the frame of the root; invalid where it is not below.
osg::BoundingSphere boundOf(const osg::StateSet& stateSet, osg::Group& root)
{
    for (unsigned i = 0; i < stateSet.getNumParents(); ++i)
        if (const osg::Node* node = stateSet.getParent(i)->asNode())
            for (const osg::NodePath& path : node->getParentalNodePaths(&root))
                if (path.size() > 1 && path.front() == &root)
                {
                    const osg::NodePath above(path.begin() + 1, path.end() - 1);
                    return inFrame(node->getBound(), osg::computeLocalToWorld(above));
                }
    return {};
}
} // namespace

struct TerrainLighting::Implementation
{
    explicit Implementation(TerrainLighting& node)
        : owner(node), scheduler(new Scheduler), programs(new TilePrograms),
          compute(new ComputeNode(scheduler)), binder(scheduler, programs),
          terrain(registry, binder, scheduler), placed(registry, binder, terrain.fades, scheduler)
    {
    }

    void update(unsigned updatesBelow, const osg::FrameStamp* stamp);
    void followShaders();
    void followObjects();
    void applyUniforms();
    /// Whether some of the ground may be glossy.
    bool mayBeGlossy() const;
    /// After a change of that, of settings or of light: warns of what does not do all that it
    /// seems to ask for, each once as long as it holds.
    void tellProblems();
    /// Empty where gloss may be switched on, else why not.
    std::string glossProblem() const
    {
        return binder.units.glossProblem(binder.units.gloss, registry);
    }
    /// Why a tile may not be added; empty where it may.
    std::string tileProblem(const DemTile& dem, osg::StateSet* stateSet,
                            const TileHandle& name) const;
    /// A tile that a host has added; null where the handle is no such tile's.
    SceneTile* hosts(const TileHandle& handle) const
    {
        SceneTile* tile = registry.find(handle);
        return tile && !tile->terrain ? tile : nullptr;
    }
    template <class F>
    void forEachLit(F&& f) const
    {
        registry.forEach(
            [&](const SceneTile& tile)
            {
                if (tile.lit)
                    f(*tile.lit);
            });
    }

    TerrainLighting& owner;
    SkyLight sky;
    std::optional<EarthPlace> place;
    std::optional<UtcTime> time;
    LightingSettings settings;
    std::set<std::string> told; ///< settings whose problems have been said and still hold

    osg::ref_ptr<Scheduler> scheduler;
    osg::ref_ptr<TilePrograms> programs;
    osg::ref_ptr<ComputeNode> compute;
    TileRegistry registry;
    TileBinder binder;
    TerrainTiles terrain;
    HostTiles placed; ///< those of a host whose place on the map is known
    TileFinder finder;
    ProbeList probes;
    ObjectRegistry objects;
    SceneUniforms uniforms; ///< on all below
    long long shaders = ShaderLibrary::instance().revision();
    unsigned textureRevision = 0; ///< of the scheduler, when bindings followed it
};

/// In update traversal, after the children. What is done where nothing has changed does not grow
/// with the number of tiles, but with that of dynamic terrains and of probes.
void TerrainLighting::Implementation::update(unsigned updatesBelow, const osg::FrameStamp* stamp)
{
    binder.retire();
    followShaders();
    owner.getBound();
    finder.follow(owner, terrain);
    terrain.albedoNeeded = settings.bounces > 0 || !probes.empty();
    terrain.update(finder, updatesBelow);
    placed.update();
    scheduler->tellAlone();
    for (SceneTile* tile : registry.dynamic())
        binder.followHeights(*tile);
    if (textureRevision != scheduler->textureRevision())
    {
        textureRevision = scheduler->textureRevision();
        registry.forEach([this](SceneTile& tile) { binder.followTextures(tile); });
    }
    terrain.fades.update(stamp, scheduler->enabled);
    followObjects();
    if (probes.follow(registry))
        scheduler->touch();
    if (!scheduler->isDone())
        registry.forEach(
            [this](const SceneTile& tile)
            {
                if (tile.binding && !tile.terrain)
                    tile.lit->setBound(boundOf(*tile.binding->stateSet(), owner));
            });
}

void TerrainLighting::Implementation::followObjects()
{
    ObjectState& state = objects.surfaces().state();
    state.scene = uniforms.stateSet();
    state.lit = scheduler->enabled;
    state.defaultProgram = terrain.defaultProgram;
    state.set(sky.sunAngularRadius, settings.objectCones);
    const bool none = probes.empty();
    if (objects.follow(scheduler->objects(), registry, probes, owner, sky))
        scheduler->touch();
    if (none != probes.empty())
        terrain.settle(); // their light needs the tiles' albedo
}

/// Takes up edits in the folder of shaders that replace ours, if there is one.
void TerrainLighting::Implementation::followShaders()
{
    const long long now = ShaderLibrary::instance().revision();
    if (now == shaders)
        return;
    shaders = now;
    if (programs->get(false))
        programs->create();
    forEachLit(
        [](LitTile& tile)
        {
            tile.lighting().recompute();
            tile.retry();
        });
    scheduler->touch();
}

bool TerrainLighting::Implementation::mayBeGlossy() const
{
    bool some = settings.gloss > 0.0 || terrain.glossLayer >= 0;
    registry.forEach([&](const SceneTile& tile) { some = some || tile.hasGloss; });
    return some;
}

void TerrainLighting::Implementation::tellProblems()
{
    const bool glossy = mayBeGlossy();
    std::set<std::string> now;
    const auto tell = [&](const std::string& setting, const std::string& sentence)
    {
        if (now.insert(setting).second && told.count(setting) == 0)
            warn(sentence);
    };
    for (const SettingsProblem& problem : problems(settings, sky))
        tell(problem.setting, problem.sentence);
    if (glossy) // of tiles or a layer
        for (const IdleSetting& idle : idleSettings(settings))
            if (idle.name == "gloss")
                tell(idle.name, idle.sentence);
    told = std::move(now);
    if (glossy != uniforms.isGlossy())
        applyUniforms();
}

std::string TerrainLighting::Implementation::tileProblem(const DemTile& dem,
                                                         osg::StateSet* stateSet,
                                                         const TileHandle& name) const
{
    if (const std::string problem = dem.complaint(); !problem.empty())
        return problem;
    if (!stateSet)
        return "needs a StateSet";
    const ShadingBinding* bound = ShadingBinding::on(stateSet);
    if (registry.isTaken(stateSet) ||
        (bound && bound->stateSet() == stateSet && !bound->isRetired()))
        return "its StateSet is another tile's: needs one of its own";
    if (name.valid() && (name.level < 0 || registry.find(name) || registry.isPromised(name)))
        return "its name is another tile's, or has no level: needs a level, x and y that no other "
               "tile has";
    return {};
}

void TerrainLighting::Implementation::applyUniforms()
{
    uniforms.set(sky, settings.exposure, binder.units.gloss, mayBeGlossy());
}

TerrainLighting::TerrainLighting() : _implementation(new Implementation(*this))
{
    setNumChildrenRequiringUpdateTraversal(1);
    _implementation->applyUniforms();
}

TerrainLighting::TerrainLighting(const TerrainLighting& other, const osg::CopyOp& copyop)
    : osg::Group(other, copyop), _implementation(new Implementation(*this))
{
    setNumChildrenRequiringUpdateTraversal(getNumChildrenRequiringUpdateTraversal() + 1);
    Implementation& here = *_implementation;
    const Implementation& there = *other._implementation;
    here.sky = there.sky;
    here.place = there.place;
    here.time = there.time;
    here.settings = there.settings;
    here.scheduler->setSky(here.sky);
    here.scheduler->setSettings(here.settings);
    here.scheduler->enabled = there.scheduler->enabled.load();
    here.scheduler->budget = there.scheduler->budget.load();
    here.binder.units = there.binder.units;
    here.terrain.glossLayer = there.terrain.glossLayer;
    here.terrain.fades.seconds = there.terrain.fades.seconds;
    here.terrain.defaultProgram = there.terrain.defaultProgram;
    here.told = there.told;
    here.applyUniforms();
}

TerrainLighting::~TerrainLighting() = default;

void TerrainLighting::setSkyLight(const SkyLight& sky)
{
    Implementation& here = *_implementation;
    const std::string problem = complaint(sky);
    if (!problem.empty())
        warn("sky light not set: " + problem);
    if (!problem.empty() || sky == here.sky)
        return;
    if (sky.sunAzimuth != here.sky.sunAzimuth || sky.sunElevation != here.sky.sunElevation)
        here.time.reset();
    here.sky = sky;
    here.tellProblems();
    here.applyUniforms();
    here.scheduler->setSky(sky);
}

const SkyLight& TerrainLighting::getSkyLight() const
{
    return _implementation->sky;
}

void TerrainLighting::setPlace(const EarthPlace& place)
{
    const std::string problem = place.complaint();
    if (!problem.empty())
        warn("place not set: " + problem);
    else
        _implementation->place = place;
    if (problem.empty() && _implementation->time)
        setTime(*_implementation->time);
}

const std::optional<EarthPlace>& TerrainLighting::getPlace() const
{
    return _implementation->place;
}

void TerrainLighting::setTime(UtcTime time)
{
    Implementation& here = *_implementation;
    UtcTime same;
    std::string problem = readUtcTime(toString(time), same);
    if (!here.place)
        problem = "the terrain's place on Earth is not known: needs setPlace() (reader option "
                  "place=LONGITUDE,LATITUDE)";
    else if (here.sky.environment)
        problem = "the sun is that of " + here.sky.environment->name + ", which no time moves";
    if (!problem.empty())
    {
        warn("time not set: " + problem);
        return;
    }
    SkyLight sky = here.sky;
    sky.setSunAt(time, *here.place);
    setSkyLight(sky);
    here.time = time;
}

const std::optional<UtcTime>& TerrainLighting::getTime() const
{
    return _implementation->time;
}

void TerrainLighting::setSettings(const LightingSettings& settings)
{
    Implementation& here = *_implementation;
    std::string problem = complaint(settings);
    if (problem.empty() && settings.gloss > 0.0)
        problem = here.glossProblem();
    if (!problem.empty())
    {
        warn("settings not set: " + problem);
        return;
    }
    const bool brightness = settings.exposure != here.settings.exposure;
    here.settings = settings;
    here.tellProblems();
    if (brightness)
        here.applyUniforms();
    here.forEachLit([](LitTile& tile) { tile.retry(); });
    here.terrain.settle(); // albedo may be needed now
    here.scheduler->setSettings(settings);
}

const LightingSettings& TerrainLighting::getSettings() const
{
    return _implementation->settings;
}

void TerrainLighting::setTextureUnit(unsigned unit)
{
    Implementation& here = *_implementation;
    std::string problem;
    if (unit > TileUnits::last)
        problem = std::to_string(unit) + ": needs 0 ... " + std::to_string(TileUnits::last);
    else if (unit == here.binder.units.gloss && here.mayBeGlossy())
        problem = "gloss needs " + std::to_string(unit);
    if (problem.empty())
        here.binder.units.shading = unit;
    else
        warn("texture unit not set: " + problem);
}

unsigned TerrainLighting::getTextureUnit() const
{
    return _implementation->binder.units.shading;
}

void TerrainLighting::setGlossUnit(unsigned unit)
{
    Implementation& here = *_implementation;
    if (unit == here.binder.units.gloss)
        return;
    std::string problem = here.binder.units.glossProblem(unit, here.registry);
    if (unit > TileUnits::last)
        problem = std::to_string(unit) + ": needs 0 ... " + std::to_string(TileUnits::last);
    else if (here.mayBeGlossy())
        problem = "some of the ground may be glossy already";
    if (!problem.empty())
    {
        warn("gloss unit not set: " + problem);
        return;
    }
    here.binder.units.gloss = unit;
    here.applyUniforms();
}

unsigned TerrainLighting::getGlossUnit() const
{
    return _implementation->binder.units.gloss;
}

void TerrainLighting::setGlossLayer(int layer)
{
    Implementation& here = *_implementation;
    std::string problem = layer < 0 ? "" : here.glossProblem();
    if (layer != -1 && (layer < 1 || layer > 4))
        problem = std::to_string(layer) + ": needs 1 ... 4, or -1 for none";
    if (!problem.empty())
    {
        warn("gloss layer not set: " + problem);
        return;
    }
    here.terrain.glossLayer = layer;
    here.terrain.settle();
    here.tellProblems();
}

int TerrainLighting::getGlossLayer() const
{
    return _implementation->terrain.glossLayer;
}

void TerrainLighting::setDefaultProgramEnabled(bool enabled)
{
    _implementation->terrain.defaultProgram = enabled;
}

bool TerrainLighting::getDefaultProgramEnabled() const
{
    return _implementation->terrain.defaultProgram;
}

void TerrainLighting::setLightEnabled(bool enabled)
{
    _implementation->scheduler->enabled = enabled;
}

bool TerrainLighting::getLightEnabled() const
{
    return _implementation->scheduler->enabled;
}

void TerrainLighting::setTimeBudget(double milliseconds)
{
    if (milliseconds >= 0.0 && milliseconds <= 1e9)
        _implementation->scheduler->budget = milliseconds;
    else
        warn("time budget not set: needs 0 ... 1e9 ms");
}

double TerrainLighting::getTimeBudget() const
{
    return _implementation->scheduler->budget;
}

void TerrainLighting::setFadeSeconds(double seconds)
{
    if (seconds >= 0.0 && seconds <= 3600.0)
        _implementation->terrain.fades.seconds = seconds;
    else
        warn("fade not set: needs 0 ... 3600 s");
}

double TerrainLighting::getFadeSeconds() const
{
    return _implementation->terrain.fades.seconds;
}

TileHandle TerrainLighting::addTile(const DemTile& dem, osg::StateSet* stateSet,
                                    const ShadingCoordinates& coordinates, bool program,
                                    const TileHandle& name)
{
    Implementation& here = *_implementation;
    if (const std::string problem = here.tileProblem(dem, stateSet, name); !problem.empty())
    {
        warn("tile not added: " + problem);
        return {};
    }
    SceneTile& tile = here.registry.add(name ? name : here.registry.next());
    if (const std::optional<PlacedGround> ground = HostTiles::placeOf(dem, name))
        here.placed.add(tile, *ground, stateSet, coordinates, program);
    else
        here.binder.bindHost(tile, dem, stateSet, coordinates, program);
    here.registry.take(tile);
    return tile.handle;
}

TileHandle TerrainLighting::addTile(DynamicTerrain* terrain, const TileHandle& name)
{
    Implementation& here = *_implementation;
    const unsigned unit = terrain ? terrain->getHeightUnit() : 0;
    std::string problem;
    if (!terrain || !terrain->getHeightTexture())
        problem = "needs terrain with 2 x 2 posts or more that is drawn";
    else
        problem = here.tileProblem(terrain->getTile(), terrain->getOrCreateStateSet(), name);
    if (problem.empty() && (unit == here.binder.units.shading ||
                            (unit == here.binder.units.gloss && here.mayBeGlossy())))
        problem = "its heights are in texture unit " + std::to_string(unit) +
                  ", which the light needs: needs setHeightUnit() with another";
    if (!problem.empty())
    {
        warn("dynamic terrain not added: " + problem);
        return {};
    }
    SceneTile& tile = here.registry.add(name ? name : here.registry.next());
    here.binder.bindDynamic(tile, *terrain);
    here.registry.take(tile);
    here.registry.addDynamic(tile);
    return tile.handle;
}

bool TerrainLighting::setTileHeights(const TileHandle& handle, const std::vector<float>& heights)
{
    SceneTile* tile = _implementation->hosts(handle);
    if (!tile || tile->dynamic || !isTileSized(*tile, heights.size()))
    {
        warn("heights of tile not set: needs a tile that addTile() was given with a DemTile, and a "
             "height per post");
        return false;
    }
    if (tile->host)
    {
        _implementation->placed.setHeights(*tile, heights);
        return true;
    }
    tile->lit->lighting().setHeights(heights);
    _implementation->scheduler->touch();
    return true;
}

bool TerrainLighting::setTileAlbedo(const TileHandle& handle, const std::vector<Rgb>& albedo)
{
    SceneTile* tile = _implementation->hosts(handle);
    if (!tile || !areAlbedo(*tile, albedo))
    {
        warn("albedo of tile not set: needs a tile that was added, and a colour of 0 ... 1 per "
             "post");
        return false;
    }
    if (tile->host)
        tile->host->albedo = albedo;
    tile->lit->lighting().setAlbedo(tile->lit->withMargin(rasterOf(*tile, albedo)));
    _implementation->scheduler->touch();
    return true;
}

bool TerrainLighting::setTileGloss(const TileHandle& handle,
                                   const std::vector<std::array<float, 2>>& gloss)
{
    Implementation& here = *_implementation;
    std::string problem = gloss.empty() ? "" : here.glossProblem();
    SceneTile* tile = here.hosts(handle);
    if (problem.empty() && (!tile || !areGloss(*tile, gloss)))
        problem = "needs a tile that was added, and a pair per post of gloss, 0 ... 1, and "
                  "exponent, 1 ... 64";
    if (!problem.empty())
    {
        warn("gloss of tile not set: " + problem);
        return false;
    }
    tile->hasGloss = !gloss.empty();
    if (tile->host)
        tile->host->gloss = gloss;
    tile->lit->lighting().setGloss(tile->lit->withMargin(rasterOf(*tile, gloss)));
    here.scheduler->touch();
    here.tellProblems();
    return true;
}

bool TerrainLighting::removeTile(const TileHandle& handle)
{
    SceneTile* tile = _implementation->hosts(handle);
    if (!tile)
        return false;
    if (tile->host)
        _implementation->placed.remove(*tile);
    _implementation->registry.untake(*tile);
    _implementation->binder.release(*tile);
    _implementation->registry.remove(handle);
    return true;
}

bool TerrainLighting::setSurroundings(const Surroundings& surroundings)
{
    if (const std::string problem = surroundings.complaint(); !problem.empty())
    {
        warn("surroundings not set: " + problem);
        return false;
    }
    _implementation->placed.setSurroundings(surroundings);
    return true;
}

void TerrainLighting::removeSurroundings()
{
    _implementation->placed.setSurroundings({});
}

void TerrainLighting::surroundingsChanged(double west, double south, double east, double north,
                                          double highest)
{
    if (west <= east && south <= north && !std::isnan(highest))
        _implementation->placed.changeSurroundings(west, south, east, north, highest);
    else
        warn("change of surroundings not taken: needs west <= east, south <= north and a height");
}

TileHandle TerrainLighting::getTileHandle(osgTerrain::TerrainTile* tile)
{
    return tile ? _implementation->registry.handleOf(*tile) : TileHandle();
}

std::vector<TileHandle> TerrainLighting::getTileHandles() const
{
    return _implementation->registry.handles();
}

TileState TerrainLighting::getTileState(const TileHandle& handle) const
{
    const SceneTile* tile = _implementation->registry.find(handle);
    TileState state;
    if (tile && tile->lit)
        return tile->lit->state();
    if (tile)
    {
        state.stage = tile->problem.empty() ? TileState::Stage::Waiting : TileState::Stage::Failed;
        state.reason = tile->problem;
    }
    return state;
}

bool TerrainLighting::addProbe(LightProbe* probe, const TileHandle& tile)
{
    const bool added = probe && tile && _implementation->probes.add(*probe, tile);
    if (!added)
        warn("probe not added: needs a probe that has not been added, and a tile's handle");
    _implementation->terrain.settle(); // its light needs the tile's albedo
    return added;
}

void TerrainLighting::removeProbe(LightProbe* probe)
{
    _implementation->probes.remove(probe);
}

bool TerrainLighting::addObject(PlacedObject* object)
{
    bool below = false;
    if (object)
        for (const osg::NodePath& path : object->getParentalNodePaths(this))
            below = below || (!path.empty() && path.front() == this);
    const bool added = object && !below && _implementation->objects.add(*object);
    if (!added)
        warn("object not added: needs one that has not been added, and does not stand below the "
             "lighting, where it is found");
    return added;
}

bool TerrainLighting::removeObject(PlacedObject* object)
{
    return _implementation->objects.remove(object);
}

std::size_t TerrainLighting::getObjectCount() const
{
    return _implementation->objects.size();
}

void TerrainLighting::see(PlacedObject& object, const osg::Matrixd& toScene)
{
    _implementation->objects.see(object, toScene);
}

std::size_t TerrainLighting::getTileCount() const
{
    std::size_t count = 0;
    _implementation->forEachLit([&](const LitTile&) { ++count; });
    return count;
}

unsigned TerrainLighting::getVisitCount() const
{
    return _implementation->finder.visits();
}

std::map<std::string, unsigned> TerrainLighting::getDispatchCounts() const
{
    std::map<std::string, unsigned> counts = _implementation->binder.pastDispatches();
    _implementation->forEachLit(
        [&](const LitTile& tile)
        {
            for (const StageCost& cost : tile.lighting().costs())
                counts[cost.name] += cost.dispatches;
        });
    for (const StageCost& cost : _implementation->scheduler->objects().costs())
        counts[cost.name] += cost.dispatches;
    return counts;
}

unsigned TerrainLighting::getDispatchCount() const
{
    unsigned sum = 0;
    for (const auto& [stage, count] : getDispatchCounts())
        sum += count;
    return sum;
}

LightingStatistics TerrainLighting::getStatistics() const
{
    LightingStatistics found;
    for (const TileHandle& handle : getTileHandles())
    {
        const TileState::Stage stage = getTileState(handle).stage;
        ++found.tiles;
        found.lit += stage == TileState::Stage::Lit ? 1 : 0;
        found.failed += stage == TileState::Stage::Failed ? 1 : 0;
    }
    found.waiting = found.tiles - found.lit - found.failed;
    _implementation->forEachLit([&](const LitTile& tile)
                                { found.bytes += tile.lighting().bytes(); });
    found.bytes += _implementation->scheduler->objects().bytes();
    found.milliseconds = _implementation->scheduler->milliseconds();
    return found;
}

std::string TerrainLighting::getFailure() const
{
    const std::string failure = _implementation->scheduler->failure();
    return failure.empty() ? _implementation->programs->failure() : failure;
}

void TerrainLighting::traverse(osg::NodeVisitor& visitor)
{
    Implementation& here = *_implementation;
    getBound(); // before any below is asked for: what is dirty is noted on the way
    if (osgUtil::CullVisitor* cull = visitor.asCullVisitor())
    {
        const osg::State* state = cull->getState();
        if (!state || !here.scheduler->isDone(state->getContextID()))
        {
            here.scheduler->see(*cull);
            here.compute->accept(visitor);
        }
        else
            here.scheduler->rest(state->getContextID());
        cull->pushStateSet(here.uniforms.stateSet());
        osg::Group::traverse(visitor);
        cull->popStateSet();
        return;
    }
    const unsigned updatesBelow = getNumChildrenRequiringUpdateTraversal();
    osg::Group::traverse(visitor);
    if (visitor.getVisitorType() == osg::NodeVisitor::UPDATE_VISITOR)
        here.update(updatesBelow, visitor.getFrameStamp());
}

osg::BoundingSphere TerrainLighting::computeBound() const
{
    _implementation->finder.noteDirtyBounds();
    return osg::Group::computeBound();
}

void TerrainLighting::releaseGLObjects(osg::State* state) const
{
    const Implementation& here = *_implementation;
    osg::Group::releaseGLObjects(state);
    here.forEachLit([&](const LitTile& tile) { tile.lighting().releaseGLObjects(state); });
    here.terrain.fades.releaseGLObjects(state);
    here.scheduler->objects().releaseGLObjects(state);
    here.scheduler->forget(state ? state->getContextID() : ~0u);
    here.compute->releaseGLObjects(state);
    here.objects.surfaces().releaseGLObjects(state);
    here.uniforms.releaseGLObjects(state);
}

void TerrainLighting::resizeGLObjectBuffers(unsigned size)
{
    osg::Group::resizeGLObjectBuffers(size);
    // A TerrainTile does not tell its technique, whose geometry would then grow while two contexts'
    // threads draw it.
    class PartResizer : public osg::NodeVisitor
    {
    public:
        explicit PartResizer(unsigned size) : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN), _size(size)
        {
        }
        void apply(osg::Drawable& drawable) override { drawable.resizeGLObjectBuffers(_size); }

    private:
        unsigned _size;
    } resizer(size);
    osg::Group::traverse(resizer);
    Implementation& here = *_implementation;
    here.forEachLit([&](const LitTile& tile) { tile.lighting().resizeGLObjectBuffers(size); });
    here.scheduler->objects().resizeGLObjectBuffers(size);
    here.compute->resizeGLObjectBuffers(size);
    here.objects.surfaces().resizeGLObjectBuffers(size);
    here.uniforms.resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
