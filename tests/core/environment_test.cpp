// The sun that is found in a panorama.
#include <osgTerrainLight/Environment.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;
using Vector = std::array<double, 3>;

struct Picture
{
    int columns, rows;
    std::vector<Rgb> radiance;

    double solidAngle(int row) const
    {
        return 2.0 * pi / columns * (std::cos(pi * row / rows) - std::cos(pi * (row + 1) / rows));
    }
    /// Of a place in texels.
    Vector direction(double column, double row) const
    {
        const double elevation = pi * row / rows - 0.5 * pi;
        const double azimuth = 2.0 * pi * column / columns;
        return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                std::sin(elevation)};
    }
};

double angle(const Vector& a, const Vector& b)
{
    const Vector c = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                      a[0] * b[1] - a[1] * b[0]};
    return std::atan2(std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]),
                      a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

/// Mean of 8 x 8 points in each texel, by solid angle.
Picture pictureOf(int columns, int rows, const std::function<Rgb(const Vector&)>& radiance)
{
    Picture picture{columns, rows, {}};
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
        {
            std::array<double, 3> sum = {};
            double weights = 0.0;
            for (int i = 0; i < 64; ++i)
            {
                const Vector d =
                    picture.direction(column + (i % 8 + 0.5) / 8.0, row + (i / 8 + 0.5) / 8.0);
                const double weight = std::hypot(d[0], d[1]);
                const Rgb sample = radiance(d);
                weights += weight;
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += weight * static_cast<double>(sample[c]);
            }
            for (double& channel : sum)
                channel /= weights;
            picture.radiance.push_back({static_cast<float>(sum[0]), static_cast<float>(sum[1]),
                                        static_cast<float>(sum[2])});
        }
    return picture;
}

std::shared_ptr<const Environment> environmentOf(const Picture& picture)
{
    std::string problem;
    const auto made = createEnvironment(picture.columns, picture.rows, picture.radiance, problem);
    EXPECT_NE(made, nullptr) << problem;
    return made;
}

Vector towards(double azimuth, double elevation)
{
    return {std::sin(azimuth * degree) * std::cos(elevation * degree),
            std::cos(azimuth * degree) * std::cos(elevation * degree),
            std::sin(elevation * degree)};
}

/// Flux of the sphere per channel; of the sun what its disc sends: irradiance = L π sin² r, flux =
/// L 2π (1 − cos r).
std::array<double, 3> fluxOf(const Picture& picture, const std::vector<Rgb>& radiance)
{
    std::array<double, 3> sum = {};
    for (int row = 0; row < picture.rows; ++row)
        for (int column = 0; column < picture.columns; ++column)
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] +=
                    picture.solidAngle(row) *
                    static_cast<double>(
                        radiance[static_cast<std::size_t>(row * picture.columns + column)][c]);
    return sum;
}

void expectSameFlux(const Picture& picture, const Environment& environment)
{
    const std::array<double, 3> before = fluxOf(picture, picture.radiance);
    const std::array<double, 3> after = fluxOf(picture, environment.radiance);
    for (std::size_t c = 0; c < 3; ++c)
    {
        const double radius = environment.sunAngularRadius * degree;
        const double sun = static_cast<double>(environment.sunIrradiance[c]) * 2.0 *
                           (1.0 - std::cos(radius)) / (std::sin(radius) * std::sin(radius));
        EXPECT_NEAR(after[c] + sun, before[c], 1e-4 * before[c]) << c;
    }
}

/// A sky that is brighter at the horizon, darker ground.
Rgb sky(const Vector& d)
{
    const float up = static_cast<float>(d[2]);
    return up < 0.0f ? Rgb{0.2f, 0.15f, 0.1f}
                     : Rgb{1.0f - 0.5f * up, 1.0f - 0.3f * up, 1.2f - 0.2f * up};
}

struct Sun
{
    double azimuth, elevation, radius;
    int rows;
};
} // namespace

class SunOfPanorama : public testing::TestWithParam<Sun>
{
};

// Expected: the disc that was drawn. Place: well within a texel, as 64 points per texel have it.
// Radius: at most two texels across and two down have a share of a disc that is smaller than a
// texel, a second moment of (1/4 + 1/12) texel² per axis; the disc of that moment is √(4/3) wide.
TEST_P(SunOfPanorama, IsFoundWhereItWasDrawn)
{
    const Sun& sun = GetParam();
    const double texel = 180.0 / sun.rows;
    const Vector centre = towards(sun.azimuth, sun.elevation);
    const Rgb radiance = {3000.0f, 2500.0f, 1800.0f};
    const Picture picture =
        pictureOf(2 * sun.rows, sun.rows,
                  [&](const Vector& d)
                  { return angle(d, centre) < sun.radius * degree ? radiance : sky(d); });
    const auto found = environmentOf(picture);
    ASSERT_TRUE(found->hasSun);
    const double away = angle(centre, towards(found->sunAzimuth, found->sunElevation)) / degree;
    std::cout << "found " << away / texel << " texels away, radius " << found->sunAngularRadius
              << " for " << sun.radius << '\n';
    EXPECT_LT(away, 0.5 * texel);
    EXPECT_GT(found->sunAngularRadius, 0.95 * sun.radius);
    EXPECT_LT(found->sunAngularRadius,
              1.05 * std::sqrt(sun.radius * sun.radius + 4.0 / 3.0 * texel * texel));
    const double sine = std::sin(sun.radius * degree);
    for (std::size_t c = 0; c < 3; ++c)
    {
        const double irradiance = static_cast<double>(radiance[c]) * pi * sine * sine;
        // Points of a texel that it is drawn with: 1/8 of a texel at its rim.
        EXPECT_NEAR(static_cast<double>(found->sunIrradiance[c]), irradiance,
                    irradiance * (0.02 + 0.1 * texel / sun.radius));
    }
    expectSameFlux(picture, *found);
    // The picture is left as bright as its surroundings, and elsewhere as it was.
    for (int row = 0; row < picture.rows; ++row)
        for (int column = 0; column < picture.columns; ++column)
        {
            const std::size_t i = static_cast<std::size_t>(row * picture.columns + column);
            ASSERT_LT(found->radiance[i][1], 1.3f);
            if (angle(picture.direction(column + 0.5, row + 0.5), centre) > 12.0 * degree)
            {
                ASSERT_EQ(found->radiance[i], picture.radiance[i]);
            }
        }
}

INSTANTIATE_TEST_SUITE_P(
    Suns, SunOfPanorama,
    testing::Values(Sun{315.0, 35.0, 0.2666, 256}, Sun{90.0, 20.0, 0.5, 256}, // across the seam
                    Sun{90.2, 3.0, 0.5, 256}, Sun{10.0, 89.9, 0.5, 256},      // about the zenith
                    Sun{200.0, 88.0, 1.0, 180}, Sun{180.0, 1.0, 0.6, 256},    // low
                    Sun{45.0, 50.0, 2.0, 256}, Sun{123.0, 45.0, 0.2666, 64},  // a texel
                    Sun{270.0, 60.0, 0.2666, 32}),
    [](const auto& each) { return "Sun" + std::to_string(each.index); });

// One texel of each kind of place: its own direction, to the bit of double, and its own irradiance.
TEST(PanoramaSun, OneTexel)
{
    for (const auto& [column, row] : {std::pair{0, 40}, {63, 40}, {127, 33}, {20, 63}, {90, 52}})
    {
        Picture picture = pictureOf(128, 64, sky);
        const std::size_t i = static_cast<std::size_t>(row * picture.columns + column);
        picture.radiance[i] = {3e5f, 2e5f, 1e5f};
        const auto found = environmentOf(picture);
        ASSERT_TRUE(found->hasSun) << column << ' ' << row;
        EXPECT_LT(angle(picture.direction(column + 0.5, row + 0.5),
                        towards(found->sunAzimuth, found->sunElevation)),
                  0.02 * pi / picture.rows);
        EXPECT_NEAR(static_cast<double>(found->sunIrradiance[0]), 3e5 * picture.solidAngle(row),
                    3e5 * picture.solidAngle(row) * 1e-3);
        expectSameFlux(picture, *found);
    }
}

// A source's own colour: blue light of a sky exceeds that of a red sun, which takes none of it.
TEST(PanoramaSun, RedInABlueSky)
{
    const Vector centre = towards(200.0, 10.0);
    const Picture picture = pictureOf(512, 256,
                                      [&](const Vector& d) {
                                          return angle(d, centre) < 0.5 * degree
                                                     ? Rgb{5000.0f, 20.0f, 0.0f}
                                                     : Rgb{0.1f, 0.2f, 1.0f};
                                      });
    const auto found = environmentOf(picture);
    ASSERT_TRUE(found->hasSun);
    EXPECT_EQ(found->sunIrradiance[2], 0.0f);
    EXPECT_GT(found->sunIrradiance[0], 100.0f * found->sunIrradiance[1]);
    expectSameFlux(picture, *found);
}

// Of two suns the one that sends more light, not the brighter one, and the other stays.
TEST(PanoramaSun, TheOneWithMoreLight)
{
    const Vector bright = towards(100.0, 40.0);
    const Vector wide = towards(250.0, 30.0);
    const Picture picture = pictureOf(512, 256,
                                      [&](const Vector& d)
                                      {
                                          const float radiance =
                                              angle(d, bright) < 0.4 * degree ? 4000.0f
                                              : angle(d, wide) < 1.5 * degree ? 1000.0f
                                                                              : 1.0f;
                                          return Rgb{radiance, radiance, radiance};
                                      });
    const auto found = environmentOf(picture);
    ASSERT_TRUE(found->hasSun);
    EXPECT_NEAR(found->sunAzimuth, 250.0, 0.1);
    EXPECT_EQ(*std::max_element(found->radiance.begin(), found->radiance.end()),
              *std::max_element(picture.radiance.begin(), picture.radiance.end()));
    expectSameFlux(picture, *found);
}

// Nothing compact, nothing bright enough, nothing above the horizontal; what is left is the bits.
TEST(PanoramaSun, NoneWhereThereIsNone)
{
    const auto spot = [](double azimuth, double elevation, double radius, float radiance)
    {
        return [=](const Vector& d)
        {
            return angle(d, towards(azimuth, elevation)) < radius * degree
                       ? Rgb{radiance, radiance, radiance}
                       : sky(d);
        };
    };
    const auto window = [](const Vector& d) {
        return d[1] > 0.9 && d[2] > 0.1 && d[2] < 0.4 ? Rgb{50.0f, 50.0f, 50.0f} : sky(d);
    };
    const std::vector<Picture> pictures = {
        pictureOf(256, 128,
                  [](const Vector&) {
                      return Rgb{1.0f, 1.0f, 1.0f};
                  }),
        pictureOf(256, 128, [](const Vector&) { return Rgb{}; }),
        pictureOf(256, 128, sky),
        pictureOf(256, 128, window),                          // a window
        pictureOf(256, 128, spot(30.0, 40.0, 15.0, 100.0f)),  // a bright cloud
        pictureOf(256, 128, spot(30.0, -20.0, 1.0, 9000.0f)), // a mirror in the ground
        pictureOf(256, 128, spot(30.0, 20.0, 1.0, 15.0f)),    // too little light
        pictureOf(8, 4, spot(30.0, 20.0, 30.0, 1e6f)),        // texels wider than any sun
        {1, 1, {Rgb{1.0f, 2.0f, 3.0f}}}};
    for (const Picture& picture : pictures)
    {
        const auto found = environmentOf(picture);
        EXPECT_FALSE(found->hasSun) << &picture - pictures.data();
        EXPECT_EQ(found->radiance, picture.radiance);
    }
}

// Noise about a sun, and single texels that are brighter: more of these than are looked at would
// hide it, so the brightest sixteen are all that can.
TEST(PanoramaSun, AmongFireflies)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const Vector centre = towards(140.0, 25.0);
    Picture picture = pictureOf(512, 256,
                                [&](const Vector& d)
                                {
                                    const float noise = 2.0f * unit(random);
                                    return angle(d, centre) < 0.5 * degree
                                               ? Rgb{4000.0f, 4000.0f, 4000.0f}
                                               : Rgb{noise, noise, noise};
                                });
    for (int i = 0; i < 12; ++i)
        picture.radiance[150u * 512u + 40u * static_cast<unsigned>(i)] = {5e3f, 5e3f, 5e3f};
    const auto found = environmentOf(picture);
    ASSERT_TRUE(found->hasSun);
    EXPECT_NEAR(found->sunAzimuth, 140.0, 0.05);
    EXPECT_NEAR(found->sunElevation, 25.0, 0.05);
    expectSameFlux(picture, *found);
}

// 2√π L and zeros: the projection of what is left of a constant environment.
TEST(EnvironmentHarmonics, OfAConstant)
{
    const auto made = environmentOf(pictureOf(64, 32,
                                              [](const Vector&) {
                                                  return Rgb{1.0f, 2.0f, 4.0f};
                                              }));
    EXPECT_NEAR(made->harmonics[0][2], 8.0 * std::sqrt(pi), 1e-5);
    for (std::size_t i = 1; i < made->harmonics.size(); ++i)
        for (const float value : made->harmonics[i])
            EXPECT_NEAR(value, 0.0f, 1e-5f) << i;
}

TEST(EnvironmentValues, AreChecked)
{
    const auto complaint = [](int columns, int rows, std::vector<Rgb> radiance)
    {
        std::string problem;
        EXPECT_EQ(createEnvironment(columns, rows, std::move(radiance), problem), nullptr);
        return problem;
    };
    EXPECT_NE(complaint(0, 1, {}).find("0 x 1"), std::string::npos);
    EXPECT_NE(complaint(20000, 1, {}).find("16384 x 8192"), std::string::npos);
    EXPECT_NE(complaint(2, 1, {Rgb{}}).find("1 values"), std::string::npos);
    for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(), 2e30f})
        EXPECT_NE(complaint(1, 1, {Rgb{1.0f, bad, 1.0f}}).find("needs 0 to 1e30"),
                  std::string::npos);
}
