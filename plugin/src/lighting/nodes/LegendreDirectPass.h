#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/HeightPyramid.h"
#include "lighting/nodes/LegendreLight.h"

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture2D>

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// Direct light as Nowrouzezahrai and Snyder 2009 compute it: visibility from the height pyramid
/// alone, in spherical harmonics of order 4, times the sky's; key lights, the sun among them, at
/// azimuths of their own. docs/ARCHITECTURE.md has what it leaves of the light.
class OSGTERRAINLIGHT_EXPORT LegendreDirectPass : public osg::Referenced
{
public:
    /// eastSpacings: createSpacingTexture(tile).
    LegendreDirectPass(const DemTile& tile, const HeightPyramid& pyramid,
                       osg::Texture2D* eastSpacings, const LegendreScheme& scheme);

    /// Writes the shading (RGBA16F): rgb = irradiance / π, ≥ 0; a = visible part of the sun, as
    /// harmonics have it (1 where the sun is off, 0 where it is below the horizontal). Void posts:
    /// 0.
    Status dispatch(osg::State& state, const SkyLight& sky, osg::Texture2D* shading);

    /// Of its textures.
    std::size_t bytes() const;
    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~LegendreDirectPass() override = default;

    int _azimuths;
    double _eastSpacing, _northSpacing;
    GpuPass::Groups _groups;
    osg::ref_ptr<GpuPass> _uniform, _harmonics; ///< by the kind of sky
    osg::ref_ptr<osg::Texture2D> _skyProduct;   ///< null where the sky is uniform
    std::vector<Rgb> _productOf;                ///< the harmonics that it was made of
};

} // namespace osgTerrainLight
