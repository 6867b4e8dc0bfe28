#pragma once

#include "fields/ObjectShape.h"
#include "scene/MeshFields.h"
#include <osgTerrainLight/PlacedObject.h>

#include <osg/Material>
#include <osg/Matrixd>

#include <memory>
#include <optional>
#include <vector>

namespace osgTerrainLight
{

/// The same matrix.
glm::dmat4 toGlm(const osg::Matrixd& matrix);

/// Whether the colour of surfaces is that of the material, not that of vertices.
bool isOwnColour(const osg::Material& material);

/// The shape of an object in its own frame, made from what is drawn below it. In update traversal.
class ObjectField
{
public:
    PlacedObject::Field field = PlacedObject::Field::Automatic;
    std::optional<osg::Vec3f> albedo; ///< nothing: of what is drawn
    osg::Vec3f emission;              ///< radiance

    void dirty() { _isDirty = true; }
    bool isReady() const { return !_isDirty && !_isMesh && !_sampling; }

    /// As it is now; none where there is nothing to be seen, or none is wanted.
    std::optional<ObjectShape> shape(osg::Group& object);

    /// As of the last shape(): whether there are materials below, and whether the colours of some
    /// are their own.
    bool hasMaterials() const { return _hasMaterials; }
    bool ownMaterials() const { return _ownMaterials; }

private:
    void make(osg::Group& object);
    void followSolid(osg::Group& object);
    void followForm(osg::Group& object);
    void sampleForm(osg::Group& object, PlacedObject::Field as);
    void startSampling(osg::Group& object);
    void takeSampled();

    /// A mesh is sampled once its form has stood still for so many updates, and is a box until
    /// then: one with parts that turn would be sampled in each.
    static constexpr int updatesToSample = 10;

    bool _isDirty = true;
    bool _isMesh = false; ///< that is not sampled yet
    int _still = 0;       ///< updates
    osg::Vec3d _middle;   ///< that the mesh is sampled about: a frame may be far from its origin
    bool _hasMaterials = false, _ownMaterials = false;
    glm::dvec3 _drawnAlbedo{1.0};
    osg::BoundingSphere _bound; ///< of the object, when the shape was made
    std::optional<ObjectShape> _shape;
    std::vector<glm::vec3> _sampled; ///< corners of the triangles that the form was made of
    std::shared_ptr<const MeshSampling> _sampling; ///< null: it is no mesh, or has been taken
};

} // namespace osgTerrainLight
