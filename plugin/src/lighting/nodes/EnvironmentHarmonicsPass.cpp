#include "lighting/nodes/EnvironmentHarmonicsPass.h"

#include "glsl_host.h"
#include "gpu/GlConstants.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace osgTerrainLight
{

namespace
{
constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;

std::string orderDefine(int order)
{
    return "ORDER " + std::to_string(order);
}

/// That the quadrature cuts texels in: where there are less than 32 across or up.
int partsOf(int texels)
{
    return (32 + texels - 1) / texels;
}

osg::ref_ptr<osg::Uniform> bandsUniform(const Glsl<double>::ShBands& bands, double gain)
{
    osg::ref_ptr<osg::Uniform> uniform = new osg::Uniform(osg::Uniform::FLOAT, "bands", 6);
    for (unsigned l = 0; l < 6; ++l)
        uniform->setElement(l, static_cast<float>(gain * bands.b[l]));
    return uniform;
}
} // namespace

EnvironmentHarmonicsPass::EnvironmentHarmonicsPass(int order)
    : _order(order), _partials(own(new Resource("partial sums", TextureLayout()))),
      _harmonics(own(new Resource("harmonics", {order * order, 1, 0, GL_RGBA32F_ARB}))),
      _picture(own(new GpuPass("environment_harmonics", {orderDefine(order)}))),
      _cube(own(new GpuPass("environment_harmonics", {orderDefine(order), "CUBE"}))),
      _sum(own(new GpuPass("harmonics_sum")))
{
    assert(order >= 2 && order <= 6);
    for (GpuPass* pass : {_picture, _cube})
        pass->writes(0, _partials);
    _sum->reads("partials", _partials);
    _sum->writes(0, _harmonics);
}

Status EnvironmentHarmonicsPass::dispatch(osg::State& state, osg::Texture2D* picture,
                                          double heading, double gain)
{
    const osg::Image* image = picture->getImage();
    const int rows = image ? image->t() : picture->getTextureHeight();
    _picture->reads("environment", picture);
    _picture->set("heading", static_cast<float>(std::remainder(heading, 360.0) * radiansPerDegree));
    _picture->set("parts", partsOf(rows));
    return project(state, *_picture, std::min(rows, 512), gain);
}

Status EnvironmentHarmonicsPass::dispatch(osg::State& state, Resource* picture)
{
    const int rows = picture->layout().height;
    _picture->reads("environment", picture);
    _picture->set("heading", 0.0f);
    _picture->set("parts", partsOf(rows));
    return project(state, *_picture, std::min(rows, 512), 1.0);
}

Status EnvironmentHarmonicsPass::dispatch(osg::State& state, osg::TextureCubeMap* map, double gain)
{
    const osg::Image* image = map->getImage(0);
    const int size = image ? image->s() : map->getTextureWidth();
    if (size < 4 || size > 8192)
        return Error{ErrorCode::Invalid, "cube map of an environment has faces of " +
                                             std::to_string(size) + " x " + std::to_string(size) +
                                             " texels: needs 4 ... 8192"};
    _cube->reads("environment", map);
    _cube->set("parts", partsOf(size));
    // Rounds of 32 texels, few per group. No more than 256 of them, as software OpenGL ends a
    // shader's loops after 65535 turns in all.
    const int rounds = (6 * size * size + 31) / 32;
    const int groups = std::max({std::min(rounds, 16), std::min(rounds / 8, 512), rounds / 256});
    return project(state, *_cube, groups, gain);
}

Status EnvironmentHarmonicsPass::project(osg::State& state, GpuPass& pass, int groups, double gain)
{
    if (_partials->layout().height < groups)
        _partials->setLayout({_order * _order, groups, 0, GL_RGBA32F_ARB});
    Status done = pass.dispatch(state, {static_cast<unsigned>(groups), 1, 1});
    if (!done)
        return done;
    _sum->set("groups", groups);
    _sum->set("gain", static_cast<float>(gain));
    return _sum->dispatch(state, {static_cast<unsigned>(_order * _order), 1, 1});
}

IrradianceMapPass::IrradianceMapPass(Resource* harmonics, int order)
    : _order(order), _pass(own(new GpuPass("irradiance_map", {orderDefine(order)})))
{
    _pass->reads("harmonics", harmonics);
}

osg::ref_ptr<osg::TextureCubeMap> IrradianceMapPass::createMap(int size)
{
    osg::ref_ptr<osg::TextureCubeMap> map = new osg::TextureCubeMap;
    map->setTextureSize(size, size);
    map->setInternalFormat(GL_RGBA16F_ARB);
    map->setSourceFormat(GL_RGBA);
    map->setSourceType(GL_HALF_FLOAT);
    map->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR);
    map->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
    for (const auto wrap : {osg::Texture::WRAP_S, osg::Texture::WRAP_T, osg::Texture::WRAP_R})
        map->setWrap(wrap, osg::Texture::CLAMP_TO_EDGE);
    map->setResizeNonPowerOfTwoHint(false);
    return map;
}

Status IrradianceMapPass::dispatchDiffuse(osg::State& state, osg::TextureCubeMap* map,
                                          const Sun& sun)
{
    constexpr double overPi = 1.0 / 3.14159265358979323846;
    return dispatch(state, map, bandsUniform(Glsl<double>().lambertBands(), overPi), sun);
}

Status IrradianceMapPass::dispatchGlossy(osg::State& state, osg::TextureCubeMap* map,
                                         double exponent, const Sun& sun)
{
    return dispatch(state, map, bandsUniform(Glsl<double>().phongBands(exponent), 1.0), sun);
}

Status IrradianceMapPass::dispatch(osg::State& state, osg::TextureCubeMap* map, osg::Uniform* bands,
                                   const Sun& sun)
{
    std::vector<std::string> defines = {orderDefine(_order)};
    if (sun.horizon)
        defines.push_back("DISC");
    _pass->setDefines(defines);
    _pass->reads("sunHorizon", sun.horizon);
    if (sun.horizon)
    {
        _pass->set("sunElevation", static_cast<float>(sun.elevation * radiansPerDegree));
        _pass->set("sunRadius", static_cast<float>(sun.radius * radiansPerDegree));
    }
    else
        _pass->set("sunOff", static_cast<float>(sun.fraction));
    _pass->set(bands);
    _pass->writes(0, map);
    const unsigned groups = GpuPass::groupsFor(map->getTextureWidth(), 8);
    return _pass->dispatch(state, {groups, groups, 6});
}

} // namespace osgTerrainLight
