#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/Group>

#include <memory>

namespace osgTerrainLight
{

/// An object on terrain, as a house, a tree or a vehicle: the ground around it gets less sky light
/// and has its shadow. It is the group of what is drawn, and stands anywhere below a
/// TerrainLighting, or elsewhere in the scene and is given to TerrainLighting::addObject(). It may
/// move in every frame, by any transform above it.
///
/// What it does to light is computed from a distance field. Its own surfaces are drawn as they are:
/// a LightProbe lights them.
///
/// Call all methods where the scene graph may be changed: in the update or event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT PlacedObject : public osg::Group
{
public:
    PlacedObject();
    PlacedObject(const PlacedObject& other, const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, PlacedObject);

    /// What the distances are to. All but Mesh are about the bounding box of what is below, whose
    /// axes are this node's.
    enum class Field
    {
        /// Box, ellipsoid or cylinder where a single osg::Box, osg::Sphere or osg::Cylinder is
        /// drawn below, whose place is not turned; else Mesh.
        Automatic,
        Box,
        Ellipsoid,
        Cylinder, ///< About z.
                  /// The triangles below, sampled once, in a thread of its own. Parts may overlap,
                  /// and need not be closed. It is a box until that is done, and where the library
                  /// was built without Embree.
        Mesh,
        None ///< It changes no light.
    };
    /// The default is Automatic.
    void setField(Field field);
    Field getField() const;

    /// Says that what is below has changed its form. Children that come and go are seen without.
    void dirtyField();

    /// Whether its distances are those that the field asks for: a mesh has been sampled.
    bool isFieldReady() const;

    void traverse(osg::NodeVisitor& visitor) override;

protected:
    ~PlacedObject() override;

private:
    friend class ObjectRegistry;
    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

} // namespace osgTerrainLight
