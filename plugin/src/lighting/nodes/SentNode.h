#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/GlossNode.h"
#include "lighting/nodes/PyramidLayout.h"
#include "lighting/sources/LightSource.h"

namespace osgTerrainLight
{

/// What the faces between posts send out diffusely in one bounce: shaders/passes/faces.comp.
class SentNode : public Node
{
public:
    /// Of direct light, which is found anew for the faces of cells. horizon: of HorizonNode, all
    /// around.
    SentNode(const TileInputs& inputs, const TileSurface& surface, const LightSources& lights,
             Resource* horizon);
    /// Of the light of the bounce before, a texel per post.
    SentNode(const TileInputs& inputs, const TileSurface& surface, Resource* horizon,
             Resource* light);

    /// Also writes radiance() and pyramid().
    void addPyramid(const PyramidLayout& cells);
    /// Cells also send what their corners' gloss sends towards one viewer.
    void addGloss(const GlossWork& gloss, Resource* exit);

    Status run(osg::State& state) override;

    /// RGBA16F, four texels per post, the corners of the cells that meet there: rgb = radiance
    /// without the sun's part, a = 1 where the cell is valid.
    Resource* faces() const { return _faces; }
    /// RGBA16F, cell (x, y) between posts x, x + 1, y, y + 1: rgb = radiance in the mean, a = 1
    /// where valid; null without addPyramid().
    Resource* radiance() const { return _radiance; }
    /// RGBA16F: radiance times weight, weight, coarser and coarser; null without addPyramid().
    Resource* pyramid() const { return _pyramid; }

private:
    ~SentNode() override = default;
    SentNode(const TileInputs& inputs, const TileSurface& surface,
             std::vector<std::string> defines);

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    PyramidLayout _layout;
    bool _ofDirect = false;
    LightSources _lights;
    Resource* _faces;
    Resource* _radiance = nullptr;
    Resource* _pyramid = nullptr;
    GpuPass* _pass;
    GpuPass* _cells = nullptr; ///< means of cells
    GpuPass* _first = nullptr; ///< level of the pyramid, and the next ones
    GpuPass* _next = nullptr;
    GpuPass* _addGloss = nullptr;
};

} // namespace osgTerrainLight
