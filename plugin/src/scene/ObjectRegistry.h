#pragma once

#include "lighting/ObjectLight.h"
#include "scene/ObjectSurfaces.h"
#include "scene/TileRegistry.h"
#include <osgTerrainLight/PlacedObject.h>

#include <osg/Matrixd>
#include <osg/observer_ptr>

#include <map>
#include <vector>

namespace osgTerrainLight
{

/// The placed objects of a TerrainLighting: those that the update traversal meets below it, and
/// those that it was given. In update traversal.
class ObjectRegistry
{
public:
    ObjectRegistry() = default;
    ~ObjectRegistry();
    ObjectRegistry(const ObjectRegistry&) = delete;
    ObjectRegistry& operator=(const ObjectRegistry&) = delete;

    /// False where it was given before.
    bool add(PlacedObject& object);
    bool remove(const PlacedObject* object);

    /// The traversal has met an object. toScene: from its frame to that of TerrainLighting.
    void see(PlacedObject& object, const osg::Matrixd& toScene);

    /// After the traversal: what has come, gone or moved goes to the light of the objects and of
    /// the tiles that they stand on, and to the probes of the objects. Whether that changes any
    /// but the probes. root: the TerrainLighting.
    bool follow(ObjectLight& light, const TileRegistry& tiles, ProbeList& probes,
                const osg::Group& root, const SkyLight& sky);

    ObjectSurfaces& surfaces() { return _surfaces; }
    const ObjectSurfaces& surfaces() const { return _surfaces; }

    std::size_t size() const { return _count; }

private:
    std::vector<osg::ref_ptr<PlacedObject>> _given;
    void giveSurfaces(const osg::Group* root);
    void takeSurfaces();

    std::vector<ObjectSurfaces::Seen> _seen; ///< in this traversal
    std::size_t _count = 0;                  ///< of those that the last one saw, with a shape
    ObjectSurfaces _surfaces;
    const osg::Group* _root = nullptr;
    bool _saidSize = false;   ///< that one is of no size
    glm::dvec2 _shadows{0.0}; ///< that tiles were told of
    std::map<TileHandle, osg::observer_ptr<LitTile>> _told;
};

} // namespace osgTerrainLight
