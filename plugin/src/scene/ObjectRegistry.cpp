#include "scene/ObjectRegistry.h"

#include "scene/ObjectField.h"
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Transform>
#include <osgUtil/CullVisitor>

#include <osg/Notify>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr double largest = 1.0e5; ///< side of an object [m]
} // namespace

struct PlacedObject::Implementation
{
    ObjectField field;
    /// At its places below a TerrainLighting, or in the scene where that was given it.
    std::map<const osg::Group*, std::vector<osg::ref_ptr<ObjectSurface>>> surfaces;

    /// What lights it where the cull traversal is now; null where nothing does.
    const ObjectSurface* surfaceAt(const osg::NodePath& path, bool& isBelow) const;
};

PlacedObject::PlacedObject() : _implementation(new Implementation)
{
    setNumChildrenRequiringUpdateTraversal(1);
}

PlacedObject::PlacedObject(const PlacedObject& other, const osg::CopyOp& copyop)
    : osg::Group(other, copyop), _implementation(new Implementation)
{
    setNumChildrenRequiringUpdateTraversal(getNumChildrenRequiringUpdateTraversal() + 1);
    _implementation->field.field = other.getField();
    _implementation->field.albedo = other.getAlbedo();
    _implementation->field.emission = other.getEmission();
}

PlacedObject::~PlacedObject() = default;

void PlacedObject::setField(Field field)
{
    if (field == getField())
        return;
    _implementation->field.field = field;
    dirtyField();
}

PlacedObject::Field PlacedObject::getField() const
{
    return _implementation->field.field;
}

void PlacedObject::setAlbedo(const std::optional<osg::Vec3f>& albedo)
{
    if (albedo)
        for (int i = 0; i < 3; ++i)
            if (!((*albedo)[i] >= 0.0f && (*albedo)[i] <= 1.0f))
            {
                OSG_WARN << "osgTerrainLight: albedo of object '" << getName()
                         << "' not set: needs 0 ... 1" << std::endl;
                return;
            }
    _implementation->field.albedo = albedo;
}

std::optional<osg::Vec3f> PlacedObject::getAlbedo() const
{
    return _implementation->field.albedo;
}

void PlacedObject::setEmission(const osg::Vec3f& radiance)
{
    for (int i = 0; i < 3; ++i)
        if (!(radiance[i] >= 0.0f && std::isfinite(radiance[i])))
        {
            OSG_WARN << "osgTerrainLight: emission of object '" << getName()
                     << "' not set: needs 0 or more" << std::endl;
            return;
        }
    _implementation->field.emission = radiance;
}

const osg::Vec3f& PlacedObject::getEmission() const
{
    return _implementation->field.emission;
}

void PlacedObject::dirtyField()
{
    _implementation->field.dirty();
}

bool PlacedObject::isFieldReady() const
{
    return _implementation->field.isReady();
}

const ObjectSurface* PlacedObject::Implementation::surfaceAt(const osg::NodePath& path,
                                                             bool& isBelow) const
{
    if (surfaces.empty())
        return nullptr;
    const auto root = std::find_if(path.rbegin(), path.rend(),
                                   [](const osg::Node* node)
                                   { return dynamic_cast<const TerrainLighting*>(node); });
    isBelow = root != path.rend();
    const auto found = isBelow ? surfaces.find((*root)->asGroup()) : surfaces.begin();
    if (found == surfaces.end() || found->second.empty())
        return nullptr;
    if (found->second.size() == 1 || !isBelow)
        return found->second.front();
    const osg::Matrixd toScene = osg::computeLocalToWorld(osg::NodePath(root.base(), path.end()));
    for (const auto& surface : found->second)
        if (surface->toScene == toScene)
            return surface;
    return nullptr;
}

void PlacedObject::traverse(osg::NodeVisitor& visitor)
{
    if (osgUtil::CullVisitor* cull = visitor.asCullVisitor())
    {
        bool isBelow = false;
        const ObjectSurface* surface = _implementation->surfaceAt(visitor.getNodePath(), isBelow);
        const int pushed = surface ? surface->push(*cull, isBelow) : 0;
        osg::Group::traverse(visitor);
        for (int i = 0; i < pushed; ++i)
            cull->popStateSet();
        return;
    }
    osg::Group::traverse(visitor);
    if (visitor.getVisitorType() != osg::NodeVisitor::UPDATE_VISITOR)
        return;
    const osg::NodePath& path = visitor.getNodePath();
    for (auto node = path.rbegin(); node != path.rend(); ++node)
        if (auto* lighting = dynamic_cast<TerrainLighting*>(*node))
        {
            // Transforms below the lighting; the object is the last of the path.
            const osg::NodePath below(node.base(), path.end());
            lighting->see(*this, osg::computeLocalToWorld(below));
            return;
        }
}

bool ObjectRegistry::add(PlacedObject& object)
{
    if (std::find(_given.begin(), _given.end(), &object) != _given.end())
        return false;
    _given.emplace_back(&object);
    return true;
}

bool ObjectRegistry::remove(const PlacedObject* object)
{
    const auto found = std::find(_given.begin(), _given.end(), object);
    if (found == _given.end())
        return false;
    _given.erase(found);
    return true;
}

void ObjectRegistry::see(PlacedObject& object, const osg::Matrixd& toScene)
{
    ObjectField& field = object._implementation->field;
    ObjectSurfaces::Seen seen;
    seen.object = &object;
    seen.toScene = toScene;
    seen.shape = field.shape(object);
    seen.hasMaterials = field.hasMaterials();
    seen.ownMaterials = field.ownMaterials();
    const osg::BoundingSphere& bound = object.getBound();
    if (seen.shape)
    {
        seen.shape->toScene = toGlm(toScene) * seen.shape->toScene;
        seen.bounds = boundsOf(*seen.shape);
        // What is not finite, or larger than any object, would take the others with it.
        const glm::dvec3 size = seen.bounds.high - seen.bounds.low;
        const double longest = std::max({size.x, size.y, size.z});
        if (!(std::isfinite(seen.bounds.low.x + seen.bounds.low.y + seen.bounds.low.z) &&
              longest >= 0.0 && longest <= largest))
        {
            if (!std::exchange(_saidSize, true))
                OSG_WARN << "osgTerrainLight: object '" << object.getName()
                         << "' changes no light: its place is not finite, or it is larger than "
                         << largest << " m" << std::endl;
            return;
        }
    }
    else if (bound.valid())
    {
        const osg::Vec3d middle = osg::Vec3d(bound.center()) * toScene;
        const glm::dvec3 at(middle.x(), middle.y(), middle.z());
        seen.bounds = {at - double(bound.radius()), at + double(bound.radius())};
    }
    else
        return;
    _seen.push_back(std::move(seen));
}

ObjectRegistry::~ObjectRegistry()
{
    takeSurfaces();
}

void ObjectRegistry::takeSurfaces()
{
    for (const ObjectSurfaces::Object& each : _surfaces.objects())
        if (osg::ref_ptr<PlacedObject> object; each.object.lock(object))
            object->_implementation->surfaces.erase(_root);
}

void ObjectRegistry::giveSurfaces(const osg::Group* root)
{
    _root = root;
    for (const ObjectSurfaces::Object& each : _surfaces.objects())
        each.object->_implementation->surfaces[root].push_back(each.surface);
}

bool ObjectRegistry::follow(ObjectLight& light, const TileRegistry& tiles, ProbeList& probes,
                            const osg::Group& root, const SkyLight& sky)
{
    const auto toWorld = [](const osg::Node& node)
    {
        const osg::MatrixList matrices = node.getWorldMatrices();
        return matrices.empty() ? osg::Matrixd() : matrices.front();
    };
    if (!_given.empty())
    {
        const osg::Matrixd toScene = osg::Matrixd::inverse(toWorld(root));
        for (const auto& object : _given)
            see(*object, toWorld(*object) * toScene);
    }
    std::vector<ObjectShape> shapes;
    for (const ObjectSurfaces::Seen& seen : _seen)
        if (seen.shape)
            shapes.push_back(*seen.shape);
    _count = shapes.size();
    bool changed = light.set(shapes);
    takeSurfaces();
    _surfaces.follow(_seen, light, tiles, probes);
    giveSurfaces(&root);
    _seen.clear();
    if (light.placed().empty() && !changed)
        return false;
    const glm::dvec2 shadows = shadowReach(sky);
    const bool all = changed || shadows != _shadows;
    _shadows = shadows;
    tiles.forEach(
        [&](const SceneTile& tile)
        {
            if (!tile.lit || !tile.corner)
                return;
            osg::observer_ptr<LitTile>& told = _told[tile.handle];
            if (!all && told.get() == tile.lit)
                return;
            told = tile.lit.get();
            TileLight& ground = tile.lit->lighting();
            // Of what is lit, which may reach beyond what is drawn.
            const DemTile& dem = ground.tile();
            const LitTile::Margin& margin = tile.lit->margin();
            const glm::dvec2 spacing(tile.spacing.x(), tile.spacing.y());
            const glm::dvec3 corner(tile.corner->x() - margin.west * spacing.x,
                                    tile.corner->y() - margin.south * spacing.y,
                                    tile.corner->z() + dem.heightOrigin);
            changed = ground.setObjects(objectsOn(light.placed(), corner, dem, spacing, shadows)) ||
                      changed;
        });
    for (auto told = _told.begin(); told != _told.end();)
        told =
            light.placed().empty() || !told->second.valid() ? _told.erase(told) : std::next(told);
    return changed;
}

} // namespace osgTerrainLight
