#pragma once

#include "gpu/ContextSet.h"
#include "lighting/ObjectLight.h"
#include "scene/ProbeList.h"
#include "scene/TileRegistry.h"
#include <osgTerrainLight/LightProbe.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/SkyLight.h>

#include <osg/Matrixd>
#include <osg/observer_ptr>
#include <osgUtil/CullVisitor>

#include <memory>
#include <optional>
#include <vector>

namespace osgTerrainLight
{

/// What the surfaces of all objects of a TerrainLighting are lit with. Its StateSets are replaced,
/// never changed: threads that draw the frame before still read the old ones.
class ObjectState : public osg::Referenced
{
public:
    ObjectState();

    /// Of the TerrainLighting, for objects that are not below it.
    osg::ref_ptr<osg::StateSet> scene;
    /// Cones and samplers: on all objects, lit or not, so that shaders of hosts find their units.
    osg::ref_ptr<osg::StateSet> cones;
    /// The default program, and white where an object has no texture; white only where a node above
    /// has one, too.
    osg::ref_ptr<osg::StateSet> program, programOnly;
    bool lit = true;            ///< the light is on
    bool defaultProgram = true; ///< and objects without shaders get one

    void set(double sunRadius, int coneCount);

private:
    ~ObjectState() override = default;

    double _sunRadius = -1.0; ///< [degrees]
    int _coneCount = 0;
};

/// A placed object at one of its places, as it is lit.
class ObjectSurface : public osg::Referenced
{
public:
    osg::Matrixd toScene; ///< from the object's frame to that of TerrainLighting [m]

    /// In cull traversal, of the object: puts on all below it what lights it. Gives the number of
    /// StateSets that the caller pops. isBelow: it stands below its TerrainLighting.
    int push(osgUtil::CullVisitor& cull, bool isBelow) const;

private:
    friend class ObjectSurfaces;
    ~ObjectSurface() override = default;

    /// With a volume that the object is in; without one: no node.
    struct Light
    {
        osg::ref_ptr<osg::StateSet> stateSet;
        osg::ref_ptr<const ObjectVolumeNode> node;
        TileLight::ObjectRadiosity radiosity; ///< of the volume
        std::vector<ObjectLamp> lamps;        ///< in it
        osg::Vec3f plane;                     ///< of the ground, where there is radiosity
        ObjectBounds content;                 ///< of the volume
        osg::Vec3d origin;                    ///< of the volume, in the scene

        /// Drawn with the same, but for a centimetre of the ground.
        bool isAs(const Light& other) const;
    };
    const Light* lightIn(unsigned context) const;

    osg::ref_ptr<const ObjectState> _state;
    osg::ref_ptr<LightProbe> _probe; ///< null where there is no tile below it
    std::shared_ptr<ContextSet> _probed;
    TileHandle _tile;
    osg::Vec3d _probePlace, _middle; ///< of the probe, and of the object at the last update
    osg::Vec3d _probeCorner; ///< of the tile's post (0, 0) at its heightOrigin, for the probe
    /// In its volume; in the one before, until that is there; and without one.
    Light _own, _former, _open;
    osg::Vec3f _emission;
    enum class Materials
    {
        None,
        Colours, ///< those of vertices count
        Own      ///< a material's colour counts
    } _materials = Materials::None;
};

/// The surfaces of the objects of a TerrainLighting, each with a LightProbe that is kept where the
/// object is. In update traversal.
class ObjectSurfaces
{
public:
    ObjectSurfaces() : _state(new ObjectState) {}

    struct Seen
    {
        osg::ref_ptr<PlacedObject> object;
        osg::Matrixd toScene;
        ObjectBounds bounds;              ///< in the scene
        std::optional<ObjectShape> shape; ///< as it is among those of the clusters
        bool hasMaterials = false, ownMaterials = false;
    };
    struct Object
    {
        osg::observer_ptr<PlacedObject> object;
        osg::ref_ptr<ObjectSurface> surface;
    };

    /// All objects that there are, in the order that they were met in.
    void follow(const std::vector<Seen>& seen, const ObjectLight& light, const TileRegistry& tiles,
                ProbeList& probes);
    const std::vector<Object>& objects() const { return _objects; }
    ObjectState& state() { return *_state; }

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    osg::ref_ptr<ObjectSurface> surfaceOf(const Seen& seen, std::vector<Object>& before) const;
    static void followProbe(ObjectSurface& surface, const ObjectBounds& bounds,
                            const TileRegistry& tiles, ProbeList& probes);
    static bool followOpen(ObjectSurface& surface);
    static void followVolume(ObjectSurface& surface, const Seen& seen, const ObjectLight& light,
                             const TileRegistry& tiles);

    osg::ref_ptr<ObjectState> _state;
    std::vector<Object> _objects;
};

} // namespace osgTerrainLight
