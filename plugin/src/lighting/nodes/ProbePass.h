#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/AzimuthSet.h"
#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/EnvironmentHarmonicsPass.h"

#include <osg/Texture2D>
#include <osg/TextureCubeMap>

#include <array>
#include <cstddef>

namespace osgTerrainLight
{

/// Where a probe stands on a tile, and what is computed for it.
struct ProbePlace
{
    double column = 0.0, row = 0.0; ///< posts, with fractions, within the tile
    double height = 0.0;            ///< [m] above the ground, or above heightOrigin
    bool aboveGround = true;
    double exponent = 16.0; ///< of the glossy map's lobe, 1 … 64
    osg::ref_ptr<osg::TextureCubeMap> diffuse, glossy;

    bool operator==(const ProbePlace& other) const
    {
        return column == other.column && row == other.row && height == other.height &&
               aboveGround == other.aboveGround && exponent == other.exponent &&
               diffuse == other.diffuse && glossy == other.glossy;
    }
};

/// Light at a place on a tile from all around: sky above the horizon that the place has, below it
/// what the ground sends there, as irradiance maps. One for all probes of a tile.
class OSGTERRAINLIGHT_EXPORT ProbePass : public osg::Referenced
{
public:
    /// Of the harmonics: the first that leaves nothing of Lambert's kernel but the 0.5 % of l = 6
    /// and beyond.
    static constexpr int order = 6;
    /// Texels of a map's side.
    static constexpr int mapSize = 16;

    explicit ProbePass(const DemTile& tile);

    /// What surrounds all probes.
    struct Light
    {
        osg::Texture2D* heights = nullptr; ///< framed by `frame` void posts
        int frame = 0;
        osg::Texture2D* shading = nullptr;
        osg::Texture2D* albedo = nullptr; ///< a texel per post, or one for all
        /// SkyTablePass' picture; null: the sky is uniform, or off.
        osg::Texture2D* sky = nullptr;
        SkyLight light; ///< of which sky radiance, key lights and the sun's disc are read
        bool hasSun = false;
        std::array<MapDirection, 3> sun = {}; ///< left, centre and right of its disc
    };
    Status dispatch(osg::State& state, const ProbePlace& place, const Light& light);

    /// RGBA32F, radiance around the last probe, laid out as Environment::radiance, without the sun.
    osg::Texture2D* panorama() const { return _panorama; }

    std::size_t bytes() const; ///< without the probes' maps
    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~ProbePass() override = default;
    void setKeyLights(const SkyLight& light);

    DemTile _tile; ///< of which spacings are read
    osg::ref_ptr<osg::Texture2D> _panorama, _sunHorizon;
    osg::ref_ptr<GpuPass> _look;
    osg::ref_ptr<EnvironmentHarmonicsPass> _project;
    osg::ref_ptr<IrradianceMapPass> _evaluate;
};

} // namespace osgTerrainLight
