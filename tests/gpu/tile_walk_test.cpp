// A tile that has come to its state by any path is the tile that was made with it.
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "support/GlContext.h"
#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/HeadlessContext.h>

#include <osg/GLExtensions>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int width = 19, height = 14;

/// All that setters of TileLight set.
struct TileState
{
    LightingSettings settings;
    SkyLight sky;
    Raster<Rgb> albedo;
    Raster<std::array<float, 2>> gloss;
    std::vector<float> heights; ///< empty: the tile's
};

DemTile terrain()
{
    return generateTerrain(TerrainKind::Fractal, width, height, 30.0, 3).value();
}

const std::vector<std::shared_ptr<const Environment>>& panoramas()
{
    static const auto made = []
    {
        std::vector<std::shared_ptr<const Environment>> list;
        std::mt19937 random(5);
        for (int i = 0; i < 2; ++i)
        {
            std::vector<Rgb> radiance(16 * 8);
            for (Rgb& texel : radiance)
                for (float& channel : texel)
                    channel = std::uniform_real_distribution<float>(0.0f, 1.0f)(random);
            std::string problem;
            list.push_back(createEnvironment(16, 8, radiance, problem));
        }
        return list;
    }();
    return made;
}

/// A step of a walk: changes one thing.
class Step
{
public:
    explicit Step(unsigned seed) : _random(seed) {}

    int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(_random); }
    float unit() { return std::uniform_real_distribution<float>(0.0f, 1.0f)(_random); }

    /// Changes state and lighting alike, and says what.
    std::string change(TileState& state, TileLight& lighting)
    {
        switch (below(8))
        {
        case 0:
        case 1:
        case 2:
            return changeSettings(state, lighting);
        case 3:
        case 4:
        case 5:
            return changeSky(state, lighting);
        case 6:
            return changePosts(state, lighting);
        default:
            if (below(2) == 0)
                lighting.touch();
            else
                lighting.recompute();
            return "touch";
        }
    }

private:
    std::string changeSettings(TileState& state, TileLight& lighting)
    {
        LightingSettings& s = state.settings;
        const int what = below(10);
        switch (what)
        {
        case 0:
            s.azimuths = 8 + 4 * below(2);
            break;
        case 1:
            s.quality = below(2) ? HorizonQuality::Draft : HorizonQuality::Normal;
            break;
        case 2:
            s.bounces = below(3);
            break;
        case 3:
            s.bounceMethod = below(3) ? BounceMethod::Slices : BounceMethod::Legendre;
            break;
        case 4:
            s.subsampling = 1 << below(3);
            break;
        case 5:
            s.bounceInterval = 1 + 2 * below(3);
            break;
        case 6:
            s.albedo = below(3) ? Rgb{unit(), unit(), unit()} : Rgb{};
            break;
        case 7:
            s.gloss = below(3) ? 0.4 : 0.0;
            s.glossExponent = 4.0 + 4.0 * below(2);
            break;
        case 8:
            s.bodyRadius = below(2) ? 5.0e3 : 0.0;
            break;
        default:
            s.glossTransfer = below(2) ? GlossTransfer::Vector : GlossTransfer::Scalar;
        }
        lighting.setSettings(s);
        return "settings " + std::to_string(what);
    }

    std::string changeSky(TileState& state, TileLight& lighting)
    {
        SkyLight& sky = state.sky;
        const int what = below(8);
        switch (what)
        {
        case 0:
            sky.skyEnabled = !sky.skyEnabled;
            break;
        case 1:
            sky.sunEnabled = !sky.sunEnabled;
            break;
        case 2:
            sky.sunAzimuth = 90.0 * below(4) + 10.0;
            sky.sunElevation = 25.0 * below(3) - 10.0;
            break;
        case 3:
            sky.skyRadiance = {unit(), unit(), unit()};
            break;
        case 4:
            sky.skyHarmonics.assign(std::vector<std::size_t>{0, 1, 4}[std::size_t(below(3))],
                                    Rgb{unit(), unit(), unit()});
            break;
        case 5:
            sky.skyModel = SkyModel(below(3));
            sky.turbidity = 2.0 + below(3);
            break;
        case 6:
            sky.environment = below(3) ? panoramas()[std::size_t(below(2))] : nullptr;
            sky.environmentHeading = 100.0 * below(3);
            sky.environmentGain = 0.5 + 0.5 * below(3);
            break;
        default:
            sky.keyLights.assign(std::size_t(below(3)), KeyLight());
            for (KeyLight& key : sky.keyLights)
            {
                key.azimuth = 90.0 * below(4);
                key.width = 20.0 + 20.0 * below(2);
                key.radiance = {unit(), unit(), unit()};
            }
        }
        lighting.setSky(sky);
        return "sky " + std::to_string(what);
    }

    std::string changePosts(TileState& state, TileLight& lighting)
    {
        const int what = below(3);
        const bool empty = below(3) == 0;
        if (what == 0)
        {
            state.albedo = {};
            if (!empty)
                state.albedo = Raster<Rgb>(width, height);
            for (Rgb& post : state.albedo.values())
                post = {unit(), unit(), unit()};
            lighting.setAlbedo(state.albedo);
        }
        else if (what == 1)
        {
            state.gloss = {};
            if (!empty)
                state.gloss = Raster<std::array<float, 2>>(width, height, {0.0f, 1.0f});
            if (below(2))
                for (auto& post : state.gloss.values())
                    post = {0.5f * unit(), 1.0f + 8.0f * unit()};
            lighting.setGloss(state.gloss);
        }
        else
        {
            state.heights.resize(width * height);
            for (float& post : state.heights)
                post = unit() < 0.02f ? std::numeric_limits<float>::quiet_NaN() : 60.0f * unit();
            lighting.setHeights(state.heights);
        }
        return "posts " + std::to_string(what);
    }

    std::mt19937 _random;
};

struct Outcome
{
    std::vector<osg::Vec4f> shading;
    std::vector<float> gloss; ///< empty: there is none
    std::size_t bytes = 0;
};

/// After light has stood still until nothing is left to be done.
Outcome outcomeOf(TileLight& lighting, osg::State& state)
{
    for (int i = 0; i < 3 && (i == 0 || lighting.isDirty(state.getContextID())); ++i)
    {
        const Status done = lighting.update(state);
        EXPECT_TRUE(done.ok()) << done.error().message;
    }
    EXPECT_FALSE(lighting.isDirty(state.getContextID()));
    Outcome outcome;
    outcome.shading = lighting.readShading(state).values();
    if (lighting.glossLight())
        outcome.gloss = lighting.readGlossLight(state);
    outcome.bytes = lighting.bytes();
    return outcome;
}

Outcome freshOutcome(const TileState& state, osg::State& context)
{
    const osg::ref_ptr<TileLight> lighting = new TileLight(terrain(), state.settings, state.sky);
    if (!state.heights.empty())
        lighting->setHeights(state.heights);
    lighting->setAlbedo(state.albedo);
    lighting->setGloss(state.gloss);
    Outcome outcome = outcomeOf(*lighting, context);
    lighting->releaseGLObjects(&context);
    return outcome;
}

/// Texture units in which a program of the context has samplers of two types, which OpenGL forbids
/// to run (4.3, section 7.10); each as a line.
std::string samplersInConflict(osg::State& state)
{
    std::string found;
    const auto* gl = state.get<osg::GLExtensions>();
    for (GLuint program = 1; program < 4096; ++program)
    {
        GLint linked = 0, count = 0;
        gl->glGetProgramiv(program, GL_LINK_STATUS, &linked);
        if (takeGlErrors() != "" || !linked)
            continue;
        gl->glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &count);
        std::map<GLint, GLenum> types;
        for (GLint i = 0; i < count; ++i)
        {
            char name[256] = {};
            GLint size = 0;
            GLenum type = 0;
            gl->glGetActiveUniform(program, static_cast<GLuint>(i), 256, nullptr, &size, &type,
                                   name);
            if (type != GL_SAMPLER_2D && type != GL_SAMPLER_2D_ARRAY)
                continue;
            GLint unit = 0;
            gl->glGetUniformiv(program, gl->glGetUniformLocation(program, name), &unit);
            if (types.emplace(unit, type).first->second != type)
                found += std::string(name) + " in unit " + std::to_string(unit) + "\n";
        }
    }
    return found;
}
} // namespace

// Expected: bits and bytes of a tile that was made with the state, a few times on the way and at
// the end of each walk.
TEST(TileWalk, EndsWhereAFreshTileBegins)
{
    OTL_NEED_GL(shared);
    // Of its own: the test looks at all its programs.
    std::string problem;
    const std::unique_ptr<HeadlessContext> context = HeadlessContext::create(16, 16, problem);
    ASSERT_TRUE(context) << problem;
    context->makeCurrent();
    osg::State& gl = context->state();
    for (unsigned seed = 1; seed <= 6; ++seed)
    {
        Step step(seed);
        TileState state;
        state.settings.azimuths = 8;
        state.settings.quality = HorizonQuality::Draft;
        const osg::ref_ptr<TileLight> lighting =
            new TileLight(terrain(), state.settings, state.sky);
        std::string path;
        for (int i = 1; i <= 40; ++i)
        {
            path += step.change(state, *lighting) + ", ";
            if (step.below(3) > 0)
            {
                const Status done = lighting->update(gl);
                ASSERT_TRUE(done.ok()) << done.error().message << "; " << path;
                path += "update, ";
            }
            if (i % 10 != 0)
                continue;
            const Outcome found = outcomeOf(*lighting, gl);
            const Outcome expected = freshOutcome(state, gl);
            EXPECT_TRUE(found.shading == expected.shading) << seed << ": " << path;
            EXPECT_TRUE(found.gloss == expected.gloss) << seed << ": " << path;
            EXPECT_EQ(found.bytes, expected.bytes) << seed << ": " << path;
            path += "compared, ";
        }
        EXPECT_EQ(takeGlErrors(), "");
        EXPECT_EQ(samplersInConflict(gl), "");
        lighting->releaseGLObjects(&gl);
    }
    shared->makeCurrent();
}
