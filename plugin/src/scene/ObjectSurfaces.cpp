#include "scene/ObjectSurfaces.h"

#include "core/ConeSet.h"
#include "lighting/LampUniforms.h"
#include "scene/ObjectField.h"
#include "scene/ShadingBinding.h"

#include <osg/Image>
#include <osg/Material>
#include <osg/Texture2D>
#include <osgUtil/StateGraph>

#include <algorithm>
#include <cmath>

#ifndef GL_TEXTURE_CUBE_MAP_SEAMLESS
#define GL_TEXTURE_CUBE_MAP_SEAMLESS 0x884F
#endif

namespace osgTerrainLight
{

namespace
{

constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

/// A probe is made anew where its object has moved by this part of its size, or has come to rest:
/// what a probe sees changes over the size of what it stands for, and a whole tile's horizon is
/// walked for it.
constexpr double movesBy = 0.2;

osg::Vec3d vector(const glm::dvec3& v)
{
    return {v.x, v.y, v.z};
}

osg::Vec4f vector(const glm::dvec3& v, double w)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
            static_cast<float>(w)};
}

osg::ref_ptr<osg::Texture2D> createWhite()
{
    const osg::ref_ptr<osg::Image> texel = new osg::Image;
    texel->allocateImage(1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
    std::fill_n(texel->data(), 4, static_cast<unsigned char>(255));
    const osg::ref_ptr<osg::Texture2D> white = new osg::Texture2D(texel);
    white->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
    white->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
    return white;
}

/// The nearest attribute above what is traversed; null where there is none.
const osg::StateAttribute* above(osgUtil::CullVisitor& cull, osg::StateAttribute::Type type,
                                 bool ofUnit0)
{
    for (const osgUtil::StateGraph* graph = cull.getCurrentStateGraph(); graph;
         graph = graph->_parent)
        if (const osg::StateSet* stateSet = graph->getStateSet())
            if (const osg::StateAttribute* found =
                    ofUnit0 ? stateSet->getTextureAttribute(0, type) : stateSet->getAttribute(type))
                return found;
    return nullptr;
}

/// The tile that a place stands on: of those that are lit the one whose posts are nearest to one
/// another, else of all.
const SceneTile* tileAt(const osg::Vec3d& place, const TileRegistry& tiles)
{
    const SceneTile* found = nullptr;
    bool isLit = false;
    tiles.forEach(
        [&](const SceneTile& tile)
        {
            if (!tile.lit || !tile.corner)
                return;
            const DemTile& dem = tile.lit->lighting().tile();
            const double north = place.y() - tile.corner->y();
            if (!(north >= 0.0 && north <= tile.spacing.y() * (tile.lit->drawnHeight() - 1)))
                return;
            const double east = place.x() - tile.corner->x();
            if (!(east >= 0.0 && east <= tile.spacing.x() * (tile.lit->drawnWidth() - 1)))
                return;
            const bool lit = tile.lit->state().stage == TileState::Stage::Lit;
            const bool isFiner =
                !found || dem.northSpacing < found->lit->lighting().tile().northSpacing;
            if (lit == isLit ? isFiner : lit)
            {
                found = &tile;
                isLit = lit;
            }
        });
    return found;
}

/// Of the ground below a place: its height at the origin of a volume, above that, and its slopes to
/// the east and north.
osg::Vec3f groundPlane(const SceneTile& tile, const osg::Vec3d& place, const glm::dvec3& origin)
{
    const DemTile& dem = tile.lit->lighting().tile();
    const LitTile::Margin& margin = tile.lit->margin();
    // Of the lit tile's post (0, 0).
    const osg::Vec3d corner(tile.corner->x() - margin.west * tile.spacing.x(),
                            tile.corner->y() - margin.south * tile.spacing.y(),
                            tile.corner->z() + dem.heightOrigin);
    const auto postBefore = [](double at, int count)
    { return std::clamp(static_cast<int>(std::floor(at)), 0, std::max(count - 2, 0)); };
    const int column = postBefore((place.x() - corner.x()) / tile.spacing.x(), dem.width());
    const int row = postBefore((place.y() - corner.y()) / tile.spacing.y(), dem.height());
    const auto height = [&](int east, int north)
    {
        return dem.isValid(column + east, row + north)
                   ? double(dem.heightAt(column + east, row + north))
                   : place.z() - corner.z();
    };
    const double east = (height(1, 0) - height(0, 0)) / tile.spacing.x();
    const double north = (height(0, 1) - height(0, 0)) / tile.spacing.y();
    const double up = corner.z() + height(0, 0) - origin.z +
                      east * (origin.x - corner.x() - column * tile.spacing.x()) +
                      north * (origin.y - corner.y() - row * tile.spacing.y());
    return {static_cast<float>(up), static_cast<float>(east), static_cast<float>(north)};
}

/// With the maps of a probe.
osg::ref_ptr<osg::StateSet> stateSetOf(const LightProbe& probe, bool hasVolume)
{
    const osg::ref_ptr<osg::StateSet> made = new osg::StateSet;
    made->setTextureAttribute(LightProbe::diffuseUnit, probe.getDiffuseMap());
    made->setTextureAttribute(LightProbe::glossyUnit, probe.getGlossyMap());
    made->addUniform(new osg::Uniform("osgTerrainLight_objectLit", true));
    made->addUniform(new osg::Uniform("osgTerrainLight_hasObjectVolume", hasVolume));
    return made;
}

void addVolume(osg::StateSet& stateSet, osg::Texture& volume, const ObjectCluster& cluster)
{
    stateSet.setTextureAttribute(PlacedObject::volumeUnit, &volume);
    const osg::ref_ptr<osg::Uniform> field =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, "osgTerrainLight_objectField", 3);
    field->setElement(0, vector(cluster.voxel * glm::dvec3(cluster.voxels), cluster.voxel));
    field->setElement(
        1, vector(cluster.content.low - cluster.origin, cluster.voxel * ObjectCluster::reach));
    field->setElement(2, vector(cluster.content.high - cluster.origin, 0.0));
    stateSet.addUniform(field);
}

/// What objects send.
void addLight(osg::StateSet& stateSet, const TileLight::ObjectRadiosity& radiosity,
              const osg::Vec3f& plane, const std::vector<ObjectLamp>& lamps)
{
    stateSet.addUniform(
        new osg::Uniform("osgTerrainLight_hasObjectRadiosity", radiosity.sent.valid()));
    if (radiosity.sent)
    {
        stateSet.setTextureAttribute(PlacedObject::radiosityUnit, radiosity.sent);
        stateSet.setTextureAttribute(PlacedObject::groundUnit, radiosity.groundShare);
        stateSet.addUniform(new osg::Uniform("osgTerrainLight_objectPlane", plane));
    }
    for (const auto& uniform : lampUniforms(lamps, "osgTerrainLight_"))
        stateSet.addUniform(uniform);
}

} // namespace

ObjectState::ObjectState() : program(new osg::StateSet), programOnly(new osg::StateSet)
{
    const osg::ref_ptr<osg::Program> shared = createObjectProgram();
    for (const auto& stateSet : {program, programOnly})
    {
        stateSet->setAttribute(shared);
        stateSet->addUniform(new osg::Uniform("osgTerrainLight_colour", 0));
    }
    program->setTextureAttribute(0, createWhite());
    set(0.0, 16);
}

void ObjectState::set(double sunRadius, int coneCount)
{
    if (sunRadius == _sunRadius && coneCount == _coneCount)
        return;
    _sunRadius = sunRadius;
    _coneCount = coneCount;
    const ConeSet set = ConeSet::of(coneCount);
    const osg::ref_ptr<osg::Uniform> axes =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, "osgTerrainLight_objectCones",
                         static_cast<int>(ConeSet::most + 2));
    const osg::ref_ptr<osg::Uniform> around =
        new osg::Uniform(osg::Uniform::UNSIGNED_INT, "osgTerrainLight_objectAround",
                         static_cast<int>(ConeSet::most));
    unsigned next = 0;
    for (const std::array<float, 4>& each : set.packed())
        axes->setElement(next++, osg::Vec4f(each[0], each[1], each[2], each[3]));
    for (unsigned i = 0; i < set.cones.size(); ++i)
        around->setElement(i, set.cones[i].around);
    cones = new osg::StateSet;
    cones->addUniform(axes);
    cones->addUniform(around);
    cones->addUniform(new osg::Uniform("osgTerrainLight_sunSine",
                                       static_cast<float>(std::sin(sunRadius * radiansPerDegree))));
    cones->addUniform(
        new osg::Uniform(LightProbe::diffuseSampler, static_cast<int>(LightProbe::diffuseUnit)));
    cones->addUniform(
        new osg::Uniform(LightProbe::glossySampler, static_cast<int>(LightProbe::glossyUnit)));
    cones->addUniform(
        new osg::Uniform(PlacedObject::volumeSampler, static_cast<int>(PlacedObject::volumeUnit)));
    cones->addUniform(new osg::Uniform(PlacedObject::radiositySampler,
                                       static_cast<int>(PlacedObject::radiosityUnit)));
    cones->addUniform(
        new osg::Uniform(PlacedObject::groundSampler, static_cast<int>(PlacedObject::groundUnit)));
    cones->addUniform(new osg::Uniform("osgTerrainLight_objectLit", false));
    cones->setMode(GL_TEXTURE_CUBE_MAP_SEAMLESS, osg::StateAttribute::ON);
}

bool ObjectSurface::Light::isAs(const Light& other) const
{
    return node == other.node && radiosity == other.radiosity && lamps == other.lamps &&
           (plane - other.plane).length() < 0.01f && content.low == other.content.low &&
           content.high == other.content.high;
}

const ObjectSurface::Light* ObjectSurface::lightIn(unsigned context) const
{
    if (!_state->lit || !_probe || !_probed->has(context))
        return nullptr;
    for (const Light* light : {&_own, &_former})
        if (light->node && light->stateSet && light->node->isWritten(context))
            return light;
    return &_open;
}

int ObjectSurface::push(osgUtil::CullVisitor& cull, bool isBelow) const
{
    int pushed = 0;
    const auto push = [&](const osg::StateSet* stateSet)
    {
        cull.pushStateSet(stateSet);
        ++pushed;
    };
    using Attribute = osg::StateAttribute;
    const bool hasProgram = above(cull, Attribute::PROGRAM, false);
    const bool hasTexture = above(cull, Attribute::TEXTURE, true);
    const auto* material =
        dynamic_cast<const osg::Material*>(above(cull, Attribute::MATERIAL, false));
    if (!isBelow && _state->scene)
        push(_state->scene);
    push(_state->cones);
    const osg::State* state = cull.getState();
    const Light* light = state ? lightIn(state->getContextID()) : nullptr;
    if (!light)
        return pushed;
    if (_state->defaultProgram && !hasProgram)
        push(hasTexture ? _state->programOnly : _state->program);
    push(light->stateSet);

    // From eye coordinates to the volume's: as the object stands for this camera, so that a camera
    // far from the origin costs no digits.
    const osg::Matrixd fromEye = osg::Matrixd::inverse(*cull.getModelViewMatrix()) * toScene *
                                 osg::Matrixd::translate(-light->origin);
    const bool ownColour = _materials == Materials::Own ||
                           (_materials == Materials::None && material && isOwnColour(*material));
    const osg::ref_ptr<osg::StateSet> here = new osg::StateSet;
    here->addUniform(new osg::Uniform("osgTerrainLight_objectFromEye", osg::Matrixf(fromEye)));
    here->addUniform(new osg::Uniform("osgTerrainLight_materialColour", ownColour));
    here->addUniform(new osg::Uniform("osgTerrainLight_objectEmission", _emission));
    push(here);
    return pushed;
}

/// The surface that the object had before at this place among its places, which is taken from
/// those; or a new one.
osg::ref_ptr<ObjectSurface> ObjectSurfaces::surfaceOf(const Seen& seen,
                                                      std::vector<Object>& before) const
{
    for (Object& each : before)
        if (each.surface && each.object.get() == seen.object.get())
        {
            osg::ref_ptr<ObjectSurface> surface;
            surface.swap(each.surface);
            return surface;
        }
    const osg::ref_ptr<ObjectSurface> surface = new ObjectSurface;
    surface->_state = _state;
    return surface;
}

void ObjectSurfaces::followProbe(ObjectSurface& surface, const ObjectBounds& bounds,
                                 const TileRegistry& tiles, ProbeList& probes)
{
    const osg::Vec3d middle = vector(0.5 * (bounds.low + bounds.high));
    const bool isAtRest = middle == surface._middle;
    surface._middle = middle;
    const SceneTile* tile = tileAt(middle, tiles);
    if (!tile)
    {
        if (surface._probe)
            probes.remove(surface._probe);
        surface._probe = nullptr;
        return;
    }
    const bool isNew = !surface._probe;
    if (isNew)
    {
        surface._probe = new LightProbe;
        surface._probed = std::make_shared<ContextSet>();
    }
    const glm::dvec3 size = bounds.high - bounds.low;
    const double moved = (middle - surface._probePlace).length();
    const bool isOtherTile = isNew || surface._tile != tile->handle;
    osg::Vec3d corner = *tile->corner;
    corner.z() += tile->lit->lighting().tile().heightOrigin;
    if (isOtherTile || corner != surface._probeCorner ||
        moved > movesBy * std::max({size.x, size.y, size.z}) || (isAtRest && moved > 0.0))
    {
        surface._probePlace = middle;
        surface._probeCorner = corner;
        const osg::Vec3d place = middle - corner;
        // A probe counts metres of its row, which is drawn with another spacing.
        const DemTile& dem = tile->lit->lighting().tile();
        const double row =
            tile->lit->margin().south +
            std::clamp(place.y() / tile->spacing.y(), 0.0, tile->lit->drawnHeight() - 1.0);
        surface._probe->setPlace(place.x() / tile->spacing.x() *
                                     dem.eastSpacing(static_cast<int>(row + 0.5)),
                                 place.y() / tile->spacing.y() * dem.northSpacing);
        surface._probe->setHeight(place.z(), false);
    }
    if (!isOtherTile)
        return;
    if (!isNew)
        probes.remove(surface._probe);
    probes.add(*surface._probe, tile->handle, surface._probed);
    surface._tile = tile->handle;
}

/// Whether there is a probe; its maps are in the light without a volume.
bool ObjectSurfaces::followOpen(ObjectSurface& surface)
{
    if (!surface._probe)
    {
        surface._own = surface._former = surface._open = {};
        return false;
    }
    const osg::StateSet* before = surface._open.stateSet;
    const osg::Texture* map = surface._probe->getDiffuseMap();
    if (before &&
        before->getTextureAttribute(LightProbe::diffuseUnit, osg::StateAttribute::TEXTURE) == map)
        return true;
    surface._own = surface._former = surface._open = {};
    surface._open.stateSet = stateSetOf(*surface._probe, false);
    surface._open.origin = surface._middle;
    return true;
}

void ObjectSurfaces::followVolume(ObjectSurface& surface, const Seen& seen,
                                  const ObjectLight& light, const TileRegistry& tiles)
{
    if (!followOpen(surface))
        return;
    const auto holds = [&](const ObjectLight::Placed& placed)
    {
        const auto& shapes = placed.cluster.shapes;
        return seen.shape && std::find(shapes.begin(), shapes.end(), *seen.shape) != shapes.end();
    };
    const auto found = std::find_if(light.placed().begin(), light.placed().end(), holds);
    if (found == light.placed().end())
    {
        surface._own = surface._former = {};
        return;
    }
    // The one before is read until the own one is there.
    if (found->node != surface._own.node && surface._own.stateSet)
        surface._former = surface._own;
    else if (surface._former.node && surface._own.stateSet &&
             found->node->isWrittenWhere(*surface._former.node))
        surface._former = {};
    ObjectSurface::Light now;
    now.node = found->node;
    now.lamps = found->lamps;
    now.content = found->cluster.content;
    now.origin = vector(found->cluster.origin);
    Resource& volume = *found->node->volume();
    if (const SceneTile* tile = tiles.find(surface._tile); tile && tile->lit)
        now.radiosity = tile->lit->lighting().objectRadiosity(volume, tile->lit->litContexts());
    if (now.radiosity.sent)
        now.plane = groundPlane(*tiles.find(surface._tile), surface._middle, found->cluster.origin);
    if (surface._own.stateSet && now.isAs(surface._own))
        return;
    if (volume.texture()) // else not computed anywhere yet
    {
        now.stateSet = stateSetOf(*surface._probe, true);
        addVolume(*now.stateSet, *volume.texture(), found->cluster);
        addLight(*now.stateSet, now.radiosity, now.plane, now.lamps);
    }
    surface._own = now;
}

void ObjectSurfaces::follow(const std::vector<Seen>& seen, const ObjectLight& light,
                            const TileRegistry& tiles, ProbeList& probes)
{
    std::vector<Object> before;
    before.swap(_objects);
    for (const Seen& each : seen)
    {
        const osg::ref_ptr<ObjectSurface> surface = surfaceOf(each, before);
        surface->toScene = each.toScene;
        surface->_emission = each.object->getEmission();
        using Materials = ObjectSurface::Materials;
        surface->_materials = each.ownMaterials   ? Materials::Own
                              : each.hasMaterials ? Materials::Colours
                                                  : Materials::None;
        followProbe(*surface, each.bounds, tiles, probes);
        followVolume(*surface, each, light, tiles);
        _objects.push_back({each.object.get(), surface});
    }
    for (const Object& gone : before)
        if (gone.surface && gone.surface->_probe)
            probes.remove(gone.surface->_probe);
}

void ObjectSurfaces::releaseGLObjects(osg::State* state) const
{
    _state->program->releaseGLObjects(state);
    for (const Object& each : _objects)
        if (const LightProbe* probe = each.surface->_probe)
        {
            each.surface->_former = {}; // its volume is gone
            each.surface->_probed->remove(state ? state->getContextID() : ~0u);
            probe->getDiffuseMap()->releaseGLObjects(state);
            probe->getGlossyMap()->releaseGLObjects(state);
        }
}

void ObjectSurfaces::resizeGLObjectBuffers(unsigned size)
{
    _state->program->resizeGLObjectBuffers(size);
    for (const Object& each : _objects)
        if (const LightProbe* probe = each.surface->_probe)
        {
            probe->getDiffuseMap()->resizeGLObjectBuffers(size);
            probe->getGlossyMap()->resizeGLObjectBuffers(size);
        }
}

} // namespace osgTerrainLight
