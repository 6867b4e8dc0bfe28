#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/EnvironmentHarmonicsPass.h"

#include <map>
#include <vector>

namespace osgTerrainLight
{

/// Light at places on a tile from all around: sky above the horizon that the place has, below it
/// what the ground sends there, as irradiance maps of TileInputs::probes.
class ProbeNode : public Node
{
public:
    /// Of the harmonics: the first that leaves nothing of Lambert's kernel but the 0.5 % of l = 6
    /// and beyond.
    static constexpr int order = 6;
    /// Texels of a map's side.
    static constexpr int mapSize = 16;

    /// shading: of the posts. skyPicture: of SkyTableNode, of which there is a texture where the
    /// sky has a table. Probes that stay where nothing has changed are not computed again.
    ProbeNode(const TileInputs& inputs, const TileSurface& surface, Resource* shading,
              Resource* skyPicture);

    Status run(osg::State& state) override;

private:
    ~ProbeNode() override = default;
    void setKeyLights(const SkyLight& light);
    void setLight();
    Status light(osg::State& state, const ProbePlace& place);

    osg::ref_ptr<const TileInputs> _inputs;
    osg::ref_ptr<const TileSurface> _surface;
    osg::ref_ptr<Resource> _skyPicture;
    /// RGBA32F, radiance around the last probe, laid out as Environment::radiance, without the sun.
    Resource* _panorama;
    Resource* _sunHorizon;
    GpuPass* _look;
    /// What the light of all probes is computed from.
    std::vector<osg::ref_ptr<Resource>> _light;
    struct Lit
    {
        std::vector<Resource::Version> light;
        std::vector<ProbePlace> probes;
    };
    std::map<unsigned, Lit> _lit; ///< of the last run that has ended, by context
    EnvironmentHarmonicsPass* _project;
    IrradianceMapPass* _evaluate;
};

} // namespace osgTerrainLight
