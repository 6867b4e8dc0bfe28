#include "gpu/GpuPass.h"
#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/Precisions.h"
#include "support/ShaderFolder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

// Third step of the proof: functions of shaders/lib on the GPU against the same source in float on
// the CPU. The tolerances leave room for what GLSL leaves to a driver: fused multiply-adds, a
// division within 2.5 units in the last place, a square root within 3, and sin and cos, which GLSL
// does not bound at all and hardware gives within 2^-20.

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double ulp = 1.0 / (1 << 23); // of 1
constexpr double sine = 1.0 / (1 << 20);

using G = CheckedGlsl<float>;

/// Runs `body` once per column of `arguments`; in it, arg(i) is row i of the column and put(i, v)
/// writes row i of the result.
Raster<float> evaluate(HeadlessContext& context, const std::string& body,
                       const Raster<float>& arguments, int results,
                       const Raster<float>& heights = Raster<float>(1, 1))
{
    static int count = 0;
    const std::string name = "test_functions_" + std::to_string(++count);
    const ShaderFile file("passes/" + name + ".comp", R"(
layout(local_size_x = 64) in;
uniform sampler2D arguments;
layout(r32f) readonly uniform image2D heights;
layout(r32f, binding = 0) writeonly uniform image2D results;
uniform int count;
int column() { return int(gl_GlobalInvocationID.x); }
float arg(int row) { return texelFetch(arguments, ivec2(column(), row), 0).x; }
void put(int row, float value) { imageStore(results, ivec2(column(), row), vec4(value)); }
void main()
{
    if (column() >= count)
        return;
)" + body + "}\n");
    const osg::ref_ptr<GpuPass> pass = new GpuPass(name);
    const osg::ref_ptr<osg::Texture2D> target = createTarget(arguments.width(), results, GL_R32F);
    const osg::ref_ptr<osg::Texture2D> input = createFloatTexture(arguments);
    const osg::ref_ptr<osg::Texture2D> surface = createFloatTexture(heights);
    pass->reads("arguments", input);
    pass->reads("heights", surface);
    pass->writes(0, target);
    pass->set("count", arguments.width());
    const Status done =
        pass->dispatch(context.state(), {GpuPass::groupsFor(arguments.width(), 64), 1, 1});
    Raster<float> found(arguments.width(), results, std::numeric_limits<float>::quiet_NaN());
    if (!done)
        ADD_FAILURE() << done.error().message;
    else
        found.values() = readFloats(context.state(), *target, 1);
    EXPECT_EQ(takeGlErrors(), "");
    return found;
}

Raster<float> framedTile(int width, int height, int frame, float level, float relief,
                         double voidShare, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    Raster<float> heights(width + 2 * frame, height + 2 * frame, G::VOID_HEIGHT);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
        {
            const float z = level + relief * static_cast<float>(uniform(random));
            if (uniform(random) >= voidShare)
                heights.at(x + frame, y + frame) = z;
        }
    return heights;
}

/// One block of receivers per column: the texel, the tangent.
constexpr int frame = 40;
const char* const nearHorizonBody = R"(
    NearRays rays;
    rays.first = ivec2(int(arg(0)), int(arg(1)));
    rays.major = ivec2(1, 0);
    rays.minor = ivec2(0, 1);
    rays.tangent = arg(2);
    NearSlopes found = nearHorizon(heights, rays, 16);
    for (int i = 0; i < 8; ++i)
        put(i, found.slopes[i]);
)";

Raster<float> blocks(int width, int height, const std::vector<float>& tangents)
{
    std::vector<std::array<float, 3>> all;
    for (const float tangent : tangents)
        for (int y = 0; y + 8 <= height; y += 8)
            for (int x = 0; x < width; ++x)
                all.push_back({float(x + frame), float(y + frame), tangent});
    Raster<float> arguments(static_cast<int>(all.size()), 3);
    for (int i = 0; i < arguments.width(); ++i)
        for (int row = 0; row < 3; ++row)
            arguments.at(i, row) = all[static_cast<std::size_t>(i)][static_cast<std::size_t>(row)];
    return arguments;
}
} // namespace

TEST(ShaderFunctions, Angles)
{
    OTL_NEED_GL(context);
    G glsl;
    Raster<float> arguments(2048, 3);
    for (int i = 0; i < arguments.width(); ++i)
    {
        arguments.at(i, 0) = std::exp2(float(i / 2 - 512) / 20.0f) * (i % 2 == 0 ? 1.0f : -1.0f);
        const float code = 1.0f + float(i) * 31.99f;
        // Off the middle of a code by less than 0.4 of it: no rounding changes the code.
        arguments.at(i, 1) = (std::floor(code) - 32768.0f + 0.4f * std::sin(float(i))) *
                             (float(pi / 2.0) / 32767.0f);
        arguments.at(i, 2) = std::floor(code) / 65535.0f;
    }
    arguments.at(0, 0) = 0.0f;
    arguments.at(1, 0) = G::NO_HORIZON;
    const Raster<float> found = evaluate(*context, R"(
    put(0, elevationOfSlope(arg(0)));
    put(1, codeOfElevation(arg(1)));
    put(2, elevationOfCode(arg(2)));
    put(3, codeOfElevation(elevationOfSlope(arg(0))));
)",
                                         arguments, 4);
    const auto stored = [](float code) { return std::lround(double(code) * 65535.0); };
    for (int i = 0; i < arguments.width(); ++i)
    {
        // π/2 − x: two units in the last place of 1 each from the difference and the quotient.
        EXPECT_NEAR(found.at(i, 0), glsl.elevationOfSlope(arguments.at(i, 0)), 4.0 * ulp);
        EXPECT_EQ(stored(found.at(i, 1)), stored(glsl.codeOfElevation(arguments.at(i, 1))));
        // code·65535 − 32768, fused or not: half a unit of 65535, in steps of π/2/32767.
        EXPECT_NEAR(found.at(i, 2), glsl.elevationOfCode(arguments.at(i, 2)),
                    (0.5 * 65536.0 * pi / 2.0 / 32767.0 + 2.0) * ulp);
    }
    EXPECT_EQ(stored(found.at(0, 3)), 32768) << "level";
    EXPECT_EQ(stored(found.at(1, 3)), 1) << "nothing ahead";
}

TEST(ShaderFunctions, CrossingHeight)
{
    OTL_NEED_GL(context);
    G glsl;
    const std::vector<float> heights = {G::VOID_HEIGHT, -5000.0f, -4999.5f, 0.0f, 8848.25f};
    const std::vector<float> weights = {
        -1e-6f, 0.0f, 1e-7f, 0.25f, 0.7f, std::nextafter(1.0f, 0.0f), 1.0f, 1.0f + 1e-6f};
    Raster<float> arguments(200, 3);
    for (int i = 0; i < 200; ++i)
    {
        arguments.at(i, 0) = heights[static_cast<std::size_t>(i % 5)];
        arguments.at(i, 1) = heights[static_cast<std::size_t>(i / 5 % 5)];
        arguments.at(i, 2) = weights[static_cast<std::size_t>(i / 25)];
    }
    const Raster<float> found = evaluate(*context, R"(
    float height = crossingHeight(arg(0), arg(1), arg(2));
    put(0, height);
    put(1, isVoid(height) ? 1.0 : 0.0);
)",
                                         arguments, 2);
    for (int i = 0; i < 200; ++i)
    {
        const float a = arguments.at(i, 0);
        const float b = arguments.at(i, 1);
        const float expected = glsl.crossingHeight(a, b, arguments.at(i, 2));
        EXPECT_EQ(found.at(i, 1) != 0.0f, glsl.isVoid(expected)) << i;
        if (!glsl.isVoid(expected))
        {
            EXPECT_NEAR(found.at(i, 0), expected, 2.0 * ulp * double(std::abs(a) + std::abs(b)));
        }
        if (a == b)
        {
            EXPECT_EQ(found.at(i, 0), a) << "level ground stays level";
        }
    }
}

TEST(ShaderFunctions, PostNormal)
{
    OTL_NEED_GL(context);
    G glsl;
    const Raster<float> heights = framedTile(20, 15, 1, 700.0f, 30.0f, 0.2, 5);
    Raster<float> arguments(20 * 15, 2);
    for (int i = 0; i < arguments.width(); ++i)
    {
        arguments.at(i, 0) = float(i % 20 + 1);
        arguments.at(i, 1) = float(i / 20 + 1);
    }
    const Raster<float> found = evaluate(*context, R"(
    vec3 normal = postNormal(heights, ivec2(int(arg(0)), int(arg(1))), 12.0, 25.0);
    put(0, normal.x);
    put(1, normal.y);
    put(2, normal.z);
)",
                                         arguments, 3, heights);
    for (int i = 0; i < arguments.width(); ++i)
    {
        const glm::ivec2 post(i % 20 + 1, i / 20 + 1);
        if (glsl.isVoid(heights.at(post.x, post.y)))
            continue;
        const auto normal = glsl.postNormal(heights, post, 12.0f, 25.0f);
        // Two products, their sum, the inverse root (3) and its product, each of a part of 1.
        for (int row = 0; row < 3; ++row)
            EXPECT_NEAR(found.at(i, row), normal[row], 8.0 * ulp);
    }
}

TEST(ShaderFunctions, InsideMaximum)
{
    OTL_NEED_GL(context);
    G glsl;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    Raster<float> arguments(4096, 5);
    for (int i = 0; i < arguments.width(); ++i)
    {
        const float s1 = 1.0f + 15.0f * uniform(random);
        const float s2 = s1 + 0.05f + 0.95f * uniform(random);
        const float c = 8.0f * (uniform(random) - 0.8f);
        const float at = s1 + (s2 - s1) * (1.5f * uniform(random) - 0.25f);
        const float a = c * at * at;
        arguments.at(i, 0) = s1;
        arguments.at(i, 1) = s2;
        arguments.at(i, 2) = a / s1 + c * s1;
        arguments.at(i, 3) = a / s2 + c * s2;
        arguments.at(i, 4) = c;
    }
    const Raster<float> found = evaluate(*context, R"(
    put(0, insideMaximum(intervalBetween(arg(0), arg(1)), arg(2), arg(3), arg(4)));
)",
                                         arguments, 1);
    int inner = 0;
    for (int i = 0; i < arguments.width(); ++i)
    {
        const float s1 = arguments.at(i, 0);
        const float s2 = arguments.at(i, 1);
        const float g1 = arguments.at(i, 2);
        const float g2 = arguments.at(i, 3);
        const float c = arguments.at(i, 4);
        const float expected = glsl.insideMaximum(glsl.intervalBetween(s1, s2), g1, g2, c);
        inner += expected > G::NO_HORIZON;
        // At the ends the maximum is the end's own slope, so that which side of them a driver takes
        // the place for does not matter. Rounding: as on the CPU, horizon_test.
        const double size = std::abs(g1) + std::abs(g2) + 3.0f * std::abs(c) * s2;
        EXPECT_NEAR(std::max({g1, g2, found.at(i, 0)}), std::max({g1, g2, expected}),
                    8.0 * ulp * size * double(s2 / (s2 - s1)));
    }
    EXPECT_GT(inner, 1000);
}

TEST(ShaderFunctions, HidesOrEquals)
{
    OTL_NEED_GL(context);
    std::mt19937 random(51);
    std::uniform_int_distribution<int> height(-30, 30);
    std::uniform_int_distribution<int> step(1, 12);
    Raster<float> arguments(4096, 6);
    for (int i = 0; i < arguments.width(); ++i)
    {
        arguments.at(i, 1) = 100.0f;
        arguments.at(i, 3) = arguments.at(i, 1) - float(step(random));
        arguments.at(i, 5) = arguments.at(i, 3) - float(step(random));
        for (const int row : {0, 2, 4})
            arguments.at(i, row) = float(height(random));
    }
    const Raster<float> found = evaluate(*context, R"(
    put(0, hidesOrEquals(vec2(arg(0), arg(1)), vec2(arg(2), arg(3)), vec2(arg(4), arg(5))) ? 1.0 : 0.0);
)",
                                         arguments, 1);
    for (int i = 0; i < arguments.width(); ++i)
    {
        // Whole numbers: exact, ties included.
        const auto at = [&](int row) { return static_cast<std::int64_t>(arguments.at(i, row)); };
        EXPECT_EQ(found.at(i, 0) != 0.0f,
                  (at(4) - at(0)) * (at(1) - at(3)) >= (at(2) - at(0)) * (at(1) - at(5)));
    }
}

TEST(ShaderFunctions, NearHorizon)
{
    OTL_NEED_GL(context);
    G glsl;
    const float relief = 50.0f;
    const Raster<float> heights = framedTile(24, 16, frame, 100.0f, relief, 0.05, 17);
    const Raster<float> arguments =
        blocks(24, 16, {0.0f, 1.0f, 0.5f, 0.25f, 0.6180339f, 0.123f, 0.9371f});
    const Raster<float> found = evaluate(*context, nearHorizonBody, arguments, 8, heights);
    // As between float and double on the CPU (slopeBound of horizon_test), in whole units for
    // halves.
    const double bound = ulp * (4.0 * 150.0 + 24.0 * double(relief) * 16.0);
    int compared = 0;
    for (int i = 0; i < arguments.width(); ++i)
    {
        G::NearRays rays;
        rays.first = {int(arguments.at(i, 0)), int(arguments.at(i, 1))};
        rays.major = {1, 0};
        rays.minor = {0, 1};
        rays.tangent = arguments.at(i, 2);
        const auto expected = glsl.nearHorizon(heights, rays, 16);
        for (int k = 0; k < 8; ++k)
        {
            if (glsl.isVoid(heights.at(rays.first.x, rays.first.y + k)))
                continue;
            const float slope = expected.slopes[k];
            if (slope < -1e9f)
            {
                EXPECT_LT(found.at(i, k), -1e9f);
            }
            else
            {
                EXPECT_NEAR(found.at(i, k), slope, bound);
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 1000);
}

TEST(ShaderFunctions, LevelGroundWithVoidsHasNoHorizonAboveIt)
{
    OTL_NEED_GL(context);
    G glsl;
    const Raster<float> heights = framedTile(24, 24, frame, -5000.0f, 0.0f, 0.3, 9);
    std::vector<float> tangents;
    for (int c = 1; c <= 13; ++c)
        for (int w = 0; w <= c; ++w)
            tangents.push_back(float(w) / float(c));
    const Raster<float> arguments = blocks(24, 24, tangents);
    const Raster<float> found = evaluate(*context, nearHorizonBody, arguments, 8, heights);
    int level = 0;
    for (int i = 0; i < arguments.width(); ++i)
        for (int k = 0; k < 8; ++k)
            if (!glsl.isVoid(heights.at(int(arguments.at(i, 0)), int(arguments.at(i, 1)) + k)))
            {
                const float slope = found.at(i, k);
                ASSERT_TRUE(slope == 0.0f || slope < -1e9f)
                    << slope << " tangent " << arguments.at(i, 2);
                level += slope == 0.0f;
            }
    EXPECT_GT(level, 10000);
}

TEST(ShaderFunctions, Sky)
{
    OTL_NEED_GL(context);
    G glsl;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    Raster<float> arguments(2048, 5);
    for (int i = 0; i < arguments.width(); ++i)
    {
        arguments.at(i, 0) = 1.5f * uniform(random);            // elevation, and over the disc's
        arguments.at(i, 1) = std::abs(uniform(random)) * 1.57f; // normal's angle from the zenith
        arguments.at(i, 2) = float(pi) * uniform(random);       // its azimuth from the slice's
        arguments.at(i, 3) = float(pi) * std::abs(uniform(random));
        arguments.at(i, 4) = i % 2 == 0 ? 0.1f : 0.4f;
    }
    const Raster<float> found = evaluate(*context, R"(
    float nz = cos(arg(1));
    vec3 normal = vec3(sin(arg(1)) * cos(arg(2)), sin(arg(1)) * sin(arg(2)), nz);
    put(0, sliceIrradiance(arg(3), nz, normal.x, arg(4)));
    put(1, planeZenithAngle(max(nz, 0.1), normal.x));
    put(2, visibleDiscFraction(arg(0), 1.2));
    for (int definition = 0; definition < 3; ++definition)
        put(3 + definition, skySlice(arg(0), normal, 1.0, 0.0, arg(4), definition));
)",
                                         arguments, 6);
    for (int i = 0; i < arguments.width(); ++i)
    {
        const float tilt = arguments.at(i, 1);
        const float nz = std::cos(tilt);
        const G::vec3 normal(std::sin(tilt) * std::cos(arguments.at(i, 2)),
                             std::sin(tilt) * std::sin(arguments.at(i, 2)), nz);
        const float width = arguments.at(i, 4);
        // Few sines each, times parts below 2·width; rounding is far below.
        const double slice = 8.0 * sine * double(width);
        EXPECT_NEAR(found.at(i, 0), glsl.sliceIrradiance(arguments.at(i, 3), nz, normal.x, width),
                    slice);
        // nh / nz is at most 10 and its quotient's sines move the angle by no more than 10 of them.
        EXPECT_NEAR(found.at(i, 1), glsl.planeZenithAngle(std::max(nz, 0.1f), normal.x),
                    22.0 * sine);
        EXPECT_NEAR(found.at(i, 2), glsl.visibleDiscFraction(arguments.at(i, 0), 1.2f), 8.0 * ulp);
        for (int definition = 0; definition < 3; ++definition)
            EXPECT_NEAR(found.at(i, 3 + definition),
                        glsl.skySlice(arguments.at(i, 0), normal, 1.0f, 0.0f, width, definition),
                        slice);
    }
}

TEST(ShaderFunctions, Shadow)
{
    OTL_NEED_GL(context);
    G glsl;
    std::mt19937 random(43);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    Raster<float> arguments(1024, 5);
    for (float& argument : arguments.values())
        argument = uniform(random);
    const Raster<float> found = evaluate(*context, R"(
    Shadow a = addCrest(noShadow(), 100.0 * arg(0), 50.0 + 40.0 * arg(1), 0.5);
    Shadow b = addCrest(a, 100.0 * arg(2), 50.0 + 40.0 * arg(3), 0.5);
    Shadow mixed = mixShadows(a, b, 0.5 + 0.5 * arg(4));
    vec2 over = overShadow(mixed, 0.0, elevationOfSlope(0.5), 0.5, 0.01, 30.0);
    put(0, mixed.height);
    put(1, over.x);
    put(2, meanDiscFraction(2.0 * arg(0), 2.0 * arg(1)));
    put(3, shadowCrossing(arg(0), arg(1)));
)",
                                         arguments, 4);
    for (int i = 0; i < arguments.width(); ++i)
    {
        const auto arg = [&](int row) { return arguments.at(i, row); };
        const auto a =
            glsl.addCrest(glsl.noShadow(), 100.0f * arg(0), 50.0f + 40.0f * arg(1), 0.5f);
        const auto b = glsl.addCrest(a, 100.0f * arg(2), 50.0f + 40.0f * arg(3), 0.5f);
        const auto mixed = glsl.mixShadows(a, b, 0.5f + 0.5f * arg(4));
        const auto over =
            glsl.overShadow(mixed, 0.0f, glsl.elevationOfSlope(0.5f), 0.5f, 0.01f, 30.0f);
        // Heights of up to 150 m.
        EXPECT_NEAR(found.at(i, 0), mixed.height, 150.0 * 8.0 * ulp);
        EXPECT_NEAR(found.at(i, 1), over.x, 150.0 * 16.0 * ulp);
        // Quotients by more than 0.1 of what is below 2.
        EXPECT_NEAR(found.at(i, 2), glsl.meanDiscFraction(2.0f * arg(0), 2.0f * arg(1)),
                    2.0 / 0.1 * 8.0 * ulp);
        EXPECT_NEAR(found.at(i, 3), glsl.shadowCrossing(arg(0), arg(1)), 8.0 * ulp);
    }
}

// Eight steps of a line, entered one by one and joined in pairs, seen from beyond.
TEST(ShaderFunctions, LineHistory)
{
    OTL_NEED_GL(context);
    G glsl;
    std::mt19937 random(41);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    Raster<float> arguments(1024, 12);
    for (float& argument : arguments.values())
        argument = uniform(random);
    const Raster<float> found = evaluate(*context, R"(
    SliceGather slice = startGather(-0.5, vec3(0.0), 0.2);
    vec4 light = vec4(0.0);
    for (int pair = 3; pair >= 0; --pair)
    {
        Passed steps[2];
        for (int i = 0; i < 2; ++i)
        {
            int at = 2 * pair + i;
            steps[i] = passedStep(40.0 * arg(at), float(at), 20.0 * (arg(at) - arg(at + 1)),
                                  vec3(arg(at) + 1.0, 1.0, 2.0), vec3(arg(at) + 2.0, 0.5, 2.0), 30.0);
        }
        Passed piece = joinPassed(steps[0], pair == 2 ? passedNothing() : steps[1], 30.0);
        light += piece.light;
        put(pair, piece.end.y);
        slice = addPassed(slice, piece, 2.0, 10.0 * arg(9), 10.0, 30.0, 0.5 + arg(10), 0.2);
    }
    put(4, light.x);
    put(5, light.w);
    put(6, slice.highest);
    vec3 normal = normalize(vec3(0.3 * arg(11), 0.2, 1.0));
    put(7, received(slice, normal, 0.6, 0.8).x);
)",
                                         arguments, 8);
    for (int column = 0; column < arguments.width(); ++column)
    {
        const auto arg = [&](int row) { return arguments.at(column, row); };
        auto slice = glsl.startGather(-0.5f, G::vec3(0.0f), 0.2f);
        G::vec4 light(0.0f);
        for (int pair = 3; pair >= 0; --pair)
        {
            std::array<decltype(glsl.passedNothing()), 2> steps;
            for (int i = 0; i < 2; ++i)
            {
                const int at = 2 * pair + i;
                steps[std::size_t(i)] =
                    glsl.passedStep(40.0f * arg(at), float(at), 20.0f * (arg(at) - arg(at + 1)),
                                    G::vec3(arg(at) + 1.0f, 1.0f, 2.0f),
                                    G::vec3(arg(at) + 2.0f, 0.5f, 2.0f), 30.0f);
            }
            const auto piece =
                glsl.joinPassed(steps[0], pair == 2 ? glsl.passedNothing() : steps[1], 30.0f);
            light += piece.light;
            EXPECT_EQ(found.at(column, pair), piece.end.y);
            slice = glsl.addPassed(slice, piece, 2.0f, 10.0f * arg(9), 10.0f, 30.0f, 0.5f + arg(10),
                                   0.2f);
        }
        // Eight products of up to 2 and 40.
        EXPECT_NEAR(found.at(column, 4), light.x, 8.0 * 80.0 * 4.0 * ulp);
        EXPECT_NEAR(found.at(column, 5), light.w, 8.0 * 40.0 * 4.0 * ulp);
        EXPECT_NEAR(found.at(column, 6), slice.highest, 8.0 * ulp);
        const G::vec3 normal = glm::normalize(G::vec3(0.3f * arg(11), 0.2f, 1.0f));
        // Light of up to 2, of moments up to 0.3, which change by less than 0.2 per unit of slope.
        EXPECT_NEAR(found.at(column, 7), glsl.received(slice, normal, 0.6f, 0.8f).x,
                    2.0 * 8.0 * (sine + 8.0 * ulp));
    }
}

namespace
{
// A tile of posts, and rays from them: `walks` has the ray and its post in rows 0 ... 4, in row 5 a
// share of 0 ... 1 for whatever a test needs.
constexpr int tileWidth = 24, tileHeight = 16;
constexpr float stepLength = 30.0f; // [m]
// Heights up to 150 m are mixed from two, and slopes are their differences over 30 m.
constexpr double heightBound = 8.0 * 150.0 * ulp;
const glm::ivec2 tileSize(tileWidth, tileHeight);

Raster<float> tileWithVoids()
{
    return framedTile(tileWidth, tileHeight, frame, 100.0f, 50.0f, 0.05, 23);
}

Raster<float> walks()
{
    std::mt19937 random(31);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    Raster<float> arguments(2048, 6);
    for (int i = 0; i < arguments.width(); ++i)
    {
        arguments.at(i, 0) = uniform(random);                       // turn
        arguments.at(i, 1) = i % 2 == 0 ? 1.0f : -1.0f;             // look
        arguments.at(i, 2) = float(i / 2 % 2);                      // north
        arguments.at(i, 3) = float(random() % unsigned(tileWidth)); // the post
        arguments.at(i, 4) = float(random() % unsigned(tileHeight));
        arguments.at(i, 5) = std::abs(uniform(random));
    }
    return arguments;
}

/// The same in GLSL and here.
const std::string walkBody = R"(
    ivec2 size = ivec2(24, 16);
    ivec2 post = ivec2(int(arg(3)), int(arg(4)));
    GridRay ray = gridRay(arg(0), int(arg(1)), arg(2) != 0.0);
    Length here = postHeight(heights, post + 40);
    float share = arg(5);
)";
struct Walk
{
    Walk(G& glsl, const Raster<float>& heights, const Raster<float>& arguments, int i)
        : post(int(arguments.at(i, 3)), int(arguments.at(i, 4))),
          ray(glsl.gridRay(arguments.at(i, 0), int(arguments.at(i, 1)),
                           arguments.at(i, 2) != 0.0f)),
          here(glsl.postHeight(heights, post + frame)), share(arguments.at(i, 5))
    {
    }
    glm::ivec2 post;
    G::GridRay ray;
    float here, share;
};
} // namespace

// Six samples along a ray.
TEST(ShaderFunctions, Rays)
{
    OTL_NEED_GL(context);
    G glsl;
    const Raster<float> heights = tileWithVoids();
    const Raster<float> arguments = walks();
    const Raster<float> found = evaluate(*context, walkBody + R"(
    put(0, ownCellSlope(heights, post + 40, here, ray) / 30.0);
    for (int i = 1; i <= 6; ++i)
        put(i, heightAtStep(heights, post, ray, i, size, 40));
    put(7, onSurface(vec2(post) + 3.0 * ray.step, size, 1.0e-3) ? 1.0 : 0.0);
)",
                                         arguments, 8, heights);
    int read = 0;
    for (int i = 0; i < arguments.width(); ++i)
    {
        const Walk walk(glsl, heights, arguments, i);
        if (glsl.isVoid(walk.here))
            continue;
        const float own =
            glsl.ownCellSlope(heights, walk.post + frame, walk.here, walk.ray) / stepLength;
        if (own > -1e9f)
        {
            EXPECT_NEAR(found.at(i, 0), own, heightBound / double(stepLength));
        }
        for (int step = 1; step <= 6; ++step)
        {
            const float z = glsl.heightAtStep(heights, walk.post, walk.ray, step, tileSize, frame);
            if (glsl.isVoid(z))
                EXPECT_TRUE(glsl.isVoid(found.at(i, step)));
            else
                EXPECT_NEAR(found.at(i, step), z, heightBound);
        }
        const G::vec2 place = G::vec2(walk.post) + 3.0f * walk.ray.step;
        EXPECT_EQ(found.at(i, 7) != 0.0f, glsl.onSurface(place, tileSize, 1.0e-3f));
        ++read;
    }
    EXPECT_GT(read, 1500);
}

// Samples along a ray, gathered in both ways.
TEST(ShaderFunctions, Gather)
{
    OTL_NEED_GL(context);
    G glsl;
    const Raster<float> heights = tileWithVoids();
    const Raster<float> arguments = walks();
    const Raster<float> found = evaluate(*context, walkBody + R"(
    Slope cap = slopeOfCode(0.5 + 0.45 * share);
    Slope plane = planeSlope(vec3(0.6, 0.0, 0.8), 0.8, 0.6);
    SliceGather slice = startGather(plane, vec3(1.0), 0.2);
    LegendreGather legendre = startLegendreGather(plane);
    Slope own = ownCellSlope(heights, post + 40, here, ray) / 30.0;
    slice = addSegment(slice, own, vec3(1.0), cap, 0.2);
    for (int i = 1; i <= 6; ++i)
    {
        Slope slope = (heightAtStep(heights, post, ray, i, size, 40) - here) / (30.0 * float(i));
        slice = addSegment(slice, slope, vec3(float(i)), cap, 0.2);
        legendre = addLegendreSegment(legendre, slice.highest, vec3(float(i)), 0.5);
    }
    put(0, slice.highest);
    slice = closeGather(slice, cap, 0.2);
    put(1, slice.upward.x);
    put(2, slice.outward.y);
    put(3, legendre.red.x);
    put(4, legendre.blue.w);
)",
                                         arguments, 5, heights);
    int read = 0;
    for (int i = 0; i < arguments.width(); ++i)
    {
        const Walk walk(glsl, heights, arguments, i);
        if (glsl.isVoid(walk.here))
            continue;
        const float cap = glsl.slopeOfCode(0.5f + 0.45f * walk.share);
        const float plane = glsl.planeSlope(G::vec3(0.6f, 0.0f, 0.8f), 0.8f, 0.6f);
        auto slice = glsl.startGather(plane, G::vec3(1.0f), 0.2f);
        auto legendre = glsl.startLegendreGather(plane);
        const float own =
            glsl.ownCellSlope(heights, walk.post + frame, walk.here, walk.ray) / stepLength;
        slice = glsl.addSegment(slice, own, G::vec3(1.0f), cap, 0.2f);
        for (int step = 1; step <= 6; ++step)
        {
            const float z = glsl.heightAtStep(heights, walk.post, walk.ray, step, tileSize, frame);
            const float slope = (z - walk.here) / (stepLength * float(step));
            slice = glsl.addSegment(slice, slope, G::vec3(float(step)), cap, 0.2f);
            legendre = glsl.addLegendreSegment(legendre, slice.highest, G::vec3(float(step)), 0.5f);
        }
        // The horizon is a tangent, of an angle up to 81 degrees: 42 times the sines' error.
        const double slopeBound = heightBound / double(stepLength) + 42.0 * sine;
        EXPECT_NEAR(found.at(i, 0), slice.highest, slopeBound);
        slice = glsl.closeGather(slice, cap, 0.2f);
        // Moments change by less than 0.2 per unit of slope, and light is up to 6.
        const double light = 7.0 * 6.0 * (0.2 * slopeBound + 8.0 * ulp);
        EXPECT_NEAR(found.at(i, 1), slice.upward.x, light);
        EXPECT_NEAR(found.at(i, 2), slice.outward.y, light);
        // Legendre slices change by less than 2, and are divided by a weight of a half.
        EXPECT_NEAR(found.at(i, 3), legendre.red.x, 20.0 * light);
        EXPECT_NEAR(found.at(i, 4), legendre.blue.w, 20.0 * light);
        ++read;
    }
    EXPECT_GT(read, 1500);
}

// Reads of pyramids at places along rays.
TEST(ShaderFunctions, Pyramids)
{
    OTL_NEED_GL(context);
    G glsl;
    const Raster<float> heights = tileWithVoids();
    const Raster<float> arguments = walks();
    const Raster<float> found = evaluate(*context, walkBody + R"(
    vec2 place = vec2(post) + 3.0 * ray.step;
    int number = pyramidLevel(4.0 * share, 4);
    vec2 texel = pyramidTexel(ivec4(24, 0, 12, 8), place, number);
    put(0, texel.x);
    put(1, texel.y);
    texel = cellPyramidTexel(ivec4(24, 0, 12, 8), place, number);
    put(2, texel.x);
    put(3, texel.y);
    vec2 read = vec2(100.0 * share, share);
    put(4, pyramidHeight(read));
    put(5, slopeOfRise(pyramidRise(read, 60.0), 3.0, 30.0));
)",
                                         arguments, 6, heights);
    for (int i = 0; i < arguments.width(); ++i)
    {
        const Walk walk(glsl, heights, arguments, i);
        const G::vec2 place = G::vec2(walk.post) + 3.0f * walk.ray.step;
        const int number = glsl.pyramidLevel(4.0f * walk.share, 4);
        const G::vec2 onPosts = glsl.pyramidTexel({24, 0, 12, 8}, place, number);
        const G::vec2 onCells = glsl.cellPyramidTexel({24, 0, 12, 8}, place, number);
        for (int c = 0; c < 2; ++c)
        {
            EXPECT_NEAR(found.at(i, c), onPosts[c], 64.0 * ulp);
            EXPECT_NEAR(found.at(i, 2 + c), onCells[c], 64.0 * ulp);
        }
        const G::vec2 read(100.0f * walk.share, walk.share);
        const float slope = glsl.slopeOfRise(glsl.pyramidRise(read, 60.0f), 3.0f, stepLength);
        EXPECT_EQ(glsl.isVoid(found.at(i, 4)), glsl.isVoid(glsl.pyramidHeight(read)));
        EXPECT_EQ(found.at(i, 5) < -1e9f, slope < -1e9f);
        if (walk.share > 0.5f)
        {
            EXPECT_NEAR(found.at(i, 4), 100.0, 400.0 * ulp);
            EXPECT_NEAR(found.at(i, 5), slope, 8.0 * ulp);
        }
    }
}

// Sizes are below 8, and a distance has some 10 operations with up to 3 units each. Of the
// ellipsoid the float build is within 16 roundings of its longest axis and of the distance, and
// inside within 1e-4 of the least axis, where the root may be a pole (tests/glsl); divisions and
// roots of a driver have 3 units for every one of those roundings.
TEST(ShaderFunctions, Distances)
{
    OTL_NEED_GL(context);
    G glsl;
    std::mt19937 random(17);
    std::uniform_real_distribution<float> place(-4.0f, 4.0f);
    Raster<float> arguments(2048, 3);
    for (int i = 0; i < arguments.width(); ++i)
        for (int row = 0; row < 3; ++row)
            arguments.at(i, row) = i % 7 == row ? 0.0f : place(random);
    const Raster<float> found = evaluate(*context, R"(
    vec3 p = vec3(arg(0), arg(1), arg(2));
    put(0, boxDistance(p, vec3(1.5, 0.5, 2.25)));
    put(1, cylinderDistance(p, 1.25, 2.5));
    put(2, capsuleDistance(p, vec3(-1.0, 0.5, -2.0), vec3(1.5, 1.0, 1.0), 0.75));
    put(3, ellipsoidDistance(p, vec3(3.0, 0.25, 1.0)));
)",
                                         arguments, 4);
    for (int i = 0; i < arguments.width(); ++i)
    {
        const G::vec3 p(arguments.at(i, 0), arguments.at(i, 1), arguments.at(i, 2));
        const float exact[] = {
            glsl.boxDistance(p, G::vec3(1.5f, 0.5f, 2.25f)), glsl.cylinderDistance(p, 1.25f, 2.5f),
            glsl.capsuleDistance(p, G::vec3(-1.0f, 0.5f, -2.0f), G::vec3(1.5f, 1.0f, 1.0f), 0.75f)};
        for (int row = 0; row < 3; ++row)
            EXPECT_NEAR(double(found.at(i, row)), double(exact[row]), 10.0 * 3.0 * 8.0 * ulp) << i;
        const double ellipsoid = double(glsl.ellipsoidDistance(p, G::vec3(3.0f, 0.25f, 1.0f)));
        EXPECT_NEAR(double(found.at(i, 3)), ellipsoid,
                    16.0 * 3.0 * ulp * (3.0 + std::abs(ellipsoid)) +
                        (ellipsoid < 0.0 ? 1e-4 * 0.25 : 0.0))
            << i;
    }
}
