#include "core/Raster.h"
#include "core/SyntheticTerrain.h"
#include "glsl_host.h"
#include "gpu/GpuPass.h"
#include "gpu/ShaderLibrary.h"
#include "gpu/Textures.h"
#include "lighting/TileLight.h"
#include "reference/ReferenceLight.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardGround.h"
#include "support/ShaderFolder.h"

#include <osgTerrainLight/ShadingTexture.h>

#include <osg/GLExtensions>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

using namespace osgTerrainLight;

// The edge of the sun's shadow between posts, as host/terrain_shading.glsl finds it.

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double spacing = 10.0; // [m]
constexpr int width = 96, height = 9, wallColumn = 64, middleRow = 4;
constexpr int perPost = 32; // places looked at between two posts

/// What a tile's light fades from, and how much of that is there.
struct Former
{
    const TileLight& tile;
    float part;
    osg::Matrixf matrix;
};

/// terrainShading(), rgba, at places of a lit tile [posts].
std::vector<osg::Vec4f> shadingAt(osg::State& state, const TileLight& tile, const SkyLight& sky,
                                  const std::vector<osg::Vec2f>& places,
                                  const Former* former = nullptr)
{
    static int count = 0;
    const std::string name = "test_edges_" + std::to_string(++count);
    const Result<std::string> host = ShaderLibrary::instance().source("host/terrain_shading.glsl");
    EXPECT_TRUE(host.ok());
    const ShaderFile file("passes/" + name + ".comp", R"(
layout(local_size_x = 32) in;
layout(rgba32f, binding = 0) writeonly uniform image2D found;
uniform sampler2D places; // rows: x, y
)" + *host + R"(
void main()
{
    int i = int(gl_GlobalInvocationID.x);
    vec2 place = vec2(texelFetch(places, ivec2(i, 0), 0).x, texelFetch(places, ivec2(i, 1), 0).x);
    vec2 posts = vec2(textureSize(osgTerrainLight_shading, 0));
    imageStore(found, ivec2(i, 0), terrainShading((place + 0.5) / posts));
}
)");
    const int number = static_cast<int>(places.size());
    Raster<float> rows(number, 2);
    for (int i = 0; i < number; ++i)
    {
        rows.at(i, 0) = places[std::size_t(i)].x();
        rows.at(i, 1) = places[std::size_t(i)].y();
    }
    const osg::ref_ptr<GpuPass> pass = new GpuPass(name);
    const osg::ref_ptr<osg::Texture2D> target = createTarget(number, 1, GL_RGBA32F_ARB);
    const osg::ref_ptr<osg::Texture2D> input = createFloatTexture(rows);
    const osg::ref_ptr<osg::Texture2D> edges = tile.shadowEdges();
    pass->writes(0, target);
    pass->reads("places", input);
    pass->reads(ShadingTexture::sampler, tile.shading());
    pass->reads(ShadingTexture::edgeSampler, edges.get());
    pass->set(ShadingTexture::hasEdges, edges.valid());
    pass->set(ShadingTexture::posts,
              osg::Vec2f(static_cast<float>(tile.width()), static_cast<float>(tile.height())));
    pass->set(ShadingTexture::sunIrradiance,
              osg::Vec3f(sky.sunIrradiance[0], sky.sunIrradiance[1], sky.sunIrradiance[2]));
    if (former)
    {
        const osg::ref_ptr<osg::Texture2D> formerEdges = former->tile.shadowEdges();
        pass->reads(ShadingTexture::formerSampler, former->tile.shading());
        pass->reads(ShadingTexture::formerEdgeSampler, formerEdges.get());
        pass->set(ShadingTexture::formerPart, former->part);
        pass->set(new osg::Uniform(ShadingTexture::formerMatrix, former->matrix));
        if (formerEdges)
            pass->set(ShadingTexture::formerPosts,
                      osg::Vec2f(static_cast<float>(former->tile.width()),
                                 static_cast<float>(former->tile.height())));
    }
    const Status done = pass->dispatch(state, {GpuPass::groupsFor(number, 32), 1, 1});
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    const std::vector<float> values = readFloats(state, *target, 4);
    std::vector<osg::Vec4f> result;
    for (std::size_t i = 0; i < places.size(); ++i)
        result.emplace_back(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]);
    EXPECT_EQ(takeGlErrors(), "");
    return result;
}

/// The same surface with columns for rows.
DemTile transposed(const DemTile& tile)
{
    DemTile result(tile.height(), tile.width(), spacing);
    for (int y = 0; y < tile.height(); ++y)
        for (int x = 0; x < tile.width(); ++x)
            result.setHeight(y, x, tile.heightAt(x, y));
    return result;
}

/// A wall across the way of a sun in the east, or in the north.
struct Scene
{
    double rise, elevation;
    bool north;
    SkyLight sky;
    osg::ref_ptr<TileLight> tile;

    Scene(double wallRise, double sunElevation, bool edges, bool towardsNorth = false,
          int bounces = 0)
        : rise(wallRise), elevation(sunElevation), north(towardsNorth)
    {
        sky.skyEnabled = false;
        sky.sunAzimuth = north ? 0.0 : 90.0;
        sky.sunElevation = sunElevation;
        sky.sunIrradiance = {3.0f, 2.0f, 1.0f};
        LightingSettings settings;
        settings.shadowEdges = edges;
        settings.bounces = bounces;
        const DemTile heights = analytic::wall(width, height, spacing, wallColumn, rise);
        tile = new TileLight(north ? transposed(heights) : heights, settings, sky);
    }

    /// terrainShading() along the middle, towards the sun: every 1/perPost post.
    std::vector<osg::Vec4f> alongTheMiddle(osg::State& state) const
    {
        std::vector<osg::Vec2f> places;
        for (int i = 0; i < (width - 1) * perPost; ++i)
        {
            const float at = static_cast<float>(i) / perPost;
            places.push_back(north ? osg::Vec2f(middleRow, at) : osg::Vec2f(at, middleRow));
        }
        return shadingAt(state, *tile, sky, places);
    }

    /// Visible fraction of the disc at a distance from the crest [m] on the level ground.
    double visible(double distance) const
    {
        const double radius = sky.sunAngularRadius * pi / 180.0;
        const double above = elevation * pi / 180.0 - std::atan(rise / distance);
        return Glsl<double>().visibleDiscFraction(above, radius);
    }

    /// Greatest difference from the closed form on the ground behind the wall.
    double worst(osg::State& state) const
    {
        EXPECT_TRUE(tile->update(state).ok());
        const std::vector<osg::Vec4f> found = alongTheMiddle(state);
        double most = 0.0;
        for (int i = 0; i < (wallColumn - 1) * perPost; ++i)
        {
            const double expected = visible((wallColumn - double(i) / perPost) * spacing);
            const osg::Vec4f& light = found[std::size_t(i)];
            most = std::max(most, std::abs(static_cast<double>(light.a()) - expected));
            // The last post before the wall has the normal of ground and wall.
            const double facing = std::sin(elevation * pi / 180.0) / pi;
            if (i < (wallColumn - 2) * perPost)
                most = std::max(
                    most, std::abs(static_cast<double>(light.r()) / (3.0 * facing) - expected));
        }
        return most;
    }
};

/// The same bilinear surface with `parts` posts for each.
DemTile refined(const DemTile& tile, int parts)
{
    DemTile fine((tile.width() - 1) * parts + 1, (tile.height() - 1) * parts + 1,
                 tile.northSpacing / parts);
    for (int y = 0; y < fine.height(); ++y)
        for (int x = 0; x < fine.width(); ++x)
        {
            const int x0 = std::min(x / parts, tile.width() - 2);
            const int y0 = std::min(y / parts, tile.height() - 2);
            const double east = double(x) / parts - x0, north = double(y) / parts - y0;
            const auto at = [&](int i, int j)
            { return static_cast<double>(tile.heightAt(x0 + i, y0 + j)); };
            fine.setHeight(
                x, y,
                static_cast<float>((at(0, 0) * (1 - east) + at(1, 0) * east) * (1 - north) +
                                   (at(0, 1) * (1 - east) + at(1, 1) * east) * north));
        }
    return fine;
}

/// A place between posts, and the sun that is seen from it.
struct Place
{
    osg::Vec2f at;  // [posts]
    double visible; // fraction of the disc
    double facing;  // cosine to the sun of the surface there, at least 0
};

/// Mean error of the sunlight at places, over the mean of the light: absolute differences of the
/// visible fraction times the cosine.
double meanError(osg::State& state, const DemTile& tile, const SkyLight& sky, bool edges,
                 const std::vector<Place>& places)
{
    LightingSettings settings;
    settings.shadowEdges = edges;
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    EXPECT_TRUE(lighting->update(state).ok());
    std::vector<osg::Vec2f> at;
    for (const Place& place : places)
        at.push_back(place.at);
    const std::vector<osg::Vec4f> found = shadingAt(state, *lighting, sky, at);
    double error = 0.0, light = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
    {
        error += std::abs(static_cast<double>(found[i].a()) - places[i].visible) * places[i].facing;
        light += places[i].visible * places[i].facing;
    }
    lighting->releaseGLObjects(&state);
    return error / light;
}

/// Random places of a tile, by exact scans in double precision: the surface is bilinear, and is the
/// same with `parts` posts for each.
std::vector<Place> randomPlaces(const DemTile& tile, const SkyLight& sky, int number)
{
    constexpr int parts = 8;
    const DemTile fine = refined(tile, parts);
    reference::Sun sun;
    sun.azimuth = sky.sunAzimuth;
    sun.elevation = sky.sunElevation;
    sun.angularRadius = sky.sunAngularRadius;
    const std::array<double, 3> towards = sky.sunDirection();
    std::mt19937 random(36);
    std::vector<Place> places;
    for (int i = 0; i < number; ++i)
    {
        // Not on the lines between posts, where the surface has two normals.
        const auto inside = [&](int posts)
        { return int(random() % unsigned(posts - 1)) * parts + 1 + int(random() % (parts - 1)); };
        const int x = inside(tile.width()), y = inside(tile.height());
        const auto rise = [&](int east, int north)
        {
            return static_cast<double>(fine.heightAt(x + east, y + north)) -
                   static_cast<double>(fine.heightAt(x - east, y - north));
        };
        const double east = rise(1, 0) / (2.0 * fine.eastSpacing(0));
        const double north = rise(0, 1) / (2.0 * fine.northSpacing);
        const double cosine = (towards[2] - east * towards[0] - north * towards[1]) /
                              std::sqrt(1.0 + east * east + north * north);
        places.push_back({osg::Vec2f(static_cast<float>(x) / parts, static_cast<float>(y) / parts),
                          reference::sunFraction(fine, x, y, sun, 17), std::max(cosine, 0.0)});
    }
    return places;
}
} // namespace

// Expected: the disc over the wall's crest, in closed form. 3 m at 10 degrees: the edge is 17 m
// behind the wall and 1 m wide, within a cell of 10 m. 37 m: 210 m behind it and 11 m wide. The
// function of the disc is within 0.0032, half floats of heights over the shadow of up to 16 m round
// by 0.004 m, which is 0.004 of the narrowest edge; 0.01 is both and the codes of horizons.
TEST(ShadowEdges, OfAWallIsWhereItsCrestPutsIt)
{
    OTL_NEED_GL(context);
    for (const bool north : {false, true})
        for (const auto& [rise, elevation] : {std::pair{3.0, 10.0},
                                              {5.0, 10.0},
                                              {12.0, 10.0},
                                              {37.0, 10.0},
                                              {5.0, 25.0},
                                              {12.0, 25.0},
                                              {37.0, 25.0}})
        {
            const Scene blurred(rise, elevation, false, north), sharp(rise, elevation, true, north);
            const double before = blurred.worst(context->state());
            const double after = sharp.worst(context->state());
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
    const std::vector<osg::Vec4f> found = on.alongTheMiddle(context->state());
    for (int x = 0; x + 1 < width; ++x)
        for (unsigned c = 0; c < 4; ++c)
            // Half a step of floats of up to 1, from the mixed coordinates.
            EXPECT_NEAR(found[std::size_t(x * perPost)][c], before.at(x, middleRow)[c], 2.0e-3)
                << x;

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

// Expected: at part 0 own light and at part 1 former light, to the last bit, whatever is in the
// other's texture, NaN too; between, their mixture, edges included. Half of the former tile lies in
// this one: places there are those of the former tile, within the rounding of a coordinate, 2e-3 as
// above.
TEST(ShadowEdges, FadeWithTheLightThatTheyBelongTo)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const Scene sharp(12.0, 10.0, true), other(37.0, 10.0, true), blurred(12.0, 10.0, false);
    for (const Scene* scene : {&sharp, &other, &blurred})
        ASSERT_TRUE(scene->tile->update(state).ok());
    std::vector<osg::Vec2f> places, eastern;
    for (int i = 0; i < 40 * perPost; ++i)
    {
        // Both shadows are there, the other's from post 43 on, this one's from 57 on.
        places.emplace_back(static_cast<float>(i) / perPost + 20.0f, middleRow);
        eastern.emplace_back(static_cast<float>(i) / perPost + 44.0f, middleRow);
    }
    const auto mixed =
        [&](const Scene& own, const Scene& former, float part, const osg::Matrixf& matrix = {})
    {
        const Former light{*former.tile, part, matrix};
        return shadingAt(state, *own.tile, sharp.sky, places, &light);
    };
    const auto alone = [&](const Scene& scene) -> std::vector<osg::Vec4f>
    { return shadingAt(state, *scene.tile, sharp.sky, places); };
    EXPECT_EQ(mixed(sharp, other, 0.0f), alone(sharp));
    EXPECT_EQ(mixed(sharp, other, 1.0f), alone(other));
    EXPECT_EQ(mixed(blurred, sharp, 1.0f), alone(sharp));
    EXPECT_EQ(mixed(sharp, blurred, 1.0f), alone(blurred));
    const std::vector<osg::Vec4f> own = alone(sharp), before = alone(other);
    const std::vector<osg::Vec4f> half = mixed(sharp, other, 0.75f);
    const std::vector<osg::Vec4f> moved =
        mixed(sharp, other, 1.0f, osg::Matrixf::translate(24.0f / width, 0.0f, 0.0f));
    const std::vector<osg::Vec4f> there = shadingAt(state, *other.tile, sharp.sky, eastern);
    for (std::size_t i = 0; i < own.size(); ++i)
        for (unsigned c = 0; c < 4; ++c)
        {
            // Two roundings of floats of up to 1.
            EXPECT_NEAR(half[i][c], 0.25f * own[i][c] + 0.75f * before[i][c], 2.0e-6) << i;
            EXPECT_NEAR(moved[i][c], there[i][c], 2.0e-3) << i;
        }

    // Light that is not computed yet.
    osg::Texture2D& texture = *blurred.tile->shading();
    const std::vector<float> nan(4 * std::size_t(width) * height,
                                 std::numeric_limits<float>::quiet_NaN());
    state.setActiveTextureUnit(0);
    texture.apply(state);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, nan.data());
    EXPECT_TRUE(std::isnan(alone(blurred)[0].x()));
    EXPECT_EQ(mixed(blurred, other, 1.0f), before);
    EXPECT_EQ(mixed(other, blurred, 0.0f), before);
}

// In a cell with a void corner, and on a tile of one row or one column, light is that of the
// shading texture between its posts, and finite everywhere.
TEST(ShadowEdges, BesideVoidsLightIsAsWithout)
{
    OTL_NEED_GL(context);
    DemTile holed = analytic::wall(width, height, spacing, wallColumn, 12.0);
    constexpr int hole = 56; // post beside the cell of the edge, which is 68 m behind the crest
    holed.setVoid(hole, middleRow);
    SkyLight sky;
    sky.sunAzimuth = 90.0;
    sky.sunElevation = 10.0;
    const auto found = [&](const DemTile& tile, bool edges)
    {
        LightingSettings settings;
        settings.shadowEdges = edges;
        const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
        EXPECT_TRUE(lighting->update(context->state()).ok());
        std::vector<osg::Vec2f> places;
        for (int i = 0; i <= (tile.width() - 1) * 8; ++i)
            places.emplace_back(static_cast<float>(i) / 8.0f,
                                0.5f * static_cast<float>(tile.height() - 1) + 0.25f);
        return shadingAt(context->state(), *lighting, sky, places);
    };
    const std::vector<osg::Vec4f> off = found(holed, false), on = found(holed, true);
    double elsewhere = 0.0;
    for (std::size_t i = 0; i < on.size(); ++i)
    {
        const double column = double(i) / 8.0;
        const double changed =
            std::abs(static_cast<double>(on[i].a()) - static_cast<double>(off[i].a()));
        if (std::abs(column - hole) < 1.0)
        {
            EXPECT_EQ(on[i], off[i]) << column;
        }
        else
            elsewhere = std::max(elsewhere, changed);
    }
    EXPECT_GT(elsewhere, 0.1); // the edge is found
    for (const auto& [columns, rows] : {std::pair{40, 1}, {1, 40}, {1, 1}, {2, 2}})
    {
        DemTile thin(columns, rows, spacing);
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
                thin.setHeight(x, y, x + y > 20 ? 12.0f : 0.0f);
        for (const osg::Vec4f& light : found(thin, true))
            for (unsigned c = 0; c < 4; ++c)
                EXPECT_TRUE(std::isfinite(light[c]) && light[c] >= 0.0f) << columns << ' ' << rows;
    }
}

// Expected: exact scans in double precision, at places between posts. Bound: on all of these
// grounds at least a quarter of the error goes (measured: a third in towns to nine tenths).
TEST(ShadowEdges, OnHardGroundAgainstTheExactScan)
{
    OTL_NEED_GL(context);
    const std::pair<const char*, DemTile> grounds[] = {
        {"town", hard::town(65, 31)},
        {"mine", hard::mine(65, 32)},
        {"dunes", hard::dunes(65, 33)},
        {"sinkholes", hard::sinkholes(65, 34)},
        {"fractal", *generateTerrain(TerrainKind::Fractal, 65, 65, 30.0, 35)}};
    for (const auto& [name, tile] : grounds)
        for (const auto& [azimuth, elevation] :
             {std::pair{197.0, 25.0}, {90.0, 25.0}, {300.0, 10.0}})
        {
            SkyLight sky;
            sky.skyEnabled = false;
            sky.sunAzimuth = azimuth;
            sky.sunElevation = elevation;
            const std::vector<Place> places = randomPlaces(tile, sky, 3000);
            const double before = meanError(context->state(), tile, sky, false, places);
            const double after = meanError(context->state(), tile, sky, true, places);
            std::cout << name << ", sun " << azimuth << ", " << elevation << ": mean error "
                      << before << " without, " << after << " with\n";
            EXPECT_LE(after, 0.75 * before);
        }
}
