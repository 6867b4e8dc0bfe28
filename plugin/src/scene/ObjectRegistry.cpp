#include "scene/ObjectRegistry.h"

#include "scene/ObjectField.h"
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Transform>

#include <algorithm>

namespace osgTerrainLight
{

struct PlacedObject::Implementation
{
    ObjectField field;
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

void PlacedObject::dirtyField()
{
    _implementation->field.dirty();
}

bool PlacedObject::isFieldReady() const
{
    return _implementation->field.isReady();
}

void PlacedObject::traverse(osg::NodeVisitor& visitor)
{
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
    std::optional<ObjectShape> shape = object._implementation->field.shape(object);
    if (!shape)
        return;
    shape->toScene = toGlm(toScene) * shape->toScene;
    _seen.push_back(std::move(*shape));
}

bool ObjectRegistry::follow(ObjectLight& light, const TileRegistry& tiles, const osg::Group& root,
                            const SkyLight& sky)
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
    shapes.swap(_seen);
    _count = shapes.size();
    bool changed = light.set(shapes);
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
            const glm::dvec3 corner(tile.corner->x() - margin.west * dem.nominalEastSpacing(),
                                    tile.corner->y() - margin.south * dem.northSpacing,
                                    tile.corner->z() + dem.heightOrigin);
            changed = ground.setObjects(objectsOn(light.placed(), corner, dem, shadows)) || changed;
        });
    if (light.placed().empty())
        _told.clear();
    return changed;
}

} // namespace osgTerrainLight
