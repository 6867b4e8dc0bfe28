#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "gpu/GlConstants.h"
#include "lighting/TileLight.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"

#include <osg/Camera>
#include <osg/GLExtensions>
#include <osg/Program>

#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

using namespace osgTerrainLight;

namespace
{
constexpr int side = 33;
constexpr double spacing = 20.0;
constexpr double reach = 320.0; // from the middle to an edge

const float notANumber = std::numeric_limits<float>::quiet_NaN();
const float infinite = std::numeric_limits<float>::infinity();

/// Rough ground, another for each seed. voids: also what becomes void, by every way there is.
std::vector<float> roughHeights(int width, int height, unsigned seed, bool voids = false)
{
    const float empty[] = {notANumber, -notANumber, infinite, -infinite, 1.1e6f, -3.0e38f};
    std::vector<float> heights;
    for (unsigned i = 0; i < static_cast<unsigned>(width * height); ++i)
    {
        unsigned bits = (i + 1) * 2654435761u ^ seed * 40503u;
        bits = (bits ^ bits >> 15) * 2246822519u;
        bits ^= bits >> 13;
        heights.push_back(static_cast<float>(bits % 4096u) * 0.025f);
        if (voids && bits % 17u == 0)
            heights.back() = empty[bits / 17u % 6u];
    }
    return heights;
}

DemTile tileOf(const std::vector<float>& heights, int width, int height)
{
    DemTile tile(width, height, spacing);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            tile.setHeight(column, row, heights[static_cast<std::size_t>(row * width + column)]);
    return tile;
}

/// All that a tile's light is, bit by bit.
struct Light
{
    std::vector<float> shading, skyView;
    std::vector<std::uint16_t> horizons;

    static Light of(TileLight& lighting, osg::State& state)
    {
        const Status done = lighting.update(state);
        EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
        Light light;
        const Raster<osg::Vec4f> shading = lighting.readShading(state);
        for (const osg::Vec4f& texel : shading.values())
            for (unsigned c = 0; c < 4; ++c)
                light.shading.push_back(texel[c]);
        light.skyView = lighting.readSkyView(state).values();
        light.horizons = lighting.readHorizons(state).codes();
        return light;
    }
    bool operator==(const Light& other) const
    {
        return same(shading, other.shading) && same(skyView, other.skyView) &&
               horizons == other.horizons;
    }

private:
    static bool same(const std::vector<float>& a, const std::vector<float>& b)
    {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * 4) == 0;
    }
};

LightingSettings fewAzimuths()
{
    LightingSettings settings;
    settings.azimuths = 8;
    return settings;
}

osg::ref_ptr<TileLight> lightingOf(const DemTile& tile)
{
    return new TileLight(tile, fewAzimuths(), SkyLight());
}

Light freshLight(const std::vector<float>& heights, int width, int height, osg::State& state)
{
    const osg::ref_ptr<TileLight> fresh = lightingOf(tileOf(heights, width, height));
    const Light light = Light::of(*fresh, state);
    fresh->releaseGLObjects(&state);
    return light;
}

/// A texture as a host makes it for its own passes to write.
osg::ref_ptr<osg::Texture2D> hostTexture(int width, int height)
{
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D;
    texture->setTextureSize(width, height);
    texture->setInternalFormat(GL_R32F);
    texture->setSourceFormat(GL_RED);
    texture->setSourceType(GL_FLOAT);
    texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR);
    return texture;
}

/// A host's pass that writes heights: a bump of 100 m, 8 posts wide, about a column of the middle
/// row; outside of it 0. voids: column 0 is not a number, column 1 infinite, column 2 too high.
class HostPass : public osg::Referenced
{
public:
    explicit HostPass(osg::Texture2D* texture) : _texture(texture), _program(new osg::Program)
    {
        _program->addShader(new osg::Shader(osg::Shader::COMPUTE, R"(#version 430
            layout(local_size_x = 1, local_size_y = 1) in;
            layout(r32f, binding = 0) writeonly uniform image2D heights;
            uniform float column;
            uniform bool voids;
            void main()
            {
                ivec2 post = ivec2(gl_GlobalInvocationID.xy);
                float middle = 0.5 * float(gl_NumWorkGroups.y - 1u);
                bool inside = abs(float(post.x) - column) <= 4.0 && abs(float(post.y) - middle) <= 4.0;
                float height = inside ? 100.0 : 0.0;
                if (voids && post.x == 0)
                    height = uintBitsToFloat(0x7fc00000u);
                if (voids && post.x == 1)
                    height = uintBitsToFloat(0x7f800000u);
                if (voids && post.x == 2)
                    height = 1.5e6;
                imageStore(heights, post, vec4(height));
            })"));
    }

    static std::vector<float> heights(int width, int height, float column, bool voids)
    {
        std::vector<float> values;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                values.push_back(voids && x < 3 ? notANumber
                                 : std::abs(float(x) - column) <= 4.0f &&
                                         std::abs(float(y) - 0.5f * float(height - 1)) <= 4.0f
                                     ? 100.0f
                                     : 0.0f);
        return values;
    }

    void run(osg::State& state, float column, bool voids) const
    {
        const auto* extensions = state.get<osg::GLExtensions>();
        state.setActiveTextureUnit(0);
        _texture->apply(state);
        _program->apply(state);
        osg::ref_ptr<osg::Uniform> uniform = new osg::Uniform("column", column);
        osg::ref_ptr<osg::Uniform> withVoids = new osg::Uniform("voids", voids);
        _program->getPCP(state)->apply(*uniform);
        _program->getPCP(state)->apply(*withVoids);
        extensions->glBindImageTexture(0, _texture->getTextureObject(state.getContextID())->id(), 0,
                                       GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
        extensions->glDispatchCompute(static_cast<GLuint>(_texture->getTextureWidth()),
                                      static_cast<GLuint>(_texture->getTextureHeight()), 1);
        extensions->glUseProgram(0);
        state.setLastAppliedProgramObject(nullptr);
        state.haveAppliedAttribute(osg::StateAttribute::PROGRAM);
        state.haveAppliedTextureAttribute(0, osg::StateAttribute::TEXTURE);
    }

private:
    osg::ref_ptr<osg::Texture2D> _texture;
    osg::ref_ptr<osg::Program> _program;
};

/// Square bump of 100 m, 8 posts wide, about a column of the middle row.
struct Bump
{
    std::atomic<float> column{8.0f};
    bool operator()(double, int width, int height, float* heights)
    {
        const float now = column;
        if (now == _shown)
            return false;
        _shown = now;
        const std::vector<float> values = HostPass::heights(width, height, now, false);
        std::copy(values.begin(), values.end(), heights);
        return true;
    }

private:
    float _shown = -1.0f;
};

osg::ref_ptr<DynamicTerrain> levelGround()
{
    return new DynamicTerrain(analytic::plane(side, side, spacing, 0.0));
}

osg::ref_ptr<DynamicTerrain> groundWith(const std::shared_ptr<Bump>& bump)
{
    osg::ref_ptr<DynamicTerrain> terrain = levelGround();
    terrain->setHeightCallback([bump](double time, int width, int height, float* heights)
                               { return (*bump)(time, width, height, heights); });
    return terrain;
}

osg::ref_ptr<TerrainLighting> litTerrain(DynamicTerrain* terrain)
{
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    lighting->addChild(terrain);
    EXPECT_TRUE(lighting->addTile(terrain));
    return lighting;
}

/// Height of what the picture shows at a place: x east and y north of the middle, -1 … 1; the
/// camera of ScenePicture is 5e5 m up and sees from 1 m to 1e6 m below it.
double heightSeen(double x, double y)
{
    const int column = static_cast<int>(std::lround((0.5 + 0.5 * x) * (ScenePicture::size - 1)));
    const int row = static_cast<int>(std::lround((0.5 + 0.5 * y) * (ScenePicture::size - 1)));
    float depth = 0.0f;
    glReadPixels(column, row, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    return 5.0e5 - (1.0 + static_cast<double>(depth) * (1.0e6 - 1.0));
}
// 24 bits over 1e6 m are steps of 0.06 m; a float near 0.5 is as fine.
constexpr double depthStep = 0.25;

double placeOf(double column)
{
    return (column - 0.5 * (side - 1)) * spacing / reach;
}

/// Names of GL objects in use, by scanning.
std::vector<int> glObjects(osg::State& state)
{
    const auto* extensions = state.get<osg::GLExtensions>();
    std::vector<int> counts(4, 0);
    for (GLuint id = 1; id < 8192; ++id)
    {
        counts[0] += glIsTexture(id);
        counts[1] += extensions->glIsBuffer(id);
        counts[2] += extensions->glIsProgram(id);
        counts[3] += extensions->glIsShader(id);
    }
    return counts;
}

double residentBytes()
{
    std::ifstream file("/proc/self/statm");
    double total = 0.0;
    double resident = 0.0;
    file >> total >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}
} // namespace

TEST(DynamicHeights, SetHeightsLightAsANewTileWithThem)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const struct
    {
        int width, height;
    } sizes[] = {{33, 33}, {40, 17}, {1, 9}, {1, 1}};
    for (const auto& size : sizes)
    {
        SCOPED_TRACE(std::to_string(size.width) + " x " + std::to_string(size.height));
        const osg::ref_ptr<TileLight> lighting =
            lightingOf(tileOf(roughHeights(size.width, size.height, 1), size.width, size.height));
        std::vector<Light> seen;
        for (unsigned seed : {1u, 2u, 3u})
            for (bool voids : {false, true})
            {
                const std::vector<float> heights =
                    roughHeights(size.width, size.height, seed, voids);
                lighting->setHeights(heights);
                seen.push_back(Light::of(*lighting, state));
                EXPECT_TRUE(seen.back() == freshLight(heights, size.width, size.height, state))
                    << "seed " << seed << (voids ? " with voids" : "");
            }
        // And back again.
        lighting->setHeights(roughHeights(size.width, size.height, 1));
        EXPECT_TRUE(Light::of(*lighting, state) == seen[0]);
        lighting->setHeights(roughHeights(size.width, size.height, 3, true));
        EXPECT_TRUE(Light::of(*lighting, state) == seen[5]);
        EXPECT_EQ(seen[0] == seen[5], size.width == 1 && size.height == 1);
        lighting->releaseGLObjects(&state);
    }
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicHeights, EveryQualityAndLightFollows)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const std::vector<float> heights = roughHeights(20, 15, 7, true);
    for (const HorizonQuality quality :
         {HorizonQuality::Draft, HorizonQuality::Normal, HorizonQuality::Best})
        for (int parts = 0; parts < 4; ++parts)
        {
            LightingSettings settings = fewAzimuths();
            settings.quality = quality;
            SkyLight sky;
            sky.skyEnabled = parts % 2 == 1;
            sky.sunEnabled = parts / 2 == 1;
            const osg::ref_ptr<TileLight> lighting =
                new TileLight(analytic::plane(20, 15, spacing, 3.0), settings, sky);
            ASSERT_TRUE(lighting->update(state).ok());
            lighting->setHeights(heights);
            ASSERT_TRUE(lighting->update(state).ok());
            const osg::ref_ptr<TileLight> fresh =
                new TileLight(tileOf(heights, 20, 15), settings, sky);
            ASSERT_TRUE(fresh->update(state).ok());
            EXPECT_TRUE(lighting->readShading(state).values() == fresh->readShading(state).values())
                << parts;
            lighting->releaseGLObjects(&state);
            fresh->releaseGLObjects(&state);
        }
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicHeights, ATextureOfTheHostLightsAsANewTileWithItsHeights)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    constexpr int width = 40;
    constexpr int height = 25;
    const osg::ref_ptr<osg::Texture2D> texture = hostTexture(width, height);
    const osg::ref_ptr<HostPass> pass = new HostPass(texture);
    const osg::ref_ptr<TileLight> lighting =
        lightingOf(analytic::plane(width, height, spacing, 5.0));
    lighting->setHeightTexture(texture);
    for (bool voids : {false, true})
        for (float column : {10.0f, 25.0f, 10.0f})
        {
            pass->run(state, column, voids);
            lighting->touchHeights();
            EXPECT_TRUE(
                Light::of(*lighting, state) ==
                freshLight(HostPass::heights(width, height, column, voids), width, height, state))
                << column << (voids ? " with voids" : "");
        }
    // From the texture to memory and back.
    const std::vector<float> rough = roughHeights(width, height, 4);
    lighting->setHeights(rough);
    EXPECT_TRUE(Light::of(*lighting, state) == freshLight(rough, width, height, state));
    lighting->setHeightTexture(texture);
    EXPECT_TRUE(Light::of(*lighting, state) ==
                freshLight(HostPass::heights(width, height, 10.0f, true), width, height, state));
    lighting->releaseGLObjects(&state);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicHeights, AChangeRunsEachStageOnceAndNoChangeNone)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const osg::ref_ptr<TileLight> lighting = lightingOf(analytic::plane(9, 9, spacing, 0.0));
    ASSERT_TRUE(lighting->update(state).ok());
    LightingSettings settings;
    settings.bounces = 2;
    lighting->setSettings(settings);
    ASSERT_TRUE(lighting->update(state).ok());
    const std::vector<StageCost> still = lighting->costs();
    for (const StageCost& cost : still)
        EXPECT_NE(cost.name, "heights") << "heights that stay have no stage";
    const std::size_t before = lighting->bytes();
    for (unsigned round = 1; round <= 3; ++round)
    {
        lighting->setHeights(roughHeights(9, 9, round));
        EXPECT_TRUE(lighting->isDirty(state.getContextID()));
        for (int i = 0; i < 3; ++i)
        {
            ASSERT_TRUE(lighting->update(state).ok());
            EXPECT_FALSE(lighting->isDirty(state.getContextID()));
        }
        const std::vector<StageCost> costs = lighting->costs();
        ASSERT_EQ(costs.size(), still.size() + 1);
        EXPECT_EQ(costs[0].name, "heights");
        EXPECT_EQ(costs[0].dispatches, round);
        for (std::size_t i = 1; i < costs.size(); ++i)
        {
            // Of a light or a surface that is not there: none, ever.
            const unsigned runs = still[i - 1].dispatches;
            const bool isPerBounce = costs[i].name == "sent" || costs[i].name == "bounce";
            EXPECT_EQ(costs[i].dispatches, runs > 0 ? runs + (isPerBounce ? 2 : 1) * round : 0)
                << costs[i].name;
        }
    }
    EXPECT_EQ(lighting->bytes(), before + 9 * 9 * 4) << "the posts, for the upload";
    SkyLight sky;
    sky.sunAzimuth = 12.0;
    lighting->setSky(sky);
    ASSERT_TRUE(lighting->update(state).ok());
    EXPECT_EQ(lighting->costs()[0].dispatches, 3u);
    EXPECT_EQ(lighting->costs()[1].dispatches, still[0].dispatches + 3);
    lighting->releaseGLObjects(&state);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicHeights, EachContextHasTheNewestAndAnotherThreadMaySetThem)
{
    OTL_NEED_GL(first);
    std::string problem;
    const std::unique_ptr<HeadlessContext> second = HeadlessContext::create(16, 16, problem);
    ASSERT_TRUE(second) << problem;
    ASSERT_NE(first->state().getContextID(), second->state().getContextID());
    const osg::ref_ptr<TileLight> lighting = lightingOf(analytic::plane(16, 12, spacing, 0.0));
    for (unsigned seed = 1; seed < 4; ++seed)
    {
        lighting->setHeights(roughHeights(16, 12, seed, true));
        for (HeadlessContext* context : {first, second.get()})
        {
            context->makeCurrent();
            EXPECT_TRUE(Light::of(*lighting, context->state()) ==
                        freshLight(roughHeights(16, 12, seed, true), 16, 12, context->state()));
            EXPECT_FALSE(lighting->isDirty(context->state().getContextID()));
        }
    }
    first->makeCurrent();
    std::atomic<bool> stop{false};
    std::thread setter(
        [&]
        {
            for (unsigned seed = 0; !stop; ++seed)
            {
                lighting->setHeights(roughHeights(16, 12, seed % 5));
                std::this_thread::sleep_for(std::chrono::microseconds(300));
            }
            lighting->setHeights(roughHeights(16, 12, 42));
        });
    for (int i = 0; i < 50; ++i)
        EXPECT_TRUE(lighting->update(first->state()).ok());
    stop = true;
    setter.join();
    for (HeadlessContext* context : {second.get(), first})
    {
        context->makeCurrent();
        EXPECT_TRUE(Light::of(*lighting, context->state()) ==
                    freshLight(roughHeights(16, 12, 42), 16, 12, context->state()));
        EXPECT_EQ(takeGlErrors(), "");
        lighting->releaseGLObjects(&context->state());
    }
}

TEST(DynamicTerrain, TheMeshAndItsLightFollowABumpThatMoves)
{
    OTL_NEED_GL(context);
    Said said;
    const auto bump = std::make_shared<Bump>();
    const osg::ref_ptr<DynamicTerrain> terrain = groundWith(bump);
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    SkyLight sky;
    sky.sunAzimuth = 270.0; // the bump's shadow falls to the east
    sky.sunElevation = 45.0;
    lighting->setSkyLight(sky);
    ScenePicture picture(lighting, reach);
    std::vector<unsigned char> first;
    for (float column : {8.0f, 20.0f, 8.0f})
    {
        bump->column = column;
        picture.draw();
        const double other = column == 8.0f ? 20.0 : 8.0;
        EXPECT_NEAR(heightSeen(placeOf(double(column)), 0.0), 100.0, depthStep);
        EXPECT_NEAR(heightSeen(placeOf(other), 0.0), 0.0, depthStep);
        // Two posts behind the bump's foot, in its shadow, against ground that is in the sun.
        EXPECT_LT(picture.redAt(placeOf(double(column) + 7.5), 0.0),
                  picture.redAt(placeOf(other), 0.7) - 40.0);
        if (first.empty())
            first = picture.pixels();
    }
    EXPECT_TRUE(picture.pixels() == first) << "back again";
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(lighting->getFailure(), "");
    EXPECT_EQ(takeGlErrors(), "");

    // A terrain that was made with these heights looks the same.
    osg::ref_ptr<DynamicTerrain> still =
        new DynamicTerrain(tileOf(HostPass::heights(side, side, 8.0f, false), side, side));
    osg::ref_ptr<TerrainLighting> stillLit = litTerrain(still);
    stillLit->setSkyLight(sky);
    ScenePicture stillPicture(stillLit, reach);
    stillPicture.draw();
    EXPECT_TRUE(stillPicture.pixels() == first);
    EXPECT_EQ(stillLit->getDispatchCounts().count("heights"), 0u);
}

TEST(DynamicTerrain, ACallbackThatChangesNothingCostsNoDispatch)
{
    OTL_NEED_GL(context);
    int calls = 0;
    bool change = false;
    osg::ref_ptr<DynamicTerrain> terrain = levelGround();
    terrain->setHeightCallback(
        [&](double, int width, int height, float* heights)
        {
            EXPECT_EQ(width, side);
            EXPECT_EQ(height, side);
            ++calls;
            if (change)
                heights[17] += 1.0f;
            return change;
        });
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    lighting->addChild(terrain); // it stands in two places
    ScenePicture picture(lighting, reach);
    picture.draw(5);
    EXPECT_EQ(calls, 5);
    EXPECT_EQ(lighting->getDispatchCount(), 4u);
    change = true;
    picture.draw(3);
    EXPECT_EQ(lighting->getDispatchCount(), 4u + 3u * 5u);
    EXPECT_EQ(lighting->getDispatchCounts().at("heights"), 3u);
    change = false;
    picture.draw(5);
    EXPECT_EQ(calls, 13);
    EXPECT_EQ(lighting->getDispatchCount(), 4u + 3u * 5u);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicTerrain, ATextureOfTheHostLooksAsTheCallback)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<osg::Texture2D> texture = hostTexture(side, side);
    /// As a host would: drawn before the lighting, with no barrier.
    class Writer : public osg::Drawable
    {
    public:
        explicit Writer(osg::Texture2D* written) : pass(new HostPass(written))
        {
            setCullingActive(false);
            setUseDisplayList(false);
        }
        void drawImplementation(osg::RenderInfo& info) const override
        {
            pass->run(*info.getState(), column, true);
        }
        osg::ref_ptr<HostPass> pass;
        float column = 8.0f;
    };
    const osg::ref_ptr<Writer> writer = new Writer(texture);
    osg::ref_ptr<osg::Camera> camera = new osg::Camera;
    camera->setRenderOrder(osg::Camera::PRE_RENDER, -2000);
    camera->setClearMask(0);
    camera->setCullingActive(false);
    camera->addChild(writer);

    osg::ref_ptr<DynamicTerrain> byTexture = levelGround();
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(byTexture);
    lighting->addChild(camera);
    EXPECT_TRUE(byTexture->setHeightTexture(texture));
    byTexture->setHeightRange(0.0f, 100.0f);
    ScenePicture picture(lighting, reach);

    std::vector<float> given;
    osg::ref_ptr<DynamicTerrain> byCallback = levelGround();
    byCallback->setHeightCallback(
        [&](double, int, int, float* heights)
        {
            std::copy(given.begin(), given.end(), heights);
            return true;
        });
    osg::ref_ptr<TerrainLighting> otherLighting = litTerrain(byCallback);
    ScenePicture otherPicture(otherLighting, reach);
    for (float column : {8.0f, 20.0f, 21.0f})
    {
        writer->column = column;
        byTexture->dirtyHeights();
        picture.draw();
        EXPECT_NEAR(heightSeen(placeOf(double(column)), 0.0), 100.0, depthStep);
        given = HostPass::heights(side, side, column, true);
        otherPicture.draw();
        EXPECT_TRUE(picture.pixels() == otherPicture.pixels()) << column;
    }
    const unsigned spent = lighting->getDispatchCount();
    picture.draw(3);
    EXPECT_EQ(lighting->getDispatchCount(), spent) << "not said to have changed";

    EXPECT_TRUE(byTexture->setHeightTexture(nullptr)); // the first heights again
    picture.draw();
    EXPECT_NEAR(heightSeen(placeOf(20), 0.0), 0.0, depthStep);
    EXPECT_NEAR(heightSeen(placeOf(1), 0.0), 0.0, depthStep);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicTerrain, VoidsAreHolesAndMayBeFilled)
{
    OTL_NEED_GL(context);
    DemTile tile = analytic::plane(side, side, spacing, 0.0);
    for (int row = 4; row <= 8; ++row)
        for (int column = 4; column <= 8; ++column)
            tile.setVoid(column, row);
    osg::ref_ptr<DynamicTerrain> terrain = new DynamicTerrain(tile);
    float fill = notANumber;
    float elsewhere = 0.0f;
    bool sawVoid = false;
    terrain->setHeightCallback(
        [&](double, int width, int, float* heights)
        {
            sawVoid = sawVoid || std::isnan(heights[6 * width + 6]);
            for (int row = 4; row <= 8; ++row)
                for (int column = 4; column <= 8; ++column)
                {
                    heights[row * width + column] = fill;
                    heights[(row + 16) * width + column + 16] = elsewhere;
                }
            return true;
        });
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    ScenePicture picture(lighting, reach);
    const double inside = placeOf(6);
    const double other = placeOf(22);
    const auto isHole = [&](double place)
    { return picture.redAt(place, place) == 0.0; }; // the background is blue
    for (bool lit : {true, false})
    {
        lighting->setLightEnabled(lit);
        fill = notANumber;
        elsewhere = 0.0f;
        picture.draw();
        EXPECT_TRUE(isHole(inside));
        EXPECT_FALSE(isHole(other));
        fill = 10.0f;
        for (float empty : {infinite, -infinite, notANumber, 2.0e6f, -1.0e30f})
        {
            elsewhere = empty;
            picture.draw();
            EXPECT_FALSE(isHole(inside)) << empty;
            EXPECT_TRUE(isHole(other)) << empty;
            EXPECT_NEAR(heightSeen(inside, inside), 10.0, depthStep);
        }
    }
    EXPECT_TRUE(sawVoid);
    EXPECT_LT(terrain->getBound().radius(), 500.0);
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: black in the dark, with gloss too; gloss of the host per post is drawn where the
// settings have none, and in its half alone.
TEST(DynamicTerrain, IsGlossyWhereThereIsLight)
{
    OTL_NEED_GL(context);
    Said said;
    osg::ref_ptr<DynamicTerrain> terrain = levelGround();
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    SkyLight sky;
    sky.sunEnabled = sky.skyEnabled = false;
    sky.skyRadiance = {0.1f, 0.1f, 0.1f};
    lighting->setSkyLight(sky);
    LightingSettings settings = lighting->getSettings();
    settings.gloss = 0.8;
    lighting->setSettings(settings);
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    EXPECT_EQ(picture.redAt(0.5, 0.0), 0.0);
    sky.skyEnabled = true;
    lighting->setSkyLight(sky);
    picture.draw(2);
    const double bright = picture.redAt(0.5, 0.0);
    settings.gloss = 0.0;
    lighting->setSettings(settings);
    picture.draw(2);
    const double plain = picture.redAt(0.5, 0.0);
    EXPECT_GT(plain, 10.0);
    EXPECT_GT(bright, plain + 20.0);

    std::vector<std::array<float, 2>> gloss(static_cast<std::size_t>(side * side), {0.0f, 1.0f});
    for (std::size_t i = 0; i < gloss.size(); ++i)
        if (i % static_cast<std::size_t>(side) > static_cast<std::size_t>(side) / 2)
            gloss[i] = {0.8f, 8.0f};
    EXPECT_TRUE(lighting->setTileGloss(lighting->getTileHandles().front(), gloss));
    picture.draw(2);
    EXPECT_NEAR(picture.redAt(0.5, 0.0), bright, 1.5);
    EXPECT_NEAR(picture.redAt(-0.5, 0.0), plain, 1.5);
    EXPECT_TRUE(lighting->setTileGloss(lighting->getTileHandles().front(), {}));
    picture.draw(2);
    EXPECT_NEAR(picture.redAt(0.5, 0.0), plain, 1.5);
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");

    EXPECT_FALSE(lighting->setTileGloss(TileHandle::at(1, 2, 3), gloss));
    gloss.pop_back();
    EXPECT_FALSE(lighting->setTileGloss(lighting->getTileHandles().front(), gloss));
    gloss.push_back({0.5f, 0.5f});
    EXPECT_FALSE(lighting->setTileGloss(lighting->getTileHandles().front(), gloss));
    EXPECT_EQ(said.count("gloss of tile not set: "), 3);
}

// Expected: the picture is the same, from another texture unit; and no unit for two textures.
TEST(DynamicTerrain, HeightsHaveTheTextureUnitThatWasSet)
{
    OTL_NEED_GL(context);
    Said said;
    const auto bump = std::make_shared<Bump>();
    const osg::ref_ptr<DynamicTerrain> terrain = groundWith(bump);
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    const std::vector<unsigned char> before = picture.pixels();
    terrain->setHeightUnit(12);
    picture.draw();
    EXPECT_EQ(picture.pixels(), before);
    EXPECT_NEAR(heightSeen(placeOf(8), 0.0), 100.0, depthStep);
    const auto texture = osg::StateAttribute::TEXTURE;
    EXPECT_TRUE(terrain->getStateSet()->getTextureAttribute(12, texture));
    EXPECT_FALSE(terrain->getStateSet()->getTextureAttribute(DynamicTerrain::heightUnit, texture));
    terrain->setHeightUnit(32);
    EXPECT_EQ(terrain->getHeightUnit(), 12u);
    EXPECT_EQ(said.count("height unit not set"), 1);
    const osg::ref_ptr<TerrainLighting> other = lightingWithBudget(0.0, 8);
    other->setTextureUnit(12);
    EXPECT_FALSE(other->addTile(terrain));
    EXPECT_EQ(said.count("not added"), 1);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicTerrain, IsDisplacedWithoutLightToo)
{
    OTL_NEED_GL(context);
    Said said;
    const auto bump = std::make_shared<Bump>();
    const osg::ref_ptr<DynamicTerrain> terrain = groundWith(bump);
    {
        ScenePicture picture(terrain, reach); // no TerrainLighting at all
        picture.draw();
        EXPECT_NEAR(heightSeen(placeOf(8), 0.0), 100.0, depthStep);
        EXPECT_NEAR(picture.redAt(placeOf(8), 0.0), 255.0, 1.0) << "level, under the lamp";
        bump->column = 20.0f;
        picture.draw();
        EXPECT_NEAR(heightSeen(placeOf(20), 0.0), 100.0, depthStep);
        EXPECT_NEAR(heightSeen(placeOf(8), 0.0), 0.0, depthStep);
    }
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    ScenePicture picture(lighting, reach);
    picture.draw();
    lighting->setLightEnabled(false);
    const unsigned spent = lighting->getDispatchCount();
    for (float column : {12.0f, 24.0f})
    {
        bump->column = column;
        picture.draw();
        EXPECT_NEAR(heightSeen(placeOf(double(column)), 0.0), 100.0, depthStep);
    }
    EXPECT_NEAR(picture.redAt(0.0, 0.5), 255.0, 1.0);
    EXPECT_EQ(lighting->getDispatchCount(), spent);
    lighting->setLightEnabled(true);
    picture.draw();
    EXPECT_GT(lighting->getDispatchCount(), spent);
    EXPECT_LT(picture.redAt(0.0, 0.5), 250.0);

    // It comes and goes, and is left as it was.
    const osg::StateAttribute* lit =
        terrain->getStateSet()->getAttribute(osg::StateAttribute::PROGRAM);
    EXPECT_TRUE(lighting->removeTile(lighting->getTileHandles().front()));
    picture.draw(4);
    EXPECT_NE(terrain->getStateSet()->getAttribute(osg::StateAttribute::PROGRAM), lit);
    EXPECT_FALSE(terrain->getStateSet()->getUniform(ShadingTexture::sampler));
    EXPECT_NEAR(heightSeen(placeOf(24), 0.0), 100.0, depthStep);
    EXPECT_NEAR(picture.redAt(0.0, 0.5), 255.0, 1.0);
    EXPECT_TRUE(lighting->addTile(terrain));
    picture.draw();
    EXPECT_LT(picture.redAt(0.0, 0.5), 250.0);
    EXPECT_EQ(lighting->getTileCount(), 1u);
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicTerrain, AHostsProgramAndColoursAreKept)
{
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<DynamicTerrain> terrain = groundWith(std::make_shared<Bump>());
    osg::ref_ptr<osg::Program> program = new osg::Program;
    for (osg::Shader::Type type : {osg::Shader::VERTEX, osg::Shader::FRAGMENT})
        program->addShader(createShadingShader(type, 330));
    program->addShader(createHeightShader(osg::Shader::VERTEX));
    program->addShader(new osg::Shader(osg::Shader::VERTEX, R"(#version 330 compatibility
        out float shade;
        vec2 terrainHeight(vec2 tileCoordinate);
        vec2 terrainShadingCoordinate(vec4 source);
        vec4 terrainShading(vec2 coordinate);
        void main()
        {
            shade = terrainShading(terrainShadingCoordinate(gl_MultiTexCoord7)).a;
            vec2 height = terrainHeight(gl_MultiTexCoord7.xy);
            gl_Position = gl_ModelViewProjectionMatrix * vec4(gl_Vertex.xy, height.x + 7.0, 1.0);
        })"));
    program->addShader(new osg::Shader(osg::Shader::FRAGMENT, R"(#version 330 compatibility
        in float shade;
        void main() { gl_FragColor = vec4(shade, 0.0, 0.0, 1.0); })"));
    terrain->getStateSet()->setAttribute(program);
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    EXPECT_EQ(terrain->getStateSet()->getAttribute(osg::StateAttribute::PROGRAM), program);
    ScenePicture picture(lighting, reach);
    picture.draw();
    EXPECT_NEAR(heightSeen(placeOf(8), 0.0), 107.0, depthStep);
    EXPECT_NEAR(picture.redAt(-0.8, 0.8), 255.0, 1.0); // the whole sun

    osg::ref_ptr<DynamicTerrain> coloured = levelGround();
    osg::ref_ptr<osg::Image> green = new osg::Image;
    green->allocateImage(1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
    const unsigned char texel[] = {0, 200, 0, 255};
    std::memcpy(green->data(), texel, 4);
    coloured->getStateSet()->setTextureAttributeAndModes(0, new osg::Texture2D(green));
    lighting = litTerrain(coloured);
    ScenePicture second(lighting, reach);
    for (bool lit : {true, false})
    {
        lighting->setLightEnabled(lit);
        second.draw();
        EXPECT_EQ(second.redAt(0.0, 0.0), 0.0);
        EXPECT_GT(second.pixels()[4 * (64 * ScenePicture::size + 64) + 1], 100);
    }
    EXPECT_EQ(said.text(), "");
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(DynamicTerrain, BoundsHoldItsHeights)
{
    osg::ref_ptr<DynamicTerrain> terrain = levelGround();
    EXPECT_NEAR(terrain->getBound().radius(), std::sqrt(2.0) * reach, 0.1);
    float height = 300.0f;
    terrain->setHeightCallback(
        [&](double, int, int, float* heights)
        {
            heights[5] = height;
            return true;
        });
    osg::NodeVisitor update(osg::NodeVisitor::UPDATE_VISITOR,
                            osg::NodeVisitor::TRAVERSE_ACTIVE_CHILDREN);
    terrain->accept(update);
    EXPECT_GE(terrain->getBoundingBox().zMax(), 300.0f);
    EXPECT_EQ(terrain->getBoundingBox().zMin(), 0.0f);
    EXPECT_GT(terrain->getBound().radius(), 470.0f);
    height = -200.0f;
    terrain->accept(update);
    EXPECT_LE(terrain->getBoundingBox().zMin(), -200.0f);
    EXPECT_LE(terrain->getBoundingBox().zMax(), 400.0f);
    height = notANumber;
    terrain->accept(update);
    EXPECT_GE(terrain->getBoundingBox().zMin(), -300.0f);
    terrain->setHeightRange(-1.0f, 2.0f);
    terrain->accept(update);
    height = 50.0f;
    terrain->accept(update);
    EXPECT_EQ(terrain->getBoundingBox().zMin(), -1.0f);
    EXPECT_EQ(terrain->getBoundingBox().zMax(), 2.0f);
    Said said;
    terrain->setHeightRange(2.0f, notANumber);
    EXPECT_EQ(terrain->getBoundingBox().zMax(), 2.0f);
    EXPECT_EQ(said.count("height range not set"), 1);

    const osg::ref_ptr<DynamicTerrain> empty = new DynamicTerrain(DemTile(5, 4, 10.0));
    EXPECT_FALSE(empty->getBoundingBox().valid());
    empty->setHeightCallback(
        [](double, int, int, float* heights)
        {
            heights[0] = 1.0f;
            return true;
        });
    empty->accept(update);
    EXPECT_TRUE(empty->getBoundingBox().valid());
    EXPECT_TRUE(empty->getBound().valid());
}

TEST(DynamicTerrain, RefusesWhatItCannotUse)
{
    Said said;
    osg::ref_ptr<DynamicTerrain> terrain = levelGround();
    EXPECT_FALSE(terrain->setHeightTexture(hostTexture(side, side + 1)));
    EXPECT_EQ(said.count("texels"), 1);
    osg::ref_ptr<osg::Texture2D> texture = hostTexture(side, side);
    texture->setInternalFormat(GL_RGBA);
    EXPECT_FALSE(terrain->setHeightTexture(texture));
    EXPECT_EQ(said.count("GL_R32F"), 1);
    texture = hostTexture(side, side);
    texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR_MIPMAP_LINEAR);
    EXPECT_FALSE(terrain->setHeightTexture(texture));
    EXPECT_EQ(said.count("mipmaps"), 1);
    EXPECT_EQ(terrain->getHeightRevision(), 0u);

    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    EXPECT_FALSE(lighting->addTile(static_cast<DynamicTerrain*>(nullptr)));
    EXPECT_FALSE(lighting->addTile(new DynamicTerrain));
    EXPECT_FALSE(lighting->addTile(new DynamicTerrain(DemTile(1, 5, 10.0))));
    lighting->setTextureUnit(DynamicTerrain::heightUnit);
    EXPECT_FALSE(lighting->addTile(terrain));
    lighting->setTextureUnit(ShadingTexture::defaultUnit);
    EXPECT_TRUE(lighting->addTile(terrain));
    EXPECT_FALSE(lighting->addTile(terrain));
    EXPECT_EQ(said.count("not added"), 5);
    EXPECT_EQ(lighting->getTileCount(), 1u);

    osg::ref_ptr<osg::Object> copy = terrain->clone(osg::CopyOp::SHALLOW_COPY);
    auto* other = dynamic_cast<DynamicTerrain*>(copy.get());
    ASSERT_TRUE(other);
    EXPECT_EQ(other->getNumChildren(), 1u);
    EXPECT_NE(other->getHeightTexture(), terrain->getHeightTexture());
    EXPECT_EQ(other->getNumChildrenRequiringUpdateTraversal(),
              terrain->getNumChildrenRequiringUpdateTraversal());
}

TEST(DynamicTerrain, TwoThousandFramesLeaveNothingBehind)
{
    OTL_NEED_GL(context);
    Said said;
    constexpr int frames = 2000;
    constexpr int warmUp = 200;
    osg::ref_ptr<DynamicTerrain> terrain = levelGround();
    terrain->setHeightCallback(
        [](double, int width, int height, float* heights)
        {
            static int frame = 0;
            ++frame;
            for (int i = 0; i < width * height; ++i)
                heights[i] = i == frame % (width * height)
                                 ? notANumber
                                 : 20.0f * std::sin(0.1f * float(frame) + 0.3f * float(i % width));
            return true;
        });
    osg::ref_ptr<TerrainLighting> lighting = litTerrain(terrain);
    LightingSettings settings = lighting->getSettings();
    settings.bounces = 1;
    lighting->setSettings(settings);
    ScenePicture picture(lighting, reach);
    picture.draw(warmUp);
    const std::vector<int> objects = glObjects(picture.state());
    EXPECT_GT(objects[0], 5);
    EXPECT_GT(objects[2], 3);
    const double resident = residentBytes();
    for (int frame = warmUp; frame < frames; frame += 100)
    {
        picture.draw(100);
        ASSERT_EQ(takeGlErrors(), "") << "frame " << frame;
    }
    EXPECT_EQ(lighting->getDispatchCounts().at("shade"), static_cast<unsigned>(frames));
    EXPECT_EQ(lighting->getDispatchCounts().at("bounce"), static_cast<unsigned>(frames));
    EXPECT_EQ(glObjects(picture.state()), objects);
    // Less than one uniform or half a kilobyte per frame; what allocators keep is a tenth of it.
    const double bound = 512.0 * (frames - warmUp);
    const double growth = residentBytes() - resident;
    std::cout << "resident memory grew by " << growth / 1024 << " KiB, bound " << bound / 1024
              << " KiB" << std::endl;
    EXPECT_LT(growth, bound);
    EXPECT_EQ(said.text(), "");
}
