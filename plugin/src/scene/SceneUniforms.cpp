#include "scene/SceneUniforms.h"

#include "core/SkyRadiance.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/GlossNode.h"
#include <osgTerrainLight/ShadingTexture.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
/// Of ground that sends nothing by gloss: as that of GlossWork, of one texel.
osg::ref_ptr<osg::Texture2DArray> createNoGloss()
{
    osg::ref_ptr<osg::Texture2DArray> dark = new osg::Texture2DArray;
    dark->setTextureSize(1, 1, GlossWork::layers);
    for (unsigned layer = 0; layer < GlossWork::layers; ++layer)
    {
        osg::ref_ptr<osg::Image> texel = new osg::Image;
        texel->allocateImage(1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
        std::fill_n(texel->data(), texel->getTotalSizeInBytes(), static_cast<unsigned char>(0));
        dark->setImage(layer, texel);
    }
    dark->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
    dark->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
    return dark;
}

osg::Vec3f vec3(const std::array<double, 3>& v)
{
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
} // namespace

void SceneUniforms::set(const SkyLight& sky, double exposure, unsigned glossUnit, bool glossy)
{
    _glossy = glossy;
    _stateSet = new osg::StateSet;
    const auto add = [this](const char* name, const auto& value)
    { _stateSet->addUniform(new osg::Uniform(name, value)); };
    const Rgb irradiance = sunAtGround(sky);
    add(ShadingTexture::exposure, static_cast<float>(std::exp2(exposure)));
    add(ShadingTexture::sunDirection, vec3(sky.sunDirection()));
    add(ShadingTexture::sunIrradiance, TileLight::needsSun(sky)
                                           ? osg::Vec3f(irradiance[0], irradiance[1], irradiance[2])
                                           : osg::Vec3f());
    add(ShadingTexture::glossSampler, static_cast<int>(glossUnit));
    // Where there is no light, tiles send none: shaders of hosts must find that.
    if (glossy && !_noGloss)
        _noGloss = createNoGloss();
    if (glossy)
        _stateSet->setTextureAttribute(glossUnit, _noGloss);
}

void SceneUniforms::releaseGLObjects(osg::State* state) const
{
    if (_noGloss)
        _noGloss->releaseGLObjects(state);
}

void SceneUniforms::resizeGLObjectBuffers(unsigned size)
{
    if (_noGloss)
        _noGloss->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
