#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"

namespace osgTerrainLight
{

/// What placed objects leave of the light of a tile's ground, at texels of their own around each
/// volume of TileInputs::objects (object_factor.comp).
class ObjectFactorNode : public Node
{
public:
    /// What the factor is of. horizon: of the sky, null where the method has none; skyPicture: of
    /// SkyTableNode.
    struct Light
    {
        Resource *direct, *shading, *horizon, *skyPicture;
    };
    ObjectFactorNode(const TileInputs& inputs, const TileSurface& surface, const Light& light,
                     Resource* factor);

    Status run(osg::State& state) override;

    /// RGBA16F: the texels of all objects, one below the other.
    static TextureLayout layoutOf(const TileObjects& objects);

private:
    ~ObjectFactorNode() override = default;
    void setCones();
    Status dispatch(osg::State& state, const TileObject& object);

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    bool _hasHorizon;
    GpuPass* _pass;
};

} // namespace osgTerrainLight
