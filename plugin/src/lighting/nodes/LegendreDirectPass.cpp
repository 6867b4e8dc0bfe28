#include "lighting/nodes/LegendreDirectPass.h"

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

LegendreDirectPass::LegendreDirectPass(const DemTile& tile, const HeightPyramid& pyramid,
                                       osg::Texture2D* eastSpacings, const LegendreScheme& scheme)
    : _azimuths(scheme.azimuths), _eastSpacing(tile.nominalEastSpacing()),
      _northSpacing(tile.northSpacing),
      _groups(legendreGroups(tile.width(), tile.height(), scheme.stride)),
      _uniform(createLegendreLight({"DIRECT"}, tile, pyramid, eastSpacings, scheme)),
      _harmonics(createLegendreLight({"DIRECT", "HARMONICS"}, tile, pyramid, eastSpacings, scheme))
{
}

Status LegendreDirectPass::dispatch(osg::State& state, const SkyLight& sky, osg::Texture2D* shading)
{
    const bool inHarmonics = sky.skyEnabled && !sky.skyHarmonics.empty();
    GpuPass& pass = inHarmonics ? *_harmonics : *_uniform;
    if (!inHarmonics)
        _skyProduct = nullptr;
    else if (!_skyProduct || sky.skyHarmonics != _productOf)
    {
        _skyProduct = createFloatTexture(productOf(sky.skyHarmonics));
        _productOf = sky.skyHarmonics;
    }
    if (inHarmonics)
        pass.reads("skyProduct", _skyProduct);
    else
        pass.set("skyRadiance",
                 osg::Vec3f(sky.skyRadiance[0], sky.skyRadiance[1], sky.skyRadiance[2]));
    std::vector<MapDirection> directions;
    if (sky.skyEnabled)
        directions = directionsOf(AzimuthSet(_azimuths));
    pass.set("azimuths", static_cast<int>(directions.size()));
    const std::vector<LegendreKey> keys = legendreKeys(sky);
    assert(keys.size() <= maxKeySlices);
    for (const LegendreKey& key : keys)
        directions.push_back(key.direction);
    std::vector<osg::Vec4f> rays = raySteps(_eastSpacing, _northSpacing, directions);
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
    pass.writes(0, shading);
    return pass.dispatch(state, _groups);
}

std::size_t LegendreDirectPass::bytes() const
{
    return _skyProduct ? textureBytes(*_skyProduct) : 0;
}

void LegendreDirectPass::releaseGLObjects(osg::State* state) const
{
    for (const auto& pass : {_uniform, _harmonics})
        pass->releaseGLObjects(state);
    if (_skyProduct)
        _skyProduct->releaseGLObjects(state);
}

void LegendreDirectPass::resizeGLObjectBuffers(unsigned size)
{
    for (const auto& pass : {_uniform, _harmonics})
        pass->resizeGLObjectBuffers(size);
    if (_skyProduct)
        _skyProduct->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
