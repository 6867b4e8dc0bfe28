#include "lighting/nodes/LegendreLight.h"

#include "lighting/nodes/PyramidRays.h"

#include <array>
#include <cassert>

namespace osgTerrainLight
{

LegendreScheme LegendreScheme::of(const LightingSettings& settings)
{
    assert(settings.bounceMethod != BounceMethod::Slices);
    LegendreScheme scheme;
    scheme.rays = settings.quality == HorizonQuality::Draft  ? BounceScheme{4.0, 2.0}
                  : settings.quality == HorizonQuality::Best ? BounceScheme{8.0, 8.0}
                                                             : BounceScheme{8.0, 4.0};
    scheme.azimuths = settings.azimuths;
    scheme.blend = settings.bounceMethod == BounceMethod::Legendre ? AzimuthBlend::Linear
                                                                   : AzimuthBlend::BSpline;
    scheme.stride = settings.subsampling;
    return scheme;
}

osg::ref_ptr<GpuPass> createLegendreLight(std::vector<std::string> defines,
                                          const PyramidNode& pyramid, const LegendreScheme& scheme)
{
    constexpr double pi = 3.14159265358979323846;
    if (scheme.stride > 1)
        defines.emplace_back("SUBSAMPLED");
    osg::ref_ptr<GpuPass> pass = new GpuPass("legendre_light", std::move(defines));
    setPyramidScan(*pass, scheme.rays, pyramid);
    const std::array<double, 4> even =
        WedgeMatrices(2.0 * pi / scheme.azimuths).weights(scheme.blend).even;
    pass->set("orderWeights", osg::Vec4f(static_cast<float>(even[0]), static_cast<float>(even[1]),
                                         static_cast<float>(even[2]), static_cast<float>(even[3])));
    pass->set("stride", scheme.stride);
    return pass;
}

GpuPass::Groups legendreGroups(const TileSurface& surface, int stride)
{
    // A group of 8 · 8 gathers for all posts, or shades the 7 · 7 blocks between its own.
    const int side = stride == 1 ? 8 : 7 * stride;
    return {GpuPass::groupsFor(surface.width(), side), GpuPass::groupsFor(surface.height(), side),
            1};
}

} // namespace osgTerrainLight
