#include "core/Raster.h"
#include "glsl_host.h"
#include "gpu/GpuPass.h"
#include "gpu/ShaderLibrary.h"
#include "gpu/Textures.h"
#include "lighting/TileLight.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"

#include <osgTerrainLight/ShadingTexture.h>

#include <osg/GLExtensions>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace osgTerrainLight;

// The edge of the sun's shadow between posts, as host/terrain_shading.glsl finds it.

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double spacing = 10.0; // [m]
constexpr int width = 96, height = 9, wallColumn = 64, middleRow = 4;
constexpr int perPost = 32; // places looked at between two posts

/// terrainShading() along the middle row: rgba of every 1/perPost post.
Raster<osg::Vec4f> alongTheRow(osg::State& state, const TileLight& tile, const SkyLight& sky)
{
    static int count = 0;
    const std::string name = "test_edges_" + std::to_string(++count);
    const Result<std::string> host = ShaderLibrary::instance().source("host/terrain_shading.glsl");
    EXPECT_TRUE(host.ok());
    const ShaderFile file("passes/" + name + ".comp", R"(
layout(local_size_x = 32) in;
layout(rgba32f, binding = 0) writeonly uniform image2D found;
uniform vec3 walk; // first place and step, in posts, and row
)" + *host + R"(
void main()
{
    int i = int(gl_GlobalInvocationID.x);
    vec2 place = vec2(walk.x + walk.y * float(i), walk.z);
    vec2 posts = vec2(textureSize(osgTerrainLight_shading, 0));
    imageStore(found, ivec2(i, 0), terrainShading((place + 0.5) / posts));
}
)");
    const osg::ref_ptr<GpuPass> pass = new GpuPass(name);
    const int places = (width - 1) * perPost;
    const osg::ref_ptr<osg::Texture2D> target = createTarget(places, 1, GL_RGBA32F_ARB);
    const osg::ref_ptr<osg::Texture2D> edges = tile.shadowEdges();
    pass->writes(0, target);
    pass->reads(ShadingTexture::sampler, tile.shading());
    pass->reads(ShadingTexture::edgeSampler, edges.get());
    pass->set(ShadingTexture::hasEdges, edges.valid());
    pass->set(ShadingTexture::posts, osg::Vec2f(width, height));
    pass->set(ShadingTexture::sunIrradiance,
              osg::Vec3f(sky.sunIrradiance[0], sky.sunIrradiance[1], sky.sunIrradiance[2]));
    pass->set("walk", osg::Vec3f(0.0f, 1.0f / perPost, middleRow));
    const Status done = pass->dispatch(state, {GpuPass::groupsFor(places, 32), 1, 1});
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    const std::vector<float> values = readFloats(state, *target, 4);
    Raster<osg::Vec4f> result(places, 1);
    for (int i = 0; i < places; ++i)
        result.at(i, 0).set(values[std::size_t(4 * i)], values[std::size_t(4 * i + 1)],
                            values[std::size_t(4 * i + 2)], values[std::size_t(4 * i + 3)]);
    EXPECT_EQ(takeGlErrors(), "");
    return result;
}

struct Scene
{
    double rise, elevation;
    SkyLight sky;
    osg::ref_ptr<TileLight> tile;

    Scene(double wallRise, double sunElevation, bool edges, int bounces = 0)
        : rise(wallRise), elevation(sunElevation)
    {
        sky.skyEnabled = false;
        sky.sunAzimuth = 90.0;
        sky.sunElevation = sunElevation;
        sky.sunIrradiance = {3.0f, 2.0f, 1.0f};
        LightingSettings settings;
        settings.shadowEdges = edges;
        settings.bounces = bounces;
        tile =
            new TileLight(analytic::wall(width, height, spacing, wallColumn, rise), settings, sky);
    }

    /// Visible fraction of the disc at a distance from the crest [m] on the level ground.
    double visible(double distance) const
    {
        const double radius = sky.sunAngularRadius * pi / 180.0;
        const double above = elevation * pi / 180.0 - std::atan(rise / distance);
        return Glsl<double>().visibleDiscFraction(above, radius);
    }
};

/// Greatest difference from the closed form on the ground behind the wall, from a post on.
double worst(const Scene& scene, const Raster<osg::Vec4f>& found)
{
    double most = 0.0;
    for (int i = 0; i < (wallColumn - 1) * perPost; ++i)
    {
        const double distance = (wallColumn - double(i) / perPost) * spacing;
        const double expected = scene.visible(distance);
        const osg::Vec4f& light = found.at(i, 0);
        most = std::max(most, std::abs(static_cast<double>(light.a()) - expected));
        // The last post before the wall has the normal of ground and wall.
        const double facing = std::sin(scene.elevation * pi / 180.0) / pi;
        if (i < (wallColumn - 2) * perPost)
            most = std::max(most,
                            std::abs(static_cast<double>(light.r()) / (3.0 * facing) - expected));
    }
    return most;
}
} // namespace

// Expected: the disc over the wall's crest, in closed form. 3 m at 10 degrees: the edge is 17 m
// behind the wall and 1 m wide, within a cell of 10 m. 37 m: 210 m behind it and 11 m wide. The
// function of the disc is within 0.0032, half floats of heights over the shadow of up to 16 m round
// by 0.004 m, which is 0.004 of the narrowest edge; 0.01 is both and the codes of horizons.
TEST(ShadowEdges, OfAWallIsWhereItsCrestPutsIt)
{
    OTL_NEED_GL(context);
    for (const double rise : {3.0, 5.0, 12.0, 37.0})
        for (const double elevation : {10.0, 25.0})
        {
            const Scene blurred(rise, elevation, false), sharp(rise, elevation, true);
            for (const Scene* scene : {&blurred, &sharp})
                ASSERT_TRUE(scene->tile->update(context->state()).ok());
            const double before =
                worst(blurred, alongTheRow(context->state(), *blurred.tile, blurred.sky));
            const double after =
                worst(sharp, alongTheRow(context->state(), *sharp.tile, sharp.sky));
            std::cout << rise << " m, " << elevation << " degrees: " << before << " without, "
                      << after << " with\n";
            EXPECT_LE(after, 0.01);
            if (elevation < 20.0 && rise < 30.0)
            {
                EXPECT_GE(before, 0.3); // the blur is there to be mended
            }
        }
}

// At posts, and in all that is read back, nothing changes; off, it takes no memory and no time.
TEST(ShadowEdges, ChangeNothingAtPostsAndCostNothingWhereTheyAreOff)
{
    OTL_NEED_GL(context);
    Scene off(12.0, 10.0, false), on(12.0, 10.0, true);
    for (const Scene* scene : {&off, &on})
        ASSERT_TRUE(scene->tile->update(context->state()).ok());
    const Raster<osg::Vec4f> before = off.tile->readShading(context->state());
    EXPECT_EQ(before.values(), on.tile->readShading(context->state()).values());
    const Raster<osg::Vec4f> found = alongTheRow(context->state(), *on.tile, on.sky);
    for (int x = 0; x + 1 < width; ++x)
        for (unsigned c = 0; c < 4; ++c)
            // Half a step of floats of up to 1, from the mixed coordinates.
            EXPECT_NEAR(found.at(x * perPost, 0)[c], before.at(x, middleRow)[c], 2.0e-3) << x;

    EXPECT_FALSE(off.tile->shadowEdges());
    EXPECT_TRUE(on.tile->shadowEdges());
    const std::size_t posts = std::size_t(width) * height;
    // Edges 8, heights over the shadow 4, and 8 per place where a line crosses.
    EXPECT_EQ(on.tile->bytes(),
              off.tile->bytes() + 12 * posts + 8 * std::size_t(width + 1) * (height + 1));
    const std::size_t bytes = off.tile->bytes();
    LightingSettings settings;
    settings.shadowEdges = true;
    off.tile->setSettings(settings);
    ASSERT_TRUE(off.tile->update(context->state()).ok());
    EXPECT_TRUE(off.tile->shadowEdges());
    settings.shadowEdges = false;
    off.tile->setSettings(settings);
    ASSERT_TRUE(off.tile->update(context->state()).ok());
    EXPECT_FALSE(off.tile->shadowEdges());
    EXPECT_EQ(off.tile->readShading(context->state()).values(), before.values());
    EXPECT_EQ(off.tile->bytes(), bytes);
    SkyLight night = on.sky;
    night.sunEnabled = false;
    on.tile->setSky(night);
    ASSERT_TRUE(on.tile->update(context->state()).ok());
    EXPECT_FALSE(on.tile->shadowEdges());
}
