#include "lighting/nodes/LegendreDirectNode.h"

#include "core/LegendreKeys.h"
#include "core/ShProduct.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/PyramidRays.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
// The sizes of what legendre_light.comp declares.
constexpr std::size_t maxRays = 340;
constexpr std::size_t maxKeySlices = 84;

/// Row i, column 3 j + c: what coefficient j of visibility gives to coefficient i of the incident
/// light, in colour c.
Raster<float> productOf(const std::vector<Rgb>& harmonics)
{
    Raster<float> product(48, 9);
    for (std::size_t c = 0; c < 3; ++c)
    {
        ShFunction sky = {};
        for (std::size_t i = 0; i < std::min<std::size_t>(harmonics.size(), 16); ++i)
            sky[i] = static_cast<double>(harmonics[i][c]);
        const ShMatrix<16> matrix = shProduct(sky);
        for (int i = 0; i < 9; ++i)
            for (int j = 0; j < 16; ++j)
                product.at(3 * j + static_cast<int>(c), i) = static_cast<float>(
                    matrix[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
    }
    return product;
}

osg::Vec4f vec4(const std::array<double, 4>& v)
{
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
            static_cast<float>(v[3])};
}
} // namespace

LegendreDirectNode::LegendreDirectNode(const TileInputs& inputs, const PyramidNode& pyramid,
                                       const LegendreScheme& scheme, Resource* direct)
    : Node("shade"), _inputs(&inputs), _surface(&pyramid.surface()), _scheme(scheme),
      _uniform(own(createLegendreLight({"DIRECT"}, pyramid, scheme).get())),
      _harmonics(own(createLegendreLight({"DIRECT", "HARMONICS"}, pyramid, scheme).get())),
      _skyProduct(own(new Resource("product with the sky")))
{
    reads(_surface->heights());
    reads(pyramid.pyramid(), pyramid.layout().texture(GL_RG32F));
    reads(inputs.settingsValue);
    reads(inputs.light);
    writes(own(direct));
    for (GpuPass* pass : {_uniform, _harmonics})
        pass->writes(0, direct);
    _harmonics->reads("skyProduct", _skyProduct);
}

/// The variant for the kind of sky, with what the sky is.
GpuPass& LegendreDirectNode::choosePass(const SkyLight& sky)
{
    if (!sky.skyEnabled || sky.skyHarmonics.empty())
    {
        _skyProduct->drop();
        _uniform->set("skyRadiance",
                      osg::Vec3f(sky.skyRadiance[0], sky.skyRadiance[1], sky.skyRadiance[2]));
        return *_uniform;
    }
    if (!_skyProduct->texture() || sky.skyHarmonics != _productOf)
    {
        _skyProduct->set(createFloatTexture(productOf(sky.skyHarmonics)));
        _productOf = sky.skyHarmonics;
    }
    return *_harmonics;
}

/// Rays all around for the sky, then those of key lights.
void LegendreDirectNode::setRays(GpuPass& pass, const SkyLight& sky) const
{
    std::vector<MapDirection> directions;
    if (sky.skyEnabled)
        directions = directionsOf(AzimuthSet(_scheme.azimuths));
    pass.set("azimuths", static_cast<int>(directions.size()));
    const std::vector<LegendreKey> keys = legendreKeys(sky);
    assert(keys.size() <= maxKeySlices);
    for (const LegendreKey& key : keys)
        directions.push_back(key.direction);
    const DemTile& tile = _surface->tile();
    std::vector<osg::Vec4f> rays =
        raySteps(tile.nominalEastSpacing(), tile.northSpacing, directions);
    rays.resize(maxRays);
    for (const LegendreKey& key : keys)
    {
        rays.push_back(vec4(key.weights.even));
        rays.push_back(vec4(key.weights.odd));
        rays.push_back(vec4({std::cos(key.lowest), std::sin(key.lowest), std::cos(key.highest),
                             std::sin(key.highest)}));
        rays.emplace_back(key.radiance[0], key.radiance[1], key.radiance[2],
                          static_cast<float>(key.perSun));
    }
    rays.resize(maxRays + 4 * maxKeySlices);
    pass.setBlock(rays);
    pass.set("keyCount", static_cast<int>(keys.size()));
    pass.set("sunOff", sky.sunEnabled ? 0.0f : 1.0f);
}

Status LegendreDirectNode::run(osg::State& state)
{
    const SkyLight sky = _inputs->lightInHarmonics();
    GpuPass& pass = choosePass(sky);
    setRays(pass, sky);
    return pass.dispatch(state, legendreGroups(*_surface, _scheme.stride));
}

} // namespace osgTerrainLight
