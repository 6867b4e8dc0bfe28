// What a tile costs, in bytes and runs of stages.
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/PyramidLayout.h"
#include "support/GlContext.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <gtest/gtest.h>

#include <map>
#include <string>

using namespace osgTerrainLight;

namespace
{
constexpr int width = 64, height = 48;
constexpr std::size_t posts = width * height;
constexpr int azimuths = 16;

/// Of `bench --generate fractal --size 64,48 --posts 0 --azimuths 16` with the program of before
/// tiles declared their work (commit b5d67e3), column memory_bytes of each sweep.
constexpr std::size_t bytesWithoutBounces = 1758728;

osg::ref_ptr<TileLight> lit(osg::State& state, int bounces)
{
    LightingSettings settings;
    settings.azimuths = azimuths;
    settings.bounces = bounces;
    const osg::ref_ptr<TileLight> lighting =
        new TileLight(generateTerrain(TerrainKind::Fractal, width, height, 30.0, 1).value(),
                      settings, SkyLight());
    const Status done = lighting->update(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    return lighting;
}

/// Runs by stage, of those that ran.
std::map<std::string, unsigned> runsOf(const TileLight& lighting)
{
    std::map<std::string, unsigned> runs;
    for (const StageCost& cost : lighting.costs())
        if (cost.dispatches > 0)
            runs[cost.name] = cost.dispatches;
    return runs;
}
} // namespace

TEST(TileCost, WithoutBouncesIsWhatItWasBeforeWorkWasDeclared)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<TileLight> lighting = lit(context->state(), 0);
    EXPECT_EQ(lighting->bytes(), bytesWithoutBounces);
    const std::map<std::string, unsigned> expected = {
        {"horizon", 1}, {"sky", 1}, {"sun", 1}, {"shade", 1}};
    EXPECT_EQ(runsOf(*lighting), expected);
    lighting->releaseGLObjects(&context->state());
}

// Half floats of four channels but for the heights' pyramid of two floats: direct light, and of
// each bounce its light, what cells send, and the pyramid of that. A length of a step per azimuth
// and row, and a texel of albedo.
TEST(TileCost, OfBouncesIsOneTextureOfLightAndOneOfWhatIsSentForEach)
{
    OTL_NEED_GL(context);
    const PyramidLayout heights = PyramidLayout::ofPosts(width, height);
    const PyramidLayout cells = PyramidLayout::ofCells(width - 1, height - 1);
    const auto texels = [](const PyramidLayout& layout)
    { return static_cast<std::size_t>(layout.width * layout.height); };
    const std::size_t once =
        8 * posts + 8 * texels(heights) + 4u * azimuths * std::size_t(height) + 8;
    const std::size_t each =
        8 * posts + 8u * std::size_t((width - 1) * (height - 1)) + 8 * texels(cells);
    for (const unsigned bounces : {1u, 3u})
    {
        const osg::ref_ptr<TileLight> lighting = lit(context->state(), int(bounces));
        EXPECT_EQ(lighting->bytes(), bytesWithoutBounces + once + bounces * each) << bounces;
        const std::map<std::string, unsigned> expected = {
            {"horizon", 1}, {"sky", 1},        {"sun", 1},          {"shade", 1},
            {"pyramid", 1}, {"sent", bounces}, {"bounce", bounces}, {"compose", 1}};
        EXPECT_EQ(runsOf(*lighting), expected) << bounces;
        lighting->releaseGLObjects(&context->state());
    }
}
