#include "scene/SkyDome.h"

#include "core/SkyRadiance.h"
#include "gpu/EnvironmentTexture.h"
#include "gpu/GlConstants.h"
#include "lighting/TileLight.h"
#include "scene/DrawBeside.h"
#include "scene/ShadingBinding.h"
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Depth>
#include <osg/DisplaySettings>
#include <osg/Geometry>
#include <osg/Image>
#include <osg/observer_ptr>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace osgTerrainLight
{
namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr int rows = 128; // of a sky's picture

/// Without extent, so that neither bounds nor the planes of a camera have to do with it.
class NoExtent : public osg::Drawable::ComputeBoundingBoxCallback
{
public:
    osg::BoundingBox computeBound(const osg::Drawable&) const override { return {}; }
};

osg::ref_ptr<osg::Geometry> cube()
{
    osg::ref_ptr<osg::Vec3Array> corners = new osg::Vec3Array;
    for (int i = 0; i < 8; ++i)
        corners->push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    static const GLubyte faces[] = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                                    2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
    osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
    geometry->setVertexArray(corners);
    geometry->addPrimitiveSet(new osg::DrawElementsUByte(GL_TRIANGLES, 36, faces));
    geometry->setUseDisplayList(false);
    geometry->setUseVertexBufferObjects(true);
    geometry->setComputeBoundingBoxCallback(new NoExtent);
    geometry->setDataVariance(osg::Object::DYNAMIC); // draws are waited for before it changes
    return geometry;
}

Rgb sunOf(const SkyLight& sky)
{
    return TileLight::needsSun(sky) ? sunAtGround(sky) : Rgb{};
}

/// Of a sky without environment.
osg::ref_ptr<osg::Texture2D> createPicture()
{
    osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(2 * rows, rows, 1, GL_RGB, GL_FLOAT);
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
    texture->setDataVariance(osg::Object::DYNAMIC);
    texture->setInternalFormat(GL_RGB16F_ARB);
    texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR);
    texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
    texture->setWrap(osg::Texture::WRAP_S, osg::Texture::REPEAT);
    texture->setWrap(osg::Texture::WRAP_T, osg::Texture::CLAMP_TO_EDGE);
    return texture;
}

/// Of one lighting. A copy of that shares the callback, and takes over once it is gone.
class FollowLight : public osg::NodeCallback
{
public:
    explicit FollowLight(SkyDome* dome) : _dome(dome) {}

    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override
    {
        traverse(node, visitor); // the light may change there
        auto* lighting = dynamic_cast<TerrainLighting*>(node);
        if (!_lighting.valid())
            _lighting = lighting;
        if (lighting && _lighting == lighting)
            _dome->follow(*lighting);
    }

private:
    ~FollowLight() override = default;
    osg::ref_ptr<SkyDome> _dome;
    osg::observer_ptr<TerrainLighting> _lighting;
};
} // namespace

SkyDome::SkyDome()
{
    setName("terrain light sky");
    setCullingActive(false);
    const osg::ref_ptr<osg::Geometry> geometry = cube();
    geometry->setCullingActive(false);
    addDrawable(geometry);
    osg::StateSet& state = *getOrCreateStateSet();
    state.setDataVariance(osg::Object::DYNAMIC);
    state.setRenderBinDetails(-1000, "RenderBin"); // before all else
    state.setAttributeAndModes(new osg::Depth(osg::Depth::ALWAYS, 0.0, 1.0, false));
    state.setMode(GL_CULL_FACE, osg::StateAttribute::OFF);
    state.setMode(GL_BLEND, osg::StateAttribute::OFF);
    state.setAttributeAndModes(createSkyProgram());
    state.addUniform(new osg::Uniform("osgTerrainLight_sky", 0));
    resizeGLObjectBuffers(osg::DisplaySettings::instance()->getMaxNumberOfGraphicsContexts());
}

void SkyDome::follow(const TerrainLighting& lighting)
{
    setNodeMask(lighting.getLightEnabled() && lighting.getSkyLight().skyEnabled ? ~0u : 0u);
    const LightingSettings& settings = lighting.getSettings();
    const SkyLight& sky = lighting.getSkyLight();
    const bool another = _isNew || _sky != sky || _albedo != settings.albedo;
    if (another || _exposure != settings.exposure)
        getStateSet()->addUniform(new osg::Uniform(
            ShadingTexture::exposure, static_cast<float>(std::exp2(settings.exposure))));
    _exposure = settings.exposure;
    _albedo = settings.albedo;
    _sky = sky;
    _isNew = false;
    if (another)
        show();
}

void SkyDome::show()
{
    const SkyLight& sky = _sky;
    osg::StateSet& state = *getStateSet();
    if (sky.environment)
        state.setTextureAttribute(0, environmentTexture(sky.environment));
    else
    {
        // Written again where it is, since the sky changes in every frame while a clock runs.
        const Raster<Rgb> picture = skyPicture(sky, rows, _albedo, sunOf(sky));
        if (!_picture)
            _picture = createPicture();
        osg::Image& image = *_picture->getImage();
        std::memcpy(image.data(), picture.values().data(), picture.size() * sizeof(Rgb));
        image.dirty();
        state.setTextureAttribute(0, _picture);
    }
    const auto direction = sky.sunDirection();
    const double radius = TileLight::needsSun(sky) ? sky.sunAngularRadius * pi / 180.0 : 0.0;
    const Rgb irradiance = sunOf(sky);
    const double solidAngle = pi * std::max(radius * radius, 1e-12);
    const auto set = [&state](const char* name, const auto& value)
    { state.addUniform(new osg::Uniform(name, value)); };
    set("osgTerrainLight_skyTurn",
        osg::Vec2f(sky.environment ? static_cast<float>(sky.environmentHeading * pi / 180.0) : 0.0f,
                   sky.environment ? static_cast<float>(sky.environmentGain) : 1.0f));
    set("osgTerrainLight_sunDisc",
        osg::Vec4f(static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                   static_cast<float>(direction[2]), static_cast<float>(radius)));
    set("osgTerrainLight_sunRadiance",
        osg::Vec3f(static_cast<float>(static_cast<double>(irradiance[0]) / solidAngle),
                   static_cast<float>(static_cast<double>(irradiance[1]) / solidAngle),
                   static_cast<float>(static_cast<double>(irradiance[2]) / solidAngle)));
}

void addSkyDome(TerrainLighting& lighting)
{
    const osg::ref_ptr<SkyDome> dome = new SkyDome;
    dome->follow(lighting);
    lighting.addUpdateCallback(new FollowLight(dome));
    lighting.addCullCallback(new DrawBeside(dome.get()));
}

} // namespace osgTerrainLight
