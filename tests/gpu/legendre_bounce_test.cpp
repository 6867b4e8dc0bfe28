// Bounces by the scheme of Nowrouzezahrai and Snyder 2009, on the GPU, against the same scheme in
// double (support/LegendreReference.h), against closed forms and against an exhaustive march.
#include "core/SyntheticTerrain.h"
#include "gpu/Textures.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/ComposeNode.h"
#include "lighting/nodes/LegendreBounceNode.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/LegendreReference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing::legendre;

namespace
{
struct Bounce
{
    Raster<osg::Vec4f> light, shading;
};

Raster<osg::Vec4f> coloursOf(const std::vector<float>& values, const DemTile& tile)
{
    Raster<osg::Vec4f> colours(tile.width(), tile.height());
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours.values()[i] =
            osg::Vec4f(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]);
    return colours;
}

/// `bounces` bounces of ground that sends out `sent` at first; its albedo is `sent` too.
Bounce onGpu(osg::State& state, const DemTile& tile, const Colours& sent,
             const BounceScheme& scheme, int azimuths, AzimuthBlend blend = AzimuthBlend::Linear,
             int bounces = 1, int stride = 1)
{
    const osg::ref_ptr<TileInputs> inputs = new TileInputs;
    inputs->albedo = std::make_shared<const Raster<Rgb>>(sent);
    inputs->settings.bounces = bounces;
    inputs->settings.azimuths = azimuths;
    const osg::ref_ptr<TileSurface> surface = new TileSurface(tile, 1);
    const osg::ref_ptr<PyramidNode> pyramid = new PyramidNode(*surface);
    const osg::ref_ptr<LegendreGather> gather =
        new LegendreGather(*pyramid, {scheme, azimuths, blend, stride});
    const TextureLayout perPost = surface->perPost(GL_RGBA16F_ARB);
    const osg::ref_ptr<Resource> direct = new Resource("direct", perPost);
    direct->set(createColourTexture(Colours(tile.width(), tile.height(), {1.0f, 1.0f, 1.0f})));
    const osg::ref_ptr<Resource> shading = new Resource("shading", perPost);
    WorkGraph::Nodes nodes = {pyramid};
    std::vector<osg::ref_ptr<Resource>> lights;
    osg::ref_ptr<Resource> sends = direct;
    for (int bounce = 0; bounce < bounces; ++bounce)
    {
        const osg::ref_ptr<LegendreSentNode> node =
            new LegendreSentNode(*inputs, *surface, stride, sends, bounce > 0, false);
        nodes.emplace_back(node);
        lights.emplace_back(new Resource("bounce", perPost));
        sends =
            bounce + 1 < bounces ? new Resource("blocks", blockLayout(*surface, stride)) : nullptr;
        nodes.emplace_back(new LegendreBounceNode(*pyramid, gather, node, lights.back(), sends));
    }
    nodes.emplace_back(new ComposeNode(*surface, direct, lights, shading, true));
    WorkGraph graph;
    Status done = graph.declare(nodes);
    if (done)
        done = graph.run(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    EXPECT_EQ(takeGlErrors(), "");
    return {coloursOf(readFloats(state, *lights.back()->texture(), 4), tile),
            coloursOf(readFloats(state, *shading->texture(), 4), tile)};
}

/// The scheme: irradiance / π at a post.
class Scheme
{
public:
    Scheme(const BounceScheme& scheme, int azimuths, AzimuthBlend blend, int reach)
        : _scheme(scheme), _azimuths(azimuths)
    {
        const double spacing = 2.0 * pi / azimuths;
        for (int m = 0; m < 3; ++m)
        {
            // The Fourier transform of a B-spline is a power of sinc.
            const double x = 0.5 * m * spacing;
            _joins[static_cast<std::size_t>(m)] =
                spacing *
                std::pow(m == 0 ? 1.0 : std::sin(x) / x, blend == AzimuthBlend::Linear ? 2 : 4);
        }
        for (int l = 0; l < 3; ++l)
            for (int m = 0; m <= l; ++m)
                for (unsigned c = 0; c < 4; ++c)
                    _overlaps[static_cast<std::size_t>(l)][static_cast<std::size_t>(m)][c] =
                        overlap(l, m, c);
        for (int i = 0; std::exp2(i / scheme.samplesPerOctave) <= reach; ++i)
            _distances.push_back(std::exp2(i / scheme.samplesPerOctave));
    }

    double at(const Scene& scene, int x, int y) const
    {
        const Vec3 normal = scene.normal(x, y);
        double sum = 0.0;
        for (int k = 0; k < _azimuths; ++k)
        {
            const double azimuth = 2.0 * pi * k / _azimuths;
            Slice taken = {};
            for (std::size_t m = 0; m < 3; ++m)
            {
                const auto kernel = kernelOf(static_cast<int>(m), normal, azimuth);
                for (std::size_t l = m; l < 3; ++l)
                    for (std::size_t c = 0; c < 4; ++c)
                        taken[c] += _joins[m] * kernel[l] * _overlaps[l][m][c];
            }
            sum += scene.received(x, y, azimuth, normal, _distances, _scheme.offset,
                                  [&](double sine)
                                  {
                                      double light = 0.0;
                                      for (unsigned c = 0; c < 4; ++c)
                                          light += taken[c] * polynomialIntegral(c, sine);
                                      return light;
                                  });
        }
        return sum / pi;
    }

private:
    BounceScheme _scheme;
    int _azimuths;
    std::array<double, 3> _joins = {};
    std::array<std::array<Slice, 3>, 3> _overlaps = {};
    std::vector<double> _distances;
};

/// What the ground truth keeps of light: all of it; spherical harmonics of order 4; those of slices
/// in four Legendre polynomials.
enum class Kept
{
    All,
    Harmonics,
    Polynomials
};

constexpr int truthAzimuths = 256;

/// Irradiance / π by a march of 4 steps per post along 256 azimuths, its casting set exact.
double truth(const Scene& scene, int x, int y, Kept kept)
{
    static const std::vector<double> distances = []
    {
        std::vector<double> all;
        for (int i = 1; i <= 4 * 1024; ++i)
            all.push_back(0.25 * i);
        return all;
    }();
    static const auto overlaps = []
    {
        std::array<std::array<Slice, 3>, 3> all = {};
        for (int l = 0; l < 3; ++l)
            for (int m = 0; m <= l; ++m)
                for (unsigned c = 0; c < 4; ++c)
                    all[static_cast<std::size_t>(l)][static_cast<std::size_t>(m)][c] =
                        overlap(l, m, c);
        return all;
    }();
    const Vec3 normal = scene.normal(x, y);
    double sum = 0.0;
    for (int k = 0; k < truthAzimuths; ++k)
    {
        const double azimuth = 2.0 * pi * k / truthAzimuths;
        const auto zonal = kernelOf(0, normal, azimuth);
        const auto first = kernelOf(1, normal, azimuth);
        const auto second = kernelOf(2, normal, azimuth);
        const double facing = normal[0] * std::cos(azimuth) + normal[1] * std::sin(azimuth);
        Slice taken = {};
        for (std::size_t m = 0; m < 3; ++m)
            for (std::size_t l = m; l < 3; ++l)
                for (std::size_t c = 0; c < 4; ++c)
                    taken[c] += (m == 0 ? zonal : m == 1 ? first : second)[l] * overlaps[l][m][c];
        Receiver receiver = [&](double z)
        {
            double light = 0.0;
            for (unsigned c = 0; c < 4; ++c)
                light += taken[c] * polynomialIntegral(c, z);
            return light;
        };
        if (kept == Kept::Harmonics)
            // Integrals of the harmonics' parts in z.
            receiver = [&](double z)
            {
                const double c = std::sqrt(1.0 - z * z);
                return std::sqrt(0.25 / pi) * zonal[0] * z +
                       std::sqrt(0.75 / pi) *
                           (zonal[1] * 0.5 * z * z + first[1] * 0.5 * (z * c + std::asin(z))) +
                       std::sqrt(5.0 / pi) * 0.25 * zonal[2] * (z * z * z - z) -
                       std::sqrt(3.75 / pi) * first[2] * c * c * c / 3.0 +
                       std::sqrt(15.0 / pi) * 0.25 * second[2] * (z - z * z * z / 3.0);
            };
        if (kept == Kept::All)
            receiver = [&](double z)
            {
                const double c = std::sqrt(1.0 - z * z);
                return 0.5 * (normal[2] * z * z + facing * (std::asin(z) + z * c));
            };
        sum += scene.received(x, y, azimuth, normal, distances, 100.0, receiver);
    }
    return sum * 2.0 / truthAzimuths;
}

/// What ground of albedo ½ sends out below a sky and a low sun.
Colours litGround(osg::State& state, const DemTile& tile)
{
    SkyLight sky;
    sky.sunEnabled = true;
    sky.sunElevation = 35.0;
    sky.sunAzimuth = 200.0;
    sky.sunIrradiance = {2.0f, 2.0f, 2.0f};
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, LightingSettings(), sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    const Raster<osg::Vec4f> shading = lighting->readShading(state);
    Colours sent(tile.width(), tile.height());
    for (std::size_t i = 0; i < sent.size(); ++i)
        for (unsigned c = 0; c < 3; ++c)
            sent.values()[i][c] = 0.5f * shading.values()[i][c];
    return sent;
}

/// Every fourth post.
std::vector<double> truths(const Scene& scene, Kept kept)
{
    std::vector<double> all;
    for (int y = 2; y < scene.height(); y += 4)
        for (int x = 2; x < scene.width(); x += 4)
            all.push_back(truth(scene, x, y, kept));
    return all;
}

double difference(const Raster<osg::Vec4f>& light, const std::vector<double>& expected)
{
    Relative error;
    std::size_t i = 0;
    for (int y = 2; y < light.height(); y += 4)
        for (int x = 2; x < light.width(); x += 4)
            error.add(static_cast<double>(light.at(x, y).x()), expected[i++]);
    return error.rms();
}
} // namespace

TEST(LegendreBounce, IsTheSchemeInDouble)
{
    OTL_NEED_GL(context);
    const auto size = [](int width, int height)
    {
        DemTile tile(width, height, 30.0);
        const DemTile ground =
            generateTerrain(TerrainKind::Fractal, width, height, 30.0, 3).value();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                tile.setHeight(x, y, ground.heightAt(x, y));
        return tile;
    };
    DemTile oblong = size(47, 30);
    oblong.eastSpacings = {22.0};
    DemTile holed = size(33, 40);
    for (int y = 10; y < 20; ++y)
        for (int x = 0; x < y; ++x)
            holed.setVoid(x, y);
    holed.setVoid(0, 0);
    DemTile geographic = size(20, 21);
    geographic.eastSpacings.clear();
    for (int y = 0; y < 21; ++y)
        geographic.eastSpacings.push_back(30.0 - 0.3 * y);
    struct Case
    {
        const char* name;
        DemTile tile;
        BounceScheme scheme;
        int azimuths;
        AzimuthBlend blend;
    };
    const std::vector<Case> cases = {
        {"oblong", oblong, {4.0, 2.0}, 32, AzimuthBlend::Linear},
        {"holed", holed, {4.0, 1.0}, 16, AzimuthBlend::BSpline},
        {"holed, no offset", holed, {6.0, 0.0}, 12, AzimuthBlend::Linear},
        {"geographic", geographic, {8.0, 3.0}, 16, AzimuthBlend::BSpline},
        {"one row", size(30, 1), {4.0, 2.0}, 8, AzimuthBlend::Linear},
        {"one column", size(1, 17), {1.0, 0.0}, 8, AzimuthBlend::Linear},
        {"one post", size(1, 1), {4.0, 2.0}, 8, AzimuthBlend::Linear},
    };
    for (const Case& c : cases)
    {
        SCOPED_TRACE(c.name);
        // Powers of two: halves of all channels are exact, and channels can be told apart.
        Colours sent(c.tile.width(), c.tile.height());
        for (int y = 0; y < sent.height(); ++y)
            for (int x = 0; x < sent.width(); ++x)
            {
                const float value = 0.25f + 0.5f * static_cast<float>((x * 7 + y * 3) % 16) / 16.0f;
                sent.at(x, y) = {value, 0.5f * value, 0.25f * value};
            }
        const Bounce found = onGpu(context->state(), c.tile, sent, c.scheme, c.azimuths, c.blend);
        const Scene scene(c.tile, sent);
        const Scheme scheme(c.scheme, c.azimuths, c.blend,
                            std::max(c.tile.width(), c.tile.height()) - 1);
        double worst = 0.0;
        for (int y = 0; y < sent.height(); ++y)
            for (int x = 0; x < sent.width(); ++x)
            {
                const osg::Vec4f light = found.light.at(x, y);
                const osg::Vec4f shading = found.shading.at(x, y);
                if (!c.tile.isValid(x, y))
                {
                    EXPECT_EQ(light, osg::Vec4f()) << x << ", " << y;
                    continue;
                }
                const double expected = scheme.at(scene, x, y);
                worst = std::max(worst, std::abs(static_cast<double>(light.x()) - expected));
                EXPECT_NEAR(light.y(), 0.5 * static_cast<double>(light.x()), 2e-4);
                EXPECT_NEAR(light.z(), 0.25 * static_cast<double>(light.x()), 2e-4);
                EXPECT_EQ(light.w(), 1.0f);
                EXPECT_NEAR(shading.x(), 1.0 + static_cast<double>(light.x()), 1e-3);
            }
        // Radiance up to 0.75 in half floats per level, filter weights of 8 bits: 2^-9 of it each.
        EXPECT_LT(worst, 1.5e-3);
        std::printf("%-18s worst difference %.1e\n", c.name, worst);
    }
}

TEST(LegendreBounce, EachBounceSendsOutTheLast)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 24, 25, 30.0, 5).value();
    const Colours albedo(24, 25, {0.5f, 0.25f, 1.0f});
    const BounceScheme scheme = {4.0, 2.0};
    const Bounce one = onGpu(context->state(), tile, albedo, scheme, 16);
    const Bounce two = onGpu(context->state(), tile, albedo, scheme, 16, AzimuthBlend::Linear, 2);
    Colours sent(24, 25);
    for (std::size_t i = 0; i < sent.size(); ++i)
        for (unsigned c = 0; c < 3; ++c)
            sent.values()[i][c] = albedo.values()[i][c] * one.light.values()[i][c];
    const Bounce second = onGpu(context->state(), tile, sent, scheme, 16);
    for (std::size_t i = 0; i < sent.size(); ++i)
        for (unsigned c = 0; c < 3; ++c)
        {
            EXPECT_NEAR(two.light.values()[i][c], second.light.values()[i][c], 1e-5);
            EXPECT_NEAR(two.shading.values()[i][c],
                        1.0f + one.light.values()[i][c] + two.light.values()[i][c], 1e-3);
        }
}

TEST(LegendreBounce, UniformValleyHasAClosedForm)
{
    OTL_NEED_GL(context);
    // From the bottom of a valley of slope S, all of which sends out 1, the elevation of azimuth φ
    // is that of z = sin ω, tan ω = tan S |cos φ|. Of ∫ z/4 + z²/4 + 5/32 (z³ − z) dφ, what bands
    // 0, 1 and 2 of the clamped cosine make of light from 0 to ω, the parts are 4S, 2π (1 − cos S)
    // and 4 (S − sin S cos S). All light is 1 − cos S: 22 % less at 20°.
    for (const double degrees : {5.0, 20.0, 45.0, 70.0})
        for (const AzimuthBlend blend : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        {
            const double angle = degrees * pi / 180.0;
            const DemTile tile = analytic::valley(65, 65, 10.0, 32, std::tan(angle));
            const Bounce found = onGpu(context->state(), tile, Colours(65, 65, {1.0f, 1.0f, 1.0f}),
                                       {4.0, 8.0}, 128, blend);
            const double expected = (angle + 0.5 * pi * (1.0 - std::cos(angle)) -
                                     0.625 * std::sin(angle) * std::cos(angle)) /
                                    pi;
            // |cos φ| has a kink of 2 tan S where the light is 0.094 z: 128 azimuths err by
            // 4 Δφ²/12 · 0.094 tan S / π.
            const double spacing = 2.0 * pi / 128.0;
            EXPECT_NEAR(found.light.at(32, 32).x(), expected,
                        4.0 * spacing * spacing / 12.0 * 0.094 * std::tan(angle) / pi +
                            expected / 1024.0)
                << degrees;
        }
}

TEST(LegendreBounce, LevelGroundReceivesNothing)
{
    OTL_NEED_GL(context);
    const DemTile tile = analytic::plane(33, 20, 10.0, 1234.5);
    const Bounce found =
        onGpu(context->state(), tile, Colours(33, 20, {1.0f, 1.0f, 1.0f}), {4.0, 2.0}, 32);
    // Weights that hardware rounds leave slopes of a few units in the last place of 1234.5.
    for (const osg::Vec4f& light : found.light.values())
        EXPECT_NEAR(light.x(), 0.0, 1e-6);
}

// The paper's Figure 10 in numbers.
TEST(LegendreBounce, ConvergesToTheGroundTruthInHarmonics)
{
    OTL_NEED_GL(context);
    const DemTile tile = smoothMountains(96, 6);
    const Colours sent = litGround(context->state(), tile);
    const Scene scene(tile, sent);
    const std::vector<double> all = truths(scene, Kept::All);
    const std::vector<double> harmonics = truths(scene, Kept::Harmonics);
    const std::vector<double> polynomials = truths(scene, Kept::Polynomials);
    Relative ofHarmonics;
    Relative ofPolynomials;
    for (std::size_t i = 0; i < all.size(); ++i)
    {
        ofHarmonics.add(harmonics[i], all[i]);
        ofPolynomials.add(polynomials[i], harmonics[i]);
    }
    std::printf(
        "Indirect light, relative root mean square [%%]. What order 4 itself loses: harmonics\n"
        "%.2f of all light, four polynomials per slice %.2f of the harmonics.\n"
        "   m   k  o  join       to the harmonics   to the polynomials   to all light\n",
        100.0 * ofHarmonics.rms(), 100.0 * ofPolynomials.rms());
    EXPECT_LE(ofPolynomials.rms(), 0.01);
    const auto error = [&](int m, double k, double o, AzimuthBlend blend = AzimuthBlend::Linear)
    {
        const Bounce found = onGpu(context->state(), tile, sent, {k, o}, m, blend);
        const double rms = difference(found.light, harmonics);
        std::printf("%4d %3.0f %2.0f  %-9s %17.2f %20.2f %14.2f\n", m, k, o,
                    blend == AzimuthBlend::Linear ? "linear" : "b-spline", 100.0 * rms,
                    100.0 * difference(found.light, polynomials),
                    100.0 * difference(found.light, all));
        return rms;
    };
    const auto falls = [](const std::vector<double>& errors)
    { return std::is_sorted(errors.rbegin(), errors.rend()); };
    for (const auto& [k, o] : {std::array<double, 2>{4.0, 2.0}, {16.0, 6.0}})
        for (const AzimuthBlend blend : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        {
            std::vector<double> errors;
            for (const int m : {8, 16, 32, 64})
                errors.push_back(error(m, k, o, blend));
            EXPECT_TRUE(falls(errors)) << "m, k " << k << ", o " << o;
        }
    std::vector<double> errors;
    for (const double k : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0})
        errors.push_back(error(64, k, 6.0));
    EXPECT_TRUE(falls(errors)) << "k";
    EXPECT_LE(errors.back(), 0.01);
    errors.clear();
    for (const double o : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0})
        errors.push_back(error(64, 8.0, o));
    EXPECT_TRUE(falls(errors)) << "o";
}

TEST(LegendreBounce, IsASettingOfTheLighting)
{
    OTL_NEED_GL(context);
    const DemTile tile = generateTerrain(TerrainKind::Fractal, 40, 33, 30.0, 2).value();
    LightingSettings settings;
    settings.bounces = 1;
    settings.azimuths = 16;
    const osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, SkyLight());
    std::vector<std::vector<osg::Vec4f>> lights;
    for (const BounceMethod method : {BounceMethod::Slices, BounceMethod::Legendre,
                                      BounceMethod::LegendreBSpline, BounceMethod::Slices})
    {
        settings.bounceMethod = method;
        lighting->setSettings(settings);
        const Status done = lighting->update(context->state());
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_FALSE(lighting->isDirty(context->state().getContextID()));
        lights.push_back(lighting->readBounce(context->state(), 1).values());
    }
    EXPECT_EQ(lights[0], lights[3]);
    double sums[4] = {};
    for (std::size_t i = 0; i < 4; ++i)
        for (const osg::Vec4f& light : lights[i])
            sums[i] += static_cast<double>(light.x());
    // Order 4 gives grazing light too much, and what terrain sends is grazing.
    EXPECT_GT(sums[1], sums[0]);
    EXPECT_LT(sums[1], 1.5 * sums[0]);
    EXPECT_NE(lights[1], lights[2]);
    EXPECT_NEAR(sums[2], sums[1], 0.02 * sums[1]);

    // A sun alone: no horizon map is needed, nor made.
    SkyLight sun;
    sun.skyEnabled = false;
    sun.sunEnabled = true;
    sun.sunElevation = 30.0;
    settings.bounceMethod = BounceMethod::Legendre;
    const osg::ref_ptr<TileLight> sunny = new TileLight(tile, settings, sun);
    const Status done = sunny->update(context->state());
    ASSERT_TRUE(done.ok()) << done.error().message;
    for (const StageCost& cost : sunny->costs())
        EXPECT_TRUE(cost.name != "horizon" || cost.bytes == 0);
    EXPECT_EQ(takeGlErrors(), "");
}
