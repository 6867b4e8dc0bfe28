#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"

namespace osgTerrainLight
{

/// What light among placed objects is gathered from (shaders/objects.glsl). horizon: of the sky,
/// null where the method has none; skyPicture: of SkyTableNode.
struct ObjectSurroundings
{
    Resource *direct, *shading, *horizon, *skyPicture;
};

/// A node that gathers light among the objects of a volume, on or beside the ground of a tile: what
/// shaders/objects.glsl declares, for its pass.
class AmongObjectsNode : public Node
{
protected:
    AmongObjectsNode(const std::string& name, const std::string& pass, const TileInputs& inputs,
                     const TileSurface& surface, const ObjectSurroundings& light, int cones);
    ~AmongObjectsNode() override = default;

    const TileInputs& inputs() const { return *_inputs; }
    GpuPass& pass() { return *_pass; }

    /// Variant and uniforms of the light that there is now.
    void setLight();
    /// Of a volume. Whether it is there: it may have been replaced, or could not be computed.
    bool setObject(const osg::State& state, const TileObject& object);

private:
    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    bool _hasHorizon;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
