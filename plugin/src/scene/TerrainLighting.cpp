#include <osgTerrainLight/TerrainLighting.h>

#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/LightProbe.h>

#include "core/SettingsTable.h"
#include "core/SkyRadiance.h"
#include "gpu/ShaderLibrary.h"
#include "scene/DisplacedProgram.h"
#include "scene/ShadingBinding.h"
#include "scene/TerrainTileReader.h"
#include "scene/TileSet.h"
#include <osgTerrainLight/Environment.h>

#include <osg/Camera>
#include <osg/Drawable>
#include <osg/Notify>
#include <osgTerrain/GeometryTechnique>
#include <osgTerrain/Terrain>
#include <osgUtil/CullVisitor>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>

namespace osgTerrainLight
{

namespace
{
void warn(const std::string& sentence)
{
    OSG_WARN << "osgTerrainLight: " << sentence << std::endl;
}

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

/// Of ground that sends nothing by gloss: as GlossPass' light, of one texel.
osg::ref_ptr<osg::Texture2DArray> createNoGloss()
{
    osg::ref_ptr<osg::Texture2DArray> dark = new osg::Texture2DArray;
    dark->setTextureSize(1, 1, GlossPass::layers);
    for (unsigned layer = 0; layer < GlossPass::layers; ++layer)
    {
        osg::ref_ptr<osg::Image> texel = new osg::Image;
        texel->allocateImage(1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
        std::fill_n(texel->data(), texel->getTotalSizeInBytes(), static_cast<unsigned char>(0));
        dark->setImage(layer, texel);
    }
    dark->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
    dark->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
    return dark;
}

/// Runs the tiles' compute stages when drawn.
class ComputeDrawable : public osg::Drawable
{
public:
    explicit ComputeDrawable(TileSet* tiles) : _tiles(tiles)
    {
        setCullingActive(false);
        setSupportsDisplayList(false);
        setUseDisplayList(false);
    }
    osg::Object* cloneType() const override { return new ComputeDrawable(_tiles); }
    osg::Object* clone(const osg::CopyOp&) const override { return cloneType(); }
    const char* libraryName() const override { return "osgTerrainLight"; }
    const char* className() const override { return "ComputeDrawable"; }

    void drawImplementation(osg::RenderInfo& renderInfo) const override
    {
        _tiles->compute(*renderInfo.getState());
    }
    void compileGLObjects(osg::RenderInfo&) const override {}
    osg::BoundingBox computeBoundingBox() const override { return {}; }

private:
    osg::ref_ptr<TileSet> _tiles;
};

/// What decides whether a tile must be read again.
struct TileVersion
{
    const osgTerrain::Layer* layer = nullptr;
    unsigned modified = 0;
    float verticalScale = 1.0f;
    osg::Matrixd toScene;

    bool operator==(const TileVersion& other) const
    {
        return layer == other.layer && modified == other.modified &&
               verticalScale == other.verticalScale && toScene == other.toScene;
    }
};

TileVersion versionOf(const osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene)
{
    const osgTerrain::Layer* layer = tile.getElevationLayer();
    return {layer, layer ? layer->getModifiedCount() : 0,
            tile.getTerrain() ? tile.getTerrain()->getVerticalScale() : 1.0f, toScene};
}

/// A tile that the visitor has come across.
struct FoundTile
{
    osgTerrain::TerrainTile* tile = nullptr;
    osg::Matrixd toScene;
    bool hasProgram = false; ///< of its own or from above, up to TerrainLighting
    std::vector<TilePart> parts;
};

class TileFinder : public osg::NodeVisitor
{
public:
    explicit TileFinder(bool hasProgram)
        : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN), _hasProgram(hasProgram)
    {
    }

    std::vector<FoundTile> found;

    void apply(osg::Node& node) override
    {
        // Changes below reach TerrainLighting through dirty bounds, and only from a node whose
        // bound was computed.
        node.getBound();
        const bool above = _hasProgram;
        const osg::StateSet* stateSet = node.getStateSet();
        const osg::StateAttribute* program =
            stateSet ? stateSet->getAttribute(osg::StateAttribute::PROGRAM) : nullptr;
        _hasProgram = _hasProgram || (program && !dynamic_cast<const TileProgram*>(program));
        auto* tile = dynamic_cast<osgTerrain::TerrainTile*>(&node);
        if (tile && !_inTile)
        {
            found.push_back({tile, osg::computeLocalToWorld(getNodePath()), _hasProgram, {}});
            _tileDepth = getNodePath().size();
            _inTile = true;
            traverse(node); // the technique makes its geometry at the first traversal
            _inTile = false;
        }
        else
            traverse(node);
        _hasProgram = above;
    }
    void apply(osg::Drawable& drawable) override
    {
        if (!_inTile || !drawable.asGeometry())
            return;
        const osg::NodePath& path = getNodePath();
        const osg::NodePath below(path.begin() + static_cast<std::ptrdiff_t>(_tileDepth),
                                  path.end());
        found.back().parts.push_back({drawable.asGeometry(), osg::computeLocalToWorld(below)});
    }

private:
    bool _hasProgram;
    bool _inTile = false;
    std::size_t _tileDepth = 0;
};
} // namespace

/// What TerrainLighting keeps per tile, and the node that computes.
class TerrainLighting::Tiles
{
public:
    explicit Tiles(TerrainLighting& owner) : set(new TileSet), _owner(owner)
    {
        _drawable = new ComputeDrawable(set);
        camera = new osg::Camera;
        camera->setRenderOrder(osg::Camera::PRE_RENDER, -1000);
        camera->setReferenceFrame(osg::Transform::ABSOLUTE_RF);
        camera->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
        camera->setClearMask(0);
        camera->setCullingActive(false);
        camera->setAllowEventFocus(false);
        camera->addChild(_drawable);
    }

    /// Finds tiles that came, went or changed. In update traversal, after the children.
    void update()
    {
        retire();
        followShaders();
        _owner.getBound();
        for (auto& [stateSet, lit] : _added)
        {
            followHeights(lit);
            followGloss(lit);
        }
        for (const auto& [tile, entry] : _found)
            if (!(versionOf(*tile, entry.toScene) == entry.version))
                structureChanged = true;
        if (structureChanged.exchange(false))
            find();
        for (auto& [tile, entry] : _found)
        {
            if (entry.lit.binding)
                entry.lit.binding->setHasColour(hasColour(*tile));
            if (entry.lit.tile)
                followGlossLayer(*tile, entry.lit);
            followGloss(entry.lit);
            if (entry.lit.tile && (_owner._settings.bounces > 0 || !_probes.empty()))
                followAlbedo(*tile, entry.lit);
            if (entry.lit.binding && entry.byTexCoord)
            {
                // The technique makes new geometry where a neighbour asks for it.
                TileFinder finder(false);
                tile->accept(finder);
                addTileCoordinates(*tile, finder.found.front().parts);
            }
        }
        followProbes();
    }

    bool add(const DemTile& dem, osg::StateSet* stateSet, const ShadingCoordinates& coordinates,
             bool program)
    {
        if (!stateSet || dem.width() < 1 || dem.height() < 1 || _added.count(stateSet))
            return false;
        takeFrom(stateSet);
        Lit& lit = _added[stateSet];
        lit = light(dem, "added tile");
        bind(lit, stateSet, coordinates, program);
        return true;
    }

    bool add(DynamicTerrain& terrain)
    {
        osg::StateSet* stateSet = terrain.getOrCreateStateSet();
        if (!terrain.getHeightTexture() || _added.count(stateSet) ||
            _owner._textureUnit == DynamicTerrain::heightUnit)
            return false;
        takeFrom(stateSet);
        Lit& lit = _added[stateSet];
        lit = light(terrain.getTile(), "dynamic terrain");
        const bool ours = dynamic_cast<const DisplacedProgram*>(
                              stateSet->getAttribute(osg::StateAttribute::PROGRAM)) != nullptr;
        bind(lit, stateSet, {}, ours ? new DisplacedProgram(set, lit.tile) : nullptr);
        lit.terrain = &terrain;
        followHeights(lit);
        return true;
    }

    bool setGloss(osg::StateSet* stateSet, const std::vector<std::array<float, 2>>& gloss)
    {
        const auto found = _added.find(stateSet);
        if (found == _added.end())
            return false;
        TileLight& lighting = found->second.tile->lighting();
        Raster<std::array<float, 2>> posts;
        if (!gloss.empty())
            posts = Raster<std::array<float, 2>>(lighting.width(), lighting.height());
        if (gloss.size() != posts.size())
            return false;
        for (const auto& [mirrored, exponent] : gloss)
            if (!(mirrored >= 0.0f && mirrored <= 1.0f && exponent >= 1.0f && exponent <= 64.0f))
                return false;
        posts.values() = gloss;
        found->second.hasGloss = !gloss.empty();
        lighting.setGloss(std::move(posts));
        set->touch();
        return true;
    }
    bool hasGloss() const
    {
        return std::any_of(_added.begin(), _added.end(),
                           [](const auto& added) { return added.second.hasGloss; });
    }

    bool addProbe(LightProbe* probe, osg::StateSet* stateSet, osgTerrain::TerrainTile* tile)
    {
        if (!probe || (!stateSet && !tile) ||
            std::any_of(_probes.begin(), _probes.end(),
                        [probe](const Probe& known) { return known.probe == probe; }))
            return false;
        _probes.push_back({probe, stateSet, tile});
        return true;
    }
    void removeProbe(const LightProbe* probe)
    {
        const auto last =
            std::remove_if(_probes.begin(), _probes.end(),
                           [probe](const Probe& known) { return known.probe == probe; });
        _probesGone = _probesGone || last != _probes.end();
        _probes.erase(last, _probes.end());
    }

    /// Whether a tile's shading is in the unit.
    bool uses(unsigned unit) const
    {
        const auto has = [unit](const Lit& lit)
        { return lit.binding && lit.binding->unit() == unit; };
        return std::any_of(_added.begin(), _added.end(),
                           [&](const auto& added) { return has(added.second); }) ||
               std::any_of(_found.begin(), _found.end(),
                           [&](const auto& found) { return has(found.second.lit); });
    }

    void remove(osg::StateSet* stateSet)
    {
        const auto found = _added.find(stateSet);
        if (found == _added.end())
            return;
        release(found->second);
        _added.erase(found);
    }

    template <class F>
    void forEach(F&& f) const
    {
        for (const auto& [tile, entry] : _found)
            if (entry.lit.tile)
                f(*entry.lit.tile);
        for (const auto& [stateSet, lit] : _added)
            f(*lit.tile);
    }

    /// Counts of tiles that are gone.
    std::map<std::string, unsigned> pastDispatches;

    osg::ref_ptr<TileSet> set;
    osg::ref_ptr<osg::Camera> camera;
    osg::ref_ptr<osg::Texture2DArray> noGloss; ///< null until some of the ground may be glossy
    mutable std::atomic<bool> structureChanged{true};

private:
    struct Lit
    {
        osg::ref_ptr<LitTile> tile;
        std::shared_ptr<ShadingBinding> binding;
        osg::ref_ptr<DynamicTerrain> terrain; ///< of which heights are followed
        osg::ref_ptr<osg::Texture2D> heights; ///< those that are; null: still the first ones
        unsigned heightRevision = 0;
        osg::ref_ptr<const osg::Image> colours; ///< that its albedo was read from
        unsigned coloursVersion = 0;
        osg::ref_ptr<const osg::Image> glossPicture; ///< that its gloss was read from
        unsigned glossVersion = 0;
        bool hasGloss = false; ///< of setTileGloss()
    };
    struct Entry
    {
        osg::ref_ptr<osgTerrain::TerrainTile> tile;
        osg::Matrixd toScene;
        TileVersion version;
        Lit lit;
        bool ownStateSet = false; ///< the tile had none before
        /// Of a StateSet that has been made DYNAMIC and is bound at the next update.
        std::optional<osg::Object::DataVariance> theirVariance;
        bool byTexCoord = false;
        bool seen = false;
    };
    /// A probe on one of the tiles that were added, or that are found.
    struct Probe
    {
        osg::ref_ptr<LightProbe> probe;
        osg::ref_ptr<osg::StateSet> stateSet;
        osg::observer_ptr<osgTerrain::TerrainTile> tile;
    };
    /// A binding that frames still being drawn may use.
    struct Retired
    {
        std::shared_ptr<ShadingBinding> binding;
        osg::ref_ptr<osgTerrain::TerrainTile> emptied; ///< its StateSet is ours to take off
        int updates = 3;                               ///< frames that a threaded viewer has going
    };

    Lit light(const DemTile& dem, const std::string& name)
    {
        Lit lit;
        lit.tile = new LitTile(name, new TileLight(dem, _owner._settings, _owner._sky));
        set->add(lit.tile);
        return lit;
    }

    void bind(Lit& lit, osg::StateSet* stateSet, const ShadingCoordinates& coordinates,
              bool withProgram)
    {
        osg::ref_ptr<osg::Program> program;
        if (withProgram)
        {
            if (!set->program(false))
                set->setPrograms(createDefaultProgram(false), createDefaultProgram(true));
            program = new TileProgram(set, lit.tile);
        }
        bind(lit, stateSet, coordinates, program.get());
    }

    void bind(Lit& lit, osg::StateSet* stateSet, const ShadingCoordinates& coordinates,
              osg::Program* program)
    {
        lit.binding = std::make_shared<ShadingBinding>(stateSet, lit.tile->lighting().shading(),
                                                       _owner._textureUnit, coordinates, program);
        followGloss(lit);
    }

    /// Binds light sent by gloss where there is now some. Until it is computed the tile waits.
    void followGloss(Lit& lit)
    {
        if (!lit.binding)
            return;
        const osg::ref_ptr<osg::Texture2DArray> light = lit.tile->lighting().glossLight();
        if (light == lit.binding->gloss())
            return;
        lit.binding->setGloss(light);
        lit.tile->glossy = light.valid();
        if (light)
        {
            lit.tile->forget(~0u);
            set->touch();
        }
    }

    /// Hands on heights that have changed.
    void followHeights(Lit& lit)
    {
        if (!lit.terrain)
            return;
        lit.binding->setHasColour(
            lit.terrain->getStateSet() &&
            lit.terrain->getStateSet()->getTextureAttribute(0, osg::StateAttribute::TEXTURE));
        if (lit.terrain->getHeightRevision() == lit.heightRevision)
            return;
        lit.heightRevision = lit.terrain->getHeightRevision();
        if (lit.heights == lit.terrain->getHeightTexture())
            lit.tile->lighting().touchHeights();
        else
            lit.tile->lighting().setHeightTexture(lit.terrain->getHeightTexture());
        lit.heights = lit.terrain->getHeightTexture();
        set->touch();
    }

    /// Hands on the places of probes that are new, have changed or are gone.
    void followProbes()
    {
        if (_probes.empty() && !_probesGone)
            return;
        _probesGone = false;
        std::map<const LitTile*, std::vector<ProbePlace>> places;
        for (const Probe& probe : _probes)
        {
            const auto added = _added.find(probe.stateSet);
            const auto found = _found.find(probe.tile.get());
            const Lit* lit = added != _added.end()   ? &added->second
                             : found != _found.end() ? &found->second.lit
                                                     : nullptr;
            if (lit && lit->tile)
                places[lit->tile].push_back(placeOf(*probe.probe, lit->tile->lighting().tile()));
        }
        forEach(
            [&](LitTile& tile)
            {
                if (tile.lighting().setProbes(places[&tile]))
                    set->touch();
            });
    }

    static ProbePlace placeOf(const LightProbe& probe, const DemTile& tile)
    {
        ProbePlace place;
        place.row = std::clamp(probe.getNorth() / tile.northSpacing, 0.0, tile.height() - 1.0);
        const double spacing = tile.eastSpacing(static_cast<int>(place.row + 0.5));
        place.column = std::clamp(probe.getEast() / spacing, 0.0, tile.width() - 1.0);
        place.height = probe.getHeight();
        place.aboveGround = probe.isAboveGround();
        place.exponent = probe.getExponent();
        place.diffuse = probe.getDiffuseMap();
        place.glossy = probe.getGlossyMap();
        return place;
    }

    void release(Lit& lit, osgTerrain::TerrainTile* emptied = nullptr)
    {
        if (lit.tile)
        {
            set->remove(lit.tile);
            for (const StageCost& cost : lit.tile->lighting().costs())
                pastDispatches[cost.name] += cost.dispatches;
        }
        if (lit.binding)
            _retired.push_back({std::move(lit.binding), emptied});
        lit = Lit();
    }

    /// Takes up edits in the folder of shaders that replace ours, if there is one.
    void followShaders()
    {
        const long long shaders = ShaderLibrary::instance().revision();
        if (shaders == _shaders)
            return;
        _shaders = shaders;
        if (set->program(false))
            set->setPrograms(createDefaultProgram(false), createDefaultProgram(true));
        forEach(
            [](LitTile& tile)
            {
                tile.lighting().recompute();
                tile.retry();
            });
        set->touch();
    }

    void retire()
    {
        for (Retired& retired : _retired)
            --retired.updates;
        while (!_retired.empty() && _retired.front().updates <= 0)
        {
            take(_retired.front());
            _retired.pop_front();
        }
    }

    static void take(Retired& retired)
    {
        const osg::ref_ptr<osg::StateSet> stateSet = retired.binding->stateSet();
        retired.binding.reset();
        const osg::ref_ptr<osg::StateSet> empty = new osg::StateSet;
        if (retired.emptied && retired.emptied->getStateSet() == stateSet &&
            stateSet->compare(*empty, true) == 0)
            retired.emptied->setStateSet(nullptr);
    }

    /// Removes what is still bound to a StateSet that is about to be bound anew.
    void takeFrom(const osg::StateSet* stateSet)
    {
        for (auto i = _retired.begin(); stateSet && i != _retired.end();)
            if (i->binding->stateSet() == stateSet)
            {
                take(*i);
                i = _retired.erase(i);
            }
            else
                ++i;
    }

    void find()
    {
        bool hasProgram = false;
        for (const osg::NodePath& path : _owner.getParentalNodePaths())
            for (const osg::Node* node : path)
                hasProgram =
                    hasProgram || (node->getStateSet() &&
                                   node->getStateSet()->getAttribute(osg::StateAttribute::PROGRAM));
        TileFinder finder(hasProgram);
        for (unsigned i = 0; i < _owner.getNumChildren(); ++i)
            _owner.getChild(i)->accept(finder);

        for (auto& [tile, entry] : _found)
            entry.seen = false;
        for (const FoundTile& found : finder.found)
            use(found);
        for (auto i = _found.begin(); i != _found.end();)
            if (i->second.seen)
                ++i;
            else
            {
                undoWait(i->second);
                release(i->second.lit, i->second.ownStateSet ? i->first : nullptr);
                i = _found.erase(i);
            }
        _searched = true;
    }

    /// Reads a colour layer that is new or has changed: its colours are what bounces.
    void followAlbedo(const osgTerrain::TerrainTile& tile, Lit& lit)
    {
        const osg::Image* image = pictureOf(tile, 0);
        const unsigned version = image ? image->getModifiedCount() : 0;
        if (lit.colours == image && lit.coloursVersion == version)
            return;
        lit.colours = image;
        lit.coloursVersion = version;
        TileLight& lighting = lit.tile->lighting();
        lighting.setAlbedo(readTerrainAlbedo(tile, lighting.width(), lighting.height()));
        set->touch();
    }

    /// The same of the layer that holds gloss.
    void followGlossLayer(const osgTerrain::TerrainTile& tile, Lit& lit)
    {
        const osg::Image* image = pictureOf(tile, _owner._glossLayer);
        const unsigned version = image ? image->getModifiedCount() : 0;
        if (lit.glossPicture == image && lit.glossVersion == version)
            return;
        lit.glossPicture = image;
        lit.glossVersion = version;
        TileLight& lighting = lit.tile->lighting();
        lighting.setGloss(
            readTerrainGloss(tile, _owner._glossLayer, lighting.width(), lighting.height()));
        set->touch();
    }

    /// True where the tile may have been drawn by threads that are still reading what binding it
    /// changes. It then is DYNAMIC from the next frame on: updates wait for that to be drawn.
    bool waits(Entry& entry, const FoundTile& found, bool known)
    {
        osgTerrain::TerrainTile& tile = *found.tile;
        const osg::StateSet* stateSet = tile.getStateSet();
        // What comes below a node that has searched before is new to the scene.
        if ((_searched && !known) ||
            (stateSet && stateSet->getDataVariance() == osg::Object::DYNAMIC))
            return false;
        const bool coordinates =
            std::any_of(found.parts.begin(), found.parts.end(),
                        [](const TilePart& part) {
                            return !part.geometry->getTexCoordArray(ShadingTexture::coordinateSet);
                        });
        if (!stateSet && (!coordinates || affineCoordinates(tile, found.parts)))
            return false;
        entry.ownStateSet = !stateSet;
        entry.theirVariance = tile.getOrCreateStateSet()->getDataVariance();
        tile.getStateSet()->setDataVariance(osg::Object::DYNAMIC);
        return true;
    }

    static void undoWait(Entry& entry)
    {
        if (entry.theirVariance && entry.ownStateSet)
            entry.tile->setStateSet(nullptr);
        else if (entry.theirVariance && entry.tile->getStateSet())
            entry.tile->getStateSet()->setDataVariance(*entry.theirVariance);
        entry.theirVariance.reset();
    }

    void use(const FoundTile& found)
    {
        osgTerrain::TerrainTile& tile = *found.tile;
        if (tile.getStateSet() && _added.count(tile.getStateSet()))
            return; // the host takes care of it
        Entry& entry = _found[&tile];
        const TileVersion version = versionOf(tile, found.toScene);
        const bool known = entry.tile != nullptr;
        const bool again = known && entry.seen; // it stands in several places: the first one counts
        entry.seen = true;
        if (again || (known && entry.version == version))
            return;
        if (known)
            release(entry.lit, entry.ownStateSet ? &tile : nullptr);
        entry.tile = &tile;
        entry.toScene = found.toScene;
        if (version.layer && waits(entry, found, known))
            return; // its version is not the entry's: the next update comes here again
        takeFrom(tile.getStateSet());
        entry.version = version;
        if (!version.layer)
        {
            undoWait(entry);
            return; // may come later
        }
        const Result<DemTile> dem = readTerrainTile(tile, found.toScene);
        if (!dem)
        {
            warn(nameOf(tile) + " is drawn unlit: " + dem.error().message);
            undoWait(entry);
            return;
        }
        std::optional<ShadingCoordinates> coordinates = affineCoordinates(tile, found.parts);
        entry.byTexCoord = !coordinates;
        if (!coordinates)
        {
            addTileCoordinates(tile, found.parts);
            coordinates = ShadingCoordinates();
        }
        coordinates->frame = tileFrame(tile, found.parts);
        // Other techniques move vertices in shaders of their own.
        const bool stock = dynamic_cast<const osgTerrain::GeometryTechnique*>(
                               tile.getTerrainTechnique()) != nullptr;
        entry.lit = light(*dem, nameOf(tile));
        if (!entry.theirVariance)
            entry.ownStateSet = !tile.getStateSet();
        bind(entry.lit, tile.getOrCreateStateSet(), *coordinates,
             _owner._defaultProgramEnabled && stock && !found.hasProgram);
        entry.lit.binding->setHasColour(hasColour(tile));
        if (entry.theirVariance)
            entry.lit.binding->setTheirVariance(*entry.theirVariance);
        entry.theirVariance.reset();
    }

    TerrainLighting& _owner;
    osg::ref_ptr<ComputeDrawable> _drawable;
    long long _shaders = ShaderLibrary::instance().revision();
    std::map<osgTerrain::TerrainTile*, Entry> _found;
    std::map<osg::ref_ptr<osg::StateSet>, Lit> _added;
    std::deque<Retired> _retired;
    std::vector<Probe> _probes;
    bool _probesGone = false; ///< some have been removed since the last update
    bool _searched = false;
};

TerrainLighting::TerrainLighting() : _tiles(new Tiles(*this))
{
    setNumChildrenRequiringUpdateTraversal(1);
    applyUniforms();
}

TerrainLighting::TerrainLighting(const TerrainLighting& other, const osg::CopyOp& copyop)
    : osg::Group(other, copyop), _sky(other._sky), _place(other._place), _time(other._time),
      _settings(other._settings), _defaultProgramEnabled(other._defaultProgramEnabled),
      _textureUnit(other._textureUnit), _glossLayer(other._glossLayer),
      _glossIgnored(other._glossIgnored), _tiles(new Tiles(*this))
{
    setNumChildrenRequiringUpdateTraversal(getNumChildrenRequiringUpdateTraversal() + 1);
    applyUniforms();
    setLightEnabled(other._lightEnabled);
    setTimeBudget(other.getTimeBudget());
}

TerrainLighting::~TerrainLighting() = default;

void TerrainLighting::setSkyLight(const SkyLight& sky)
{
    const std::string problem = complaint(sky);
    if (!problem.empty())
        warn("sky light not set: " + problem);
    if (!problem.empty() || sky == _sky)
        return;
    if (sky.sunAzimuth != _sky.sunAzimuth || sky.sunElevation != _sky.sunElevation)
        _time.reset();
    _sky = sky;
    applyUniforms();
    _tiles->forEach([&](LitTile& tile) { tile.lighting().setSky(sky); });
    _tiles->set->touch();
}

void TerrainLighting::setPlace(const EarthPlace& place)
{
    const std::string problem = place.complaint();
    if (!problem.empty())
        warn("place not set: " + problem);
    else
        _place = place;
    if (problem.empty() && _time)
        setTime(*_time);
}

void TerrainLighting::setTime(UtcTime time)
{
    UtcTime same;
    std::string problem = readUtcTime(toString(time), same);
    if (!_place)
        problem = "the terrain's place on Earth is not known: needs setPlace() (reader option "
                  "place=LONGITUDE,LATITUDE)";
    else if (_sky.environment)
        problem = "the sun is that of " + _sky.environment->name + ", which no time moves";
    if (!problem.empty())
    {
        warn("time not set: " + problem);
        return;
    }
    SkyLight sky = _sky;
    sky.setSunAt(time, *_place);
    setSkyLight(sky);
    _time = time;
}

void TerrainLighting::setSettings(const LightingSettings& settings)
{
    std::string problem = complaint(settings);
    if (problem.empty() && settings.gloss > 0.0)
        problem = glossProblem();
    if (!problem.empty())
    {
        warn("settings not set: " + problem);
        return;
    }
    const bool brightness = settings.exposure != _settings.exposure;
    _settings = settings;
    followGloss();
    if (brightness)
        applyUniforms();
    _tiles->forEach(
        [&](LitTile& tile)
        {
            tile.lighting().setSettings(settings);
            tile.retry();
        });
    _tiles->set->touch();
}

void TerrainLighting::setTextureUnit(unsigned unit)
{
    if (unit == ShadingTexture::glossUnit && mayBeGlossy())
        warn("texture unit not set: gloss needs " + std::to_string(unit));
    else
        _textureUnit = unit;
}

void TerrainLighting::setGlossLayer(int layer)
{
    std::string problem = layer < 0 ? "" : glossProblem();
    if (layer != -1 && (layer < 1 || layer > 4))
        problem = std::to_string(layer) + ": needs 1 ... 4, or -1 for none";
    if (!problem.empty())
    {
        warn("gloss layer not set: " + problem);
        return;
    }
    _glossLayer = layer;
    followGloss();
}

bool TerrainLighting::setTileGloss(osg::StateSet* stateSet,
                                   const std::vector<std::array<float, 2>>& gloss)
{
    const std::string problem = gloss.empty() ? "" : glossProblem();
    const bool done = problem.empty() && _tiles->setGloss(stateSet, gloss);
    if (!done)
        warn("gloss of tile not set: " +
             (problem.empty() ? "needs the StateSet of a tile that was added, and a pair per post "
                                "of gloss, 0 ... 1, and exponent, 1 ... 64"
                              : problem));
    followGloss();
    return done;
}

bool TerrainLighting::mayBeGlossy() const
{
    return _settings.gloss > 0.0 || _glossLayer >= 0 || _tiles->hasGloss();
}

std::string TerrainLighting::glossProblem() const
{
    constexpr unsigned unit = ShadingTexture::glossUnit;
    return _textureUnit == unit || _tiles->uses(unit)
               ? "gloss needs texture unit " + std::to_string(unit) +
                     ", which setTextureUnit() gave to the shading"
               : "";
}

void TerrainLighting::followGloss()
{
    const bool glossy = mayBeGlossy();
    const bool ignored = glossy && _settings.bounceMethod != BounceMethod::Slices;
    if (ignored && !_glossIgnored)
        warn(std::string("gloss has no effect with bounce method ") +
             toString(_settings.bounceMethod) + ": needs slices");
    _glossIgnored = ignored;
    if (glossy != _glossBound)
        applyUniforms();
}

void TerrainLighting::applyUniforms()
{
    // A new one each time: threads that draw the frame before still read the old one.
    _uniforms = new osg::StateSet;
    _uniforms->addUniform(new osg::Uniform(ShadingTexture::exposure,
                                           static_cast<float>(std::exp2(_settings.exposure))));
    const std::array<double, 3> sun = _sky.sunDirection();
    const bool hasSun = TileLight::needsSun(_sky);
    _uniforms->addUniform(
        new osg::Uniform(ShadingTexture::sunDirection,
                         osg::Vec3f(static_cast<float>(sun[0]), static_cast<float>(sun[1]),
                                    static_cast<float>(sun[2]))));
    const Rgb irradiance = sunAtGround(_sky);
    _uniforms->addUniform(new osg::Uniform(
        ShadingTexture::sunIrradiance,
        hasSun ? osg::Vec3f(irradiance[0], irradiance[1], irradiance[2]) : osg::Vec3f()));
    _uniforms->addUniform(new osg::Uniform(ShadingTexture::glossSampler,
                                           static_cast<int>(ShadingTexture::glossUnit)));
    // Where there is no light, tiles send none: shaders of hosts must find that.
    _glossBound = mayBeGlossy();
    if (_glossBound && !_tiles->noGloss)
        _tiles->noGloss = createNoGloss();
    if (_glossBound)
        _uniforms->setTextureAttribute(ShadingTexture::glossUnit, _tiles->noGloss);
}

void TerrainLighting::setLightEnabled(bool enabled)
{
    _lightEnabled = enabled;
    _tiles->set->enabled = enabled;
}

void TerrainLighting::setTimeBudget(double milliseconds)
{
    if (milliseconds >= 0.0)
        _tiles->set->budget = milliseconds;
    else
        warn("time budget not set: needs 0 ms or more");
}

double TerrainLighting::getTimeBudget() const
{
    return _tiles->set->budget;
}

bool TerrainLighting::addTile(const DemTile& tile, osg::StateSet* stateSet,
                              const ShadingCoordinates& coordinates, bool program)
{
    const bool added = _tiles->add(tile, stateSet, coordinates, program);
    if (!added)
        warn("tile not added: needs at least one post, and a StateSet that has none yet");
    return added;
}

bool TerrainLighting::addTile(DynamicTerrain* terrain)
{
    const bool added = terrain && _tiles->add(*terrain);
    if (!added)
        warn("dynamic terrain not added: needs 2 x 2 posts or more, not to have been added, and a "
             "texture unit other than that of its heights");
    return added;
}

bool TerrainLighting::addProbe(LightProbe* probe, osg::StateSet* tile)
{
    const bool added = _tiles->addProbe(probe, tile, nullptr);
    if (!added)
        warn("probe not added: needs a probe that has not been added, and a tile's StateSet");
    return added;
}

bool TerrainLighting::addProbe(LightProbe* probe, osgTerrain::TerrainTile* tile)
{
    const bool added = _tiles->addProbe(probe, nullptr, tile);
    if (!added)
        warn("probe not added: needs a probe that has not been added, and a terrain tile");
    return added;
}

void TerrainLighting::removeProbe(LightProbe* probe)
{
    _tiles->removeProbe(probe);
}

void TerrainLighting::removeTile(osg::StateSet* stateSet)
{
    _tiles->remove(stateSet);
}

std::size_t TerrainLighting::getTileCount() const
{
    std::size_t count = 0;
    _tiles->forEach([&](LitTile&) { ++count; });
    return count;
}

std::map<std::string, unsigned> TerrainLighting::getDispatchCounts() const
{
    std::map<std::string, unsigned> counts = _tiles->pastDispatches;
    _tiles->forEach(
        [&](LitTile& tile)
        {
            for (const StageCost& cost : tile.lighting().costs())
                counts[cost.name] += cost.dispatches;
        });
    return counts;
}

unsigned TerrainLighting::getDispatchCount() const
{
    unsigned sum = 0;
    for (const auto& [stage, count] : getDispatchCounts())
        sum += count;
    return sum;
}

std::string TerrainLighting::getFailure() const
{
    return _tiles->set->failure();
}

void TerrainLighting::traverse(osg::NodeVisitor& visitor)
{
    if (osgUtil::CullVisitor* cull = visitor.asCullVisitor())
    {
        const osg::State* state = cull->getState();
        if (!state || !_tiles->set->isDone(state->getContextID()))
            _tiles->camera->accept(visitor);
        cull->pushStateSet(_uniforms);
        osg::Group::traverse(visitor);
        cull->popStateSet();
        return;
    }
    osg::Group::traverse(visitor);
    if (visitor.getVisitorType() == osg::NodeVisitor::UPDATE_VISITOR)
        _tiles->update();
}

osg::BoundingSphere TerrainLighting::computeBound() const
{
    _tiles->structureChanged = true; // something below has changed
    return osg::Group::computeBound();
}

void TerrainLighting::releaseGLObjects(osg::State* state) const
{
    osg::Group::releaseGLObjects(state);
    _tiles->forEach([&](LitTile& tile) { tile.lighting().releaseGLObjects(state); });
    _tiles->set->forget(state ? state->getContextID() : ~0u);
    _tiles->camera->releaseGLObjects(state);
    if (_tiles->noGloss)
        _tiles->noGloss->releaseGLObjects(state);
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
    _tiles->forEach([&](LitTile& tile) { tile.lighting().resizeGLObjectBuffers(size); });
    _tiles->camera->resizeGLObjectBuffers(size);
    if (_tiles->noGloss)
        _tiles->noGloss->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
