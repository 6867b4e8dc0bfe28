// What a tile beside coarser ones shows, in its definition, and that the shader of hosts shows it.
#include "support/EdgeBlend.h"

#include "gpu/GpuPass.h"
#include "gpu/ShaderLibrary.h"
#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"
#include <osgTerrainLight/ShadingTexture.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
/// Light of a level at posts of the whole terrain: each level has its own.
float lightAt(int level, int column, int row)
{
    const int step = 1 << level;
    return 1.0f + 0.25f * static_cast<float>(level) +
           0.3f * std::sin(0.7f * static_cast<float>(column * step) +
                           0.4f * static_cast<float>(row * step));
}

Raster<float> lightOf(int level, const PostRect& place)
{
    Raster<float> light(place.width, place.height);
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
            light.at(column, row) = lightAt(level, place.column + column, place.row + row);
    return light;
}

/// What a tile of `level` shows at a post of level 0, bilinear.
float shown(int level, int column, int row)
{
    const int step = 1 << level;
    const auto floored = [step](int post) { return (post - ((post % step) + step) % step) / step; };
    const int i = floored(column);
    const int j = floored(row);
    const float x = static_cast<float>(column - i * step) / static_cast<float>(step);
    const float y = static_cast<float>(row - j * step) / static_cast<float>(step);
    const float south = (1.0f - x) * lightAt(level, i, j) + x * lightAt(level, i + 1, j);
    const float north = (1.0f - x) * lightAt(level, i, j + 1) + x * lightAt(level, i + 1, j + 1);
    return (1.0f - y) * south + y * north;
}

float smooth(float x)
{
    return x * x * (3.0f - 2.0f * x);
}
} // namespace

TEST(EdgeBlend, IsOneWithoutCoarserNeighbours)
{
    const Raster<float> weights = edgeBlend(11, 7, {});
    for (const float weight : weights.values())
        EXPECT_EQ(weight, 1.0f);
}

// Along one edge: 0 on it, a smooth step over 8 posts, 1 beyond.
TEST(EdgeBlend, RisesSmoothlyFromAnEdge)
{
    CoarserNeighbours coarser;
    coarser.east = true;
    const Raster<float> weights = edgeBlend(33, 20, coarser);
    for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 33; ++column)
        {
            const float away = std::min(static_cast<float>(32 - column) / 8.0f, 1.0f);
            EXPECT_FLOAT_EQ(weights.at(column, row), smooth(away));
        }
}

// Two edges: the lesser. A corner alone: round.
TEST(EdgeBlend, CornersAreTheLesserOrRound)
{
    CoarserNeighbours edges;
    edges.south = true;
    edges.west = true;
    CoarserNeighbours corner;
    corner.southWest = true;
    const Raster<float> lesser = edgeBlend(40, 30, edges);
    const Raster<float> round = edgeBlend(40, 30, corner);
    for (int row = 0; row < 30; ++row)
        for (int column = 0; column < 40; ++column)
        {
            const auto part = [](float away) { return smooth(std::min(away / 8.0f, 1.0f)); };
            const float x = static_cast<float>(column);
            const float y = static_cast<float>(row);
            EXPECT_FLOAT_EQ(lesser.at(column, row), std::min(part(x), part(y)));
            EXPECT_FLOAT_EQ(round.at(column, row), part(std::hypot(x, y)));
        }
    EXPECT_EQ(lesser.at(0, 29), 0.0f);
    EXPECT_EQ(round.at(0, 0), 0.0f);
    EXPECT_EQ(round.at(0, 8), 1.0f);
}

// All ways in which the neighbours of two tiles at the same level can be coarser: both have the
// same weights along their common edge.
TEST(EdgeBlend, SameLevelNeighboursAgree)
{
    constexpr int size = 13;
    for (unsigned pattern = 0; pattern < 1u << 10; ++pattern)
    {
        // Two tiles, (1, 1) and (2, 1) of 4 x 3, and the 10 around them.
        const auto isCoarser = [pattern](int x, int y)
        {
            if (y == 1 && (x == 1 || x == 2))
                return false;
            const int at = 4 * y + x;
            return ((pattern >> (at > 6 ? at - 2 : at > 4 ? at - 1 : at)) & 1u) != 0u;
        };
        const auto of = [&isCoarser](int x, int y)
        {
            CoarserNeighbours coarser;
            coarser.west = isCoarser(x - 1, y);
            coarser.east = isCoarser(x + 1, y);
            coarser.south = isCoarser(x, y - 1);
            coarser.north = isCoarser(x, y + 1);
            coarser.southWest = isCoarser(x - 1, y - 1);
            coarser.southEast = isCoarser(x + 1, y - 1);
            coarser.northWest = isCoarser(x - 1, y + 1);
            coarser.northEast = isCoarser(x + 1, y + 1);
            return edgeBlend(size, size, coarser);
        };
        const Raster<float> west = of(1, 1);
        const Raster<float> east = of(2, 1);
        for (int row = 0; row < size; ++row)
            ASSERT_EQ(west.at(size - 1, row), east.at(0, row)) << pattern << ", " << row;
    }
}

// A fine tile whose eastern and northern neighbours are coarser: on the common edges it shows what
// they show, posts of theirs or not, and no jump comes in elsewhere.
TEST(EdgeBlend, ATileMeetsItsCoarserNeighbours)
{
    for (const int levels : {1, 2})
    {
        const PostRect place{-32, 64, 33, 33};
        const int step = 1 << levels;
        const PostRect parentPlace{-64 / step, 64 / step, 96 / step + 1, 64 / step + 1};
        CoarserNeighbours coarser;
        coarser.east = true;
        coarser.north = true;
        const Raster<float> weights = edgeBlend(place.width, place.height, coarser);
        const Raster<float> own = lightOf(0, place);
        Raster<float> light = own;
        blendToParent(light, place, lightOf(levels, parentPlace), parentPlace, levels, weights);
        for (int i = 0; i < 33; ++i)
        {
            EXPECT_NEAR(light.at(32, i), shown(levels, place.column + 32, place.row + i), 1e-6);
            EXPECT_NEAR(light.at(i, 32), shown(levels, place.column + i, place.row + 32), 1e-6);
        }
        float greatest = 0.0f; // jump that the mixture adds, over the difference of the two
        for (int row = 0; row < 33; ++row)
            for (int column = 0; column < 33; ++column)
            {
                const float coarse = shown(levels, place.column + column, place.row + row);
                const float part = weights.at(column, row);
                EXPECT_NEAR(light.at(column, row),
                            part * own.at(column, row) + (1.0f - part) * coarse, 1e-6);
                if (column < 24 && row < 24)
                {
                    EXPECT_EQ(light.at(column, row), own.at(column, row));
                }
                if (column > 0)
                    greatest = std::max(greatest, std::abs(part - weights.at(column - 1, row)));
                if (row > 0)
                    greatest = std::max(greatest, std::abs(part - weights.at(column, row - 1)));
            }
        EXPECT_LE(greatest, 1.5f / 8.0f); // the steepest of a smooth step
    }
}

// On an edge the parent's light is exact; voids of either leave the tile's own.
TEST(EdgeBlend, KeepsColoursAndVoids)
{
    const PostRect place{8, 8, 9, 9};
    const PostRect parentPlace{4, 4, 5, 5};
    const float none = std::numeric_limits<float>::quiet_NaN();
    Raster<Rgb> light(9, 9, Rgb{1.0f, 2.0f, 3.0f});
    Raster<Rgb> parent(5, 5, Rgb{0.1f, 0.2f, 0.7f});
    light.at(0, 0) = {none, none, none};
    parent.at(4, 4) = {none, none, none};
    CoarserNeighbours coarser;
    coarser.west = coarser.east = coarser.south = coarser.north = true;
    blendToParent(light, place, parent, parentPlace, 1, edgeBlend(9, 9, coarser));
    EXPECT_TRUE(std::isnan(light.at(0, 0)[0]));
    EXPECT_EQ(light.at(8, 8), (Rgb{1.0f, 2.0f, 3.0f}));
    EXPECT_EQ(light.at(7, 8), (Rgb{1.0f, 2.0f, 3.0f})); // beside the parent's void
    EXPECT_EQ(light.at(6, 8), (Rgb{0.1f, 0.2f, 0.7f}));
    EXPECT_EQ(light.at(0, 5), (Rgb{0.1f, 0.2f, 0.7f}));
    const float part = smooth(0.5f); // half way in from all edges
    const Rgb middle = light.at(4, 4);
    EXPECT_FLOAT_EQ(middle[0], (1.0f - part) * 0.1f + part * 1.0f);
    EXPECT_FLOAT_EQ(middle[1], (1.0f - part) * 0.2f + part * 2.0f);
    EXPECT_FLOAT_EQ(middle[2], (1.0f - part) * 0.7f + part * 3.0f);
}

namespace
{
/// terrainShading() at the posts of a tile that is drawn, which has a margin in its texture.
Raster<Rgb> shadingOf(osg::State& state, const Raster<Rgb>& own, const Raster<Rgb>& parent,
                      int margin, const CoarserNeighbours& coarser)
{
    static int count = 0;
    const std::string name = "test_borders_" + std::to_string(++count);
    const Result<std::string> host = ShaderLibrary::instance().source("host/terrain_shading.glsl");
    EXPECT_TRUE(host.ok());
    const ShaderFile file("passes/" + name + ".comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2D found;
uniform ivec2 margin;
)" + *host + R"(
void main()
{
    ivec2 post = ivec2(gl_GlobalInvocationID.xy);
    vec2 posts = vec2(textureSize(osgTerrainLight_shading, 0));
    imageStore(found, post, terrainShading((vec2(post + margin) + 0.5) / posts));
}
)");
    const int width = own.width() - 2 * margin, height = own.height() - 2 * margin;
    const osg::ref_ptr<GpuPass> pass = new GpuPass(name);
    const osg::ref_ptr<osg::Texture2D> target = createTarget(width, height, GL_RGBA32F_ARB);
    const osg::ref_ptr<osg::Texture2D> ownTexture = createColourTexture(own);
    const osg::ref_ptr<osg::Texture2D> parentTexture = createColourTexture(parent);
    pass->writes(0, target);
    pass->reads(ShadingTexture::sampler, ownTexture);
    pass->reads(ShadingTexture::formerSampler, parentTexture);
    pass->set("margin", margin, margin);
    // Tile coordinates to texels of the tile and of the parent, of which it is the north-east.
    const auto texels = [](double first, double cells, const Raster<Rgb>& raster)
    {
        return osg::Matrixd::scale(cells / raster.width(), cells / raster.height(), 1.0) *
               osg::Matrixd::translate((first + 0.5) / raster.width(),
                                       (first + 0.5) / raster.height(), 0.0);
    };
    const double cells = width - 1;
    const osg::Matrixd toOwn = texels(margin, cells, own);
    const osg::Matrixd toParent = texels(parent.width() - 1 - cells / 2.0, cells / 2.0, parent);
    pass->set(new osg::Uniform(ShadingTexture::formerMatrix,
                               osg::Matrixf(osg::Matrixd::inverse(toOwn) * toParent)));
    const auto part = [](bool isCoarser) { return isCoarser ? 1.0f : 0.0f; };
    pass->set(ShadingTexture::hasBorders, coarser.any());
    pass->set(ShadingTexture::borders, osg::Vec4f(part(coarser.west), part(coarser.south),
                                                  part(coarser.east), part(coarser.north)));
    pass->set(ShadingTexture::borderCorners,
              osg::Vec4f(part(coarser.southWest), part(coarser.southEast), part(coarser.northWest),
                         part(coarser.northEast)));
    const osg::Vec3d first = osg::Vec3d() * toOwn, last = osg::Vec3d(1.0, 1.0, 0.0) * toOwn;
    pass->set(ShadingTexture::drawn,
              osg::Vec4f(osg::Vec4d(first.x(), first.y(), last.x(), last.y())));
    pass->set(ShadingTexture::bands, osg::Vec2f(osg::Vec2d(own.width() / 8.0, own.height() / 8.0)));
    const Status done =
        pass->dispatch(state, {GpuPass::groupsFor(width, 8), GpuPass::groupsFor(height, 8), 1});
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    const std::vector<float> values = readFloats(state, *target, 4);
    Raster<Rgb> result(width, height);
    for (std::size_t i = 0; i < result.size(); ++i)
        result.at(int(i) % width, int(i) / width) = {values[4 * i], values[4 * i + 1],
                                                     values[4 * i + 2]};
    EXPECT_EQ(takeGlErrors(), "");
    return result;
}
} // namespace

// Expected: the shader of hosts gives what is defined here, for all ways in which the neighbours of
// a tile can be coarser. Lights are multiples of 1/64 below 4, exact in the textures. The mixture
// is so to 8 roundings of its parts (1e-6 of 4), and those of texture coordinates, which are out by
// 1e-5 of a band.
TEST(EdgeBlend, IsThatOfTheShader)
{
    OTL_NEED_GL(context);
    constexpr int posts = 33, margin = 5;
    std::mt19937 random(7);
    const auto noise = [&random](int size)
    {
        Raster<Rgb> light(size, size);
        for (int row = 0; row < size; ++row)
            for (int column = 0; column < size; ++column)
                for (float& value : light.at(column, row))
                    value = static_cast<float>(random() % 256) / 64.0f;
        return light;
    };
    const Raster<Rgb> own = noise(posts + 2 * margin), parent = noise(posts);
    Raster<Rgb> drawn(posts, posts);
    for (int row = 0; row < posts; ++row)
        for (int column = 0; column < posts; ++column)
            drawn.at(column, row) = own.at(column + margin, row + margin);
    for (unsigned pattern = 0; pattern < 256; pattern = pattern < 16 ? pattern + 1 : pattern + 13)
    {
        CoarserNeighbours coarser;
        bool* flags[] = {&coarser.west,      &coarser.east,      &coarser.south,
                         &coarser.north,     &coarser.southWest, &coarser.southEast,
                         &coarser.northWest, &coarser.northEast};
        for (unsigned i = 0; i < 8; ++i)
            *flags[i] = ((pattern >> i) & 1u) != 0u;
        Raster<Rgb> expected = drawn;
        const PostRect place{32, 32, posts, posts}, parentPlace{0, 0, posts, posts};
        blendToParent(expected, place, parent, parentPlace, 1, edgeBlend(posts, posts, coarser));
        const Raster<Rgb> found = shadingOf(context->state(), own, parent, margin, coarser);
        float most = 0.0f;
        for (int row = 0; row < posts; ++row)
            for (int column = 0; column < posts; ++column)
                for (std::size_t i = 0; i < 3; ++i)
                    most = std::max(
                        most, std::abs(found.at(column, row)[i] - expected.at(column, row)[i]));
        EXPECT_LE(most, 1.0e-4f) << pattern;
    }
}
