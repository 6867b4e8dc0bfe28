#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/Group>
#include <osg/Shader>
#include <osg/Vec3f>

#include <memory>
#include <optional>

namespace osgTerrainLight
{

/// An object on terrain, as a house, a tree or a vehicle: the ground around it gets less sky light,
/// has its shadow and, with LightingSettings::bounces, the light that it sends. It is the group of
/// what is drawn, and stands anywhere below a TerrainLighting, or elsewhere in the scene and is
/// given to TerrainLighting::addObject(). It may move in every frame, by any transform above it.
///
/// What it does to light is computed from a distance field. Its own surfaces are lit, too, where
/// the middle of its bounds is over a tile that is lit: by a light probe in that middle, which
/// TerrainLighting makes, and by what the field of all objects around leaves of its light. Parts
/// without a shader, below and above, get a default program, which takes the colours of vertices or
/// of the osg::Material, as the material's colour mode says, and the texture of unit 0.
/// TerrainLighting::setDefaultProgramEnabled() switches it off. Other shaders may call
/// terrain_objects.glsl. Nothing is put on the application's StateSets.
///
/// Call all methods where the scene graph may be changed: in the update or event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT PlacedObject : public osg::Group
{
public:
    PlacedObject();
    PlacedObject(const PlacedObject& other, const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, PlacedObject);

    /// What the distances are to. Box, Ellipsoid and Cylinder are about the bounding box of what is
    /// below, whose axes are this node's.
    enum class Field
    {
        /// Box, ellipsoid or cylinder where a single osg::Box, osg::Sphere or osg::Cylinder is
        /// drawn below, whose place is not turned, and HeightField where a single osg::HeightField
        /// is; else Mesh.
        Automatic,
        Box,
        Ellipsoid,
        /// About z.
        Cylinder,
        /// The triangles below, sampled once, in a thread of its own. Parts may overlap, and need
        /// not be closed. It is a box until that is done, and where the library was built without
        /// Embree.
        Mesh,
        /// It changes no light; its surfaces are lit by the probe alone.
        None,
        /// A body whose surface is met once in each direction from some place within: a blob. This
        /// and the following are for forms that change in every frame, by vertices or by parts that
        /// move: the triangles below are looked at in each update, and sampled where they have
        /// changed. What only a shader deforms is not seen.
        Star,
        /// What is below as seen from above (z of this node), solid down to the bottom of its box.
        HeightField,
        /// What is below as seen from above and from below, solid in between: a floating rock, a
        /// crown.
        TwoHeightFields
    };
    /// The default is Automatic.
    void setField(Field field);
    Field getField() const;

    /// Says that what is below has changed its form, or its materials. Without it only a change of
    /// the bounding sphere is seen; of Star, HeightField and TwoHeightFields every change of form
    /// is.
    void dirtyField();

    /// Sets the albedo of its surfaces, linear, 0 … 1 in each colour: with
    /// LightingSettings::bounces they send that part of their light to the ground and to other
    /// objects. Nothing: the mean of what is drawn, of the colours of vertices or of the
    /// osg::Material below this node, times the texture of unit 0; white where a picture cannot be
    /// read. That is the default. Other numbers are refused with a warning.
    void setAlbedo(const std::optional<osg::Vec3f>& albedo);
    std::optional<osg::Vec3f> getAlbedo() const;

    /// Sets what its surfaces emit, as those of a lamp: radiance in each colour, ≥ 0, by default 0.
    /// It lights the ground around and the objects near it, as a sphere of its surface would, with
    /// their shadows, and the default program adds it to its own surface. It should be about as
    /// long as wide, and lights up to 48 m. Up to 16 objects in 32 m may emit. Ground must have
    /// some other light, that of dusk at least: what objects do to its light is a factor. Other
    /// numbers are refused with a warning.
    void setEmission(const osg::Vec3f& radiance);
    const osg::Vec3f& getEmission() const;

    /// The texture units of the volume of distances, of what objects send and of what they leave
    /// of the ground's light, and the samplers that read them. The maps of the probe are in
    /// LightProbe::diffuseUnit and glossyUnit.
    static constexpr unsigned volumeUnit = 12;
    static constexpr const char* volumeSampler = "osgTerrainLight_objectVolume";
    static constexpr unsigned radiosityUnit = 13;
    static constexpr const char* radiositySampler = "osgTerrainLight_objectRadiosity";
    static constexpr unsigned groundUnit = 14;
    static constexpr const char* groundSampler = "osgTerrainLight_objectGround";

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

/// Makes terrain_objects.glsl, and the library that it calls, a shader that an application adds to
/// its own program for placed objects. It has vec4 terrainObjectLight(vec3 place, vec3 normal).
/// version: of GLSL, as in #version, ≥ 330.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createObjectShader(osg::Shader::Type type,
                                                                    int version = 330);

} // namespace osgTerrainLight
