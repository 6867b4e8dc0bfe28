// Environments in spherical harmonics and irradiance maps, on the GPU: against closed forms,
// against projection in double with basis functions of the standard library, and against irradiance
// by quadrature, order-limited and not.
#include "gpu/EnvironmentTexture.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/nodes/EnvironmentHarmonicsPass.h"
#include "support/CubeMap.h"
#include "support/GlContext.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

using Colour = std::array<double, 3>;
using Vector = std::array<double, 3>;
using Harmonics = std::vector<Colour>;

/// Basis functions of order 6 from std::assoc_legendre.
std::array<double, 36> basis(const Vector& d)
{
    std::array<double, 36> y = {};
    const double azimuth = std::atan2(d[1], d[0]);
    for (int l = 0; l < 6; ++l)
        for (int m = 0; m <= l; ++m)
        {
            const double part =
                std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) * std::tgamma(l - m + 1) /
                          std::tgamma(l + m + 1)) *
                std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m),
                                    std::clamp(d[2], -1.0, 1.0));
            y[static_cast<std::size_t>(l * (l + 1) - m)] = part * std::sin(m * azimuth);
            y[static_cast<std::size_t>(l * (l + 1) + m)] = part * std::cos(m * azimuth);
        }
    return y;
}

Vector normalised(const Vector& v)
{
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

double dot(const Vector& a, const Vector& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A direction with its solid angle and radiance.
struct Sample
{
    Vector d;
    double solidAngle;
    Colour radiance;
};
using Samples = std::vector<Sample>;

struct Picture
{
    int columns, rows;
    std::vector<Rgb> radiance;
};

/// Each texel as cuts × cuts samples with the solid angles of their bands.
Samples samplesOf(const Picture& picture, int cuts, double heading = 0.0)
{
    Samples samples;
    const int columns = picture.columns * cuts, rows = picture.rows * cuts;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
        {
            const double bottom = pi * row / rows - pi / 2.0;
            const double top = pi * (row + 1) / rows - pi / 2.0;
            const double azimuth = 2.0 * pi * (column + 0.5) / columns - heading * pi / 180.0;
            const double elevation = 0.5 * (bottom + top);
            const Rgb& c = picture.radiance[static_cast<std::size_t>(
                (row / cuts) * picture.columns + column / cuts)];
            samples.push_back({{std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation)},
                               2.0 * pi / columns * (std::sin(top) - std::sin(bottom)),
                               {double(c[0]), double(c[1]), double(c[2])}});
        }
    return samples;
}

/// Solid angle from the middle of a face to (u, v), in closed form.
double corner(double u, double v)
{
    return std::atan2(u * v, std::sqrt(u * u + v * v + 1.0));
}

Samples samplesOfCube(int size, const std::vector<Rgb>& radiance, int cuts)
{
    Samples samples;
    const int n = size * cuts;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
            {
                const double left = 2.0 * x / n - 1.0, right = 2.0 * (x + 1) / n - 1.0;
                const double low = 2.0 * y / n - 1.0, high = 2.0 * (y + 1) / n - 1.0;
                const Rgb& c =
                    radiance[static_cast<std::size_t>((face * size + y / cuts) * size + x / cuts)];
                samples.push_back({directionOnCube(face, 0.5 * (left + right), 0.5 * (low + high)),
                                   corner(right, high) - corner(left, high) - corner(right, low) +
                                       corner(left, low),
                                   {double(c[0]), double(c[1]), double(c[2])}});
            }
    return samples;
}

Harmonics projected(const Samples& samples)
{
    Harmonics sum(36, Colour{});
    for (const Sample& sample : samples)
    {
        const auto y = basis(sample.d);
        for (std::size_t i = 0; i < 36; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                sum[i][c] += y[i] * sample.solidAngle * sample.radiance[c];
    }
    return sum;
}

/// Sun-less landscape: a bright band, a blue sky, dark ground, noise, and a bright compact cloud.
Colour landscape(const Vector& d)
{
    const double up = d[2];
    const double cloud = std::exp(-40.0 * (1.0 - dot(d, normalised({0.5, -0.6, 0.5}))));
    const double stripes = 0.1 * std::sin(13.0 * d[0] + 7.0 * d[1] * d[2]);
    if (up < 0.0)
        return {0.22 + stripes, 0.17 + stripes, 0.12};
    return {0.5 - 0.3 * up + 6.0 * cloud + stripes, 0.6 - 0.2 * up + 5.5 * cloud + stripes,
            0.9 + 5.0 * cloud};
}

Picture landscapePicture(int columns, int rows)
{
    Picture picture{columns, rows, {}};
    for (const Sample& sample :
         samplesOf({columns, rows, std::vector<Rgb>(static_cast<std::size_t>(columns * rows))}, 1))
    {
        const Colour c = landscape(sample.d);
        picture.radiance.push_back({static_cast<float>(std::max(c[0], 0.0)),
                                    static_cast<float>(std::max(c[1], 0.0)),
                                    static_cast<float>(std::max(c[2], 0.0))});
    }
    return picture;
}

std::vector<Rgb> randomRadiance(std::size_t count)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::vector<Rgb> all(count);
    for (Rgb& c : all)
        for (float& value : c)
            value = std::pow(uniform(random), 8.0f) * 20.0f; // few bright ones
    return all;
}

osg::ref_ptr<osg::Texture2D> textureOf(const Picture& picture)
{
    const auto environment = std::make_shared<Environment>();
    environment->columns = picture.columns;
    environment->rows = picture.rows;
    environment->radiance = picture.radiance;
    return environmentTexture(environment);
}

osg::ref_ptr<osg::TextureCubeMap> cubeOf(int size, const std::vector<Rgb>& radiance)
{
    osg::ref_ptr<osg::TextureCubeMap> map = new osg::TextureCubeMap;
    for (unsigned face = 0; face < 6; ++face)
    {
        osg::ref_ptr<osg::Image> image = new osg::Image;
        image->allocateImage(size, size, 1, GL_RGB, GL_FLOAT, 1);
        image->setInternalTextureFormat(GL_RGB32F_ARB);
        std::memcpy(image->data(), &radiance[face * static_cast<std::size_t>(size * size)],
                    static_cast<std::size_t>(size * size) * sizeof(Rgb));
        map->setImage(face, image);
    }
    map->setInternalFormat(GL_RGB32F_ARB);
    map->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR);
    map->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
    for (const auto wrap : {osg::Texture::WRAP_S, osg::Texture::WRAP_T, osg::Texture::WRAP_R})
        map->setWrap(wrap, osg::Texture::CLAMP_TO_EDGE);
    map->setResizeNonPowerOfTwoHint(false);
    return map;
}

std::vector<float> bitsOf(osg::State& state, const EnvironmentHarmonicsPass& pass)
{
    return readFloats(state, *pass.harmonics()->texture(), 4);
}

Harmonics coefficients(const std::vector<float>& values)
{
    Harmonics all;
    for (std::size_t i = 0; i < values.size(); i += 4)
        all.push_back({double(values[i]), double(values[i + 1]), double(values[i + 2])});
    return all;
}

/// The greatest difference, over the root of the sum of squares: of the function's own size.
double relativeError(const Harmonics& found, const Harmonics& expected)
{
    double worst = 0.0;
    for (std::size_t c = 0; c < 3; ++c)
    {
        double square = 0.0, difference = 0.0;
        for (std::size_t i = 0; i < found.size(); ++i)
        {
            square += expected[i][c] * expected[i][c];
            difference = std::max(difference, std::abs(found[i][c] - expected[i][c]));
        }
        worst = std::max(worst, difference / std::sqrt(square));
    }
    return worst;
}

/// ∫ kernel(d · n) L(d) dω over all samples.
Colour convolved(const Samples& samples, const Vector& n,
                 const std::function<double(double)>& kernel)
{
    Colour sum = {};
    for (const Sample& sample : samples)
    {
        const double weight = kernel(dot(sample.d, n)) * sample.solidAngle;
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += weight * sample.radiance[c];
    }
    return sum;
}

/// A kernel cut to the bands below `order`, by Σ (2l + 1)/4π λ_l P_l.
std::function<double(double)> limited(const std::array<double, 6>& eigenvalues, int order)
{
    return [eigenvalues, order](double z)
    {
        double sum = 0.0;
        for (int l = 0; l < order; ++l)
            sum += (2 * l + 1) / (4.0 * pi) * eigenvalues[static_cast<std::size_t>(l)] *
                   std::legendre(static_cast<unsigned>(l), std::clamp(z, -1.0, 1.0));
        return sum;
    };
}

/// 2π ∫ kernel P_l dz.
std::array<double, 6> eigenvaluesOf(const std::function<double(double)>& kernel)
{
    std::array<double, 6> values = {};
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i)
    {
        const double z = -1.0 + (2 * i + 1.0) / count;
        for (unsigned l = 0; l < 6; ++l)
            values[l] += 2.0 * pi * kernel(z) * std::legendre(l, z) * 2.0 / count;
    }
    return values;
}
} // namespace

// Expected: closed form, 2√π L and 0. Bound: the issue's.
TEST(EnvironmentHarmonics, OfAConstant)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const double c00 = 2.0 * std::sqrt(pi);
    double worst = 0.0;
    const auto check = [&](const Harmonics& found, const std::string& where)
    {
        for (std::size_t i = 0; i < found.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
            {
                const double radiance = c == 0 ? 1.0 : c == 1 ? 0.5 : 3.0;
                const double error = std::abs(found[i][c] / radiance - (i == 0 ? c00 : 0.0));
                worst = std::max(worst, error);
                EXPECT_LT(error, 1e-5) << i << " of " << where;
            }
    };
    for (int order = 2; order <= 6; ++order)
    {
        const osg::ref_ptr<EnvironmentHarmonicsPass> pass = new EnvironmentHarmonicsPass(order);
        for (const auto& [columns, rows] :
             std::vector<std::pair<int, int>>{{1, 1}, {2, 1}, {7, 5}, {64, 32}, {130, 257}})
        {
            const Picture picture{
                columns, rows,
                std::vector<Rgb>(static_cast<std::size_t>(columns * rows), {1.0f, 0.5f, 3.0f})};
            ASSERT_TRUE(pass->dispatch(state, textureOf(picture), 33.0, 1.0).ok());
            check(coefficients(bitsOf(state, *pass)),
                  std::to_string(columns) + " x " + std::to_string(rows));
        }
        for (const int size : {4, 5, 16, 64})
        {
            const osg::ref_ptr<osg::TextureCubeMap> cube =
                cubeOf(size, std::vector<Rgb>(static_cast<std::size_t>(6 * size * size),
                                              {1.0f, 0.5f, 3.0f}));
            ASSERT_TRUE(pass->dispatch(state, cube).ok());
            check(coefficients(bitsOf(state, *pass)), "cube " + std::to_string(size));
        }
        EXPECT_EQ(takeGlErrors(), "");
        pass->releaseGLObjects(&state);
    }
    std::printf("constant: greatest error of a coefficient %.1e\n", worst);
}

// Many texels: a sum in float, in stages. Expected and bound as above.
TEST(EnvironmentHarmonics, OfALargeConstant)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const osg::ref_ptr<EnvironmentHarmonicsPass> pass = new EnvironmentHarmonicsPass(6);
    const Picture picture{2048, 1024, std::vector<Rgb>(2048u * 1024u, {1.0f, 0.1f, 0.7f})};
    ASSERT_TRUE(pass->dispatch(state, textureOf(picture)).ok());
    const Harmonics found = coefficients(bitsOf(state, *pass));
    for (std::size_t i = 0; i < 36; ++i)
        EXPECT_NEAR(found[i][0], i == 0 ? 2.0 * std::sqrt(pi) : 0.0, 1e-5) << i;
    pass->releaseGLObjects(&state);
}

// Expected: the same in double, texels cut finely. Bound: the 1e-4 of the function's size.
TEST(EnvironmentHarmonics, AgainstDouble)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    double worst = 0.0;
    const auto check = [&](const EnvironmentHarmonicsPass& pass, Harmonics expected, double gain,
                           const std::string& where)
    {
        expected.resize(static_cast<std::size_t>(pass.order() * pass.order()));
        for (Colour& c : expected)
            for (double& value : c)
                value *= gain;
        const double error = relativeError(coefficients(bitsOf(state, pass)), expected);
        worst = std::max(worst, error);
        EXPECT_LT(error, 1e-4) << where << ", order " << pass.order();
    };
    const std::vector<Picture> pictures = {
        landscapePicture(96, 48), {33, 20, randomRadiance(33 * 20)}, {3, 2, randomRadiance(6)}};
    const int size = 12;
    const std::vector<Rgb> faces = randomRadiance(6 * size * size);
    const osg::ref_ptr<osg::TextureCubeMap> cube = cubeOf(size, faces);
    const Harmonics ofCube = projected(samplesOfCube(size, faces, 12));
    for (const double heading : {0.0, -100.0})
        for (const Picture& picture : pictures)
        {
            // 2e-5 at a cut of 4 texels of 3.75 degrees.
            const Harmonics expected =
                projected(samplesOf(picture, 800 / picture.rows / 3, heading));
            for (const int order : {2, 3, 6})
            {
                const osg::ref_ptr<EnvironmentHarmonicsPass> pass =
                    new EnvironmentHarmonicsPass(order);
                ASSERT_TRUE(pass->dispatch(state, textureOf(picture), heading, 2.5).ok());
                check(*pass, expected, 2.5, std::to_string(picture.columns) + " columns");
                ASSERT_TRUE(pass->dispatch(state, cube, 0.25).ok());
                check(*pass, ofCube, 0.25, "cube");
                EXPECT_EQ(takeGlErrors(), "");
                pass->releaseGLObjects(&state);
            }
        }
    std::printf("against double: greatest error %.1e\n", worst);
}

// Expected: the same bits from run to run, and from one pass object to another.
TEST(EnvironmentHarmonics, TwiceIsTheSame)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const Picture picture{100, 70, randomRadiance(7000)};
    const osg::ref_ptr<osg::TextureCubeMap> cube = cubeOf(32, randomRadiance(6 * 32 * 32));
    std::vector<float> first[2];
    for (int run = 0; run < 3; ++run)
    {
        const osg::ref_ptr<EnvironmentHarmonicsPass> pass = new EnvironmentHarmonicsPass(6);
        ASSERT_TRUE(pass->dispatch(state, textureOf(picture), 10.0, 1.0).ok());
        const std::vector<float> ofPicture = bitsOf(state, *pass);
        ASSERT_TRUE(pass->dispatch(state, cube).ok());
        const std::vector<float> ofCube = bitsOf(state, *pass);
        if (run == 0)
        {
            first[0] = ofPicture;
            first[1] = ofCube;
        }
        EXPECT_EQ(ofPicture, first[0]);
        EXPECT_EQ(ofCube, first[1]);
        pass->releaseGLObjects(&state);
    }
}

TEST(EnvironmentHarmonics, ACubeMapWithoutSizeIsRefused)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<EnvironmentHarmonicsPass> pass = new EnvironmentHarmonicsPass(2);
    const Status done = pass->dispatch(context->state(), new osg::TextureCubeMap);
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(done.error().message,
              "cube map of an environment has faces of 0 x 0 texels: needs 4 ... 8192");
}

// Expected: quadrature in double of the environment with the kernel, cut to the order's bands (Funk
// and Hecke), and whole. Bounds: half floats, 2^-11, and the projection's 1e-4, of the greatest
// value; against the truth as measured on this environment and a quarter more.
TEST(IrradianceMap, AgainstQuadrature)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const Picture picture = landscapePicture(96, 48);
    const Samples samples = samplesOf(picture, 2);
    const auto lambert = [](double z) { return std::max(z, 0.0) / pi; };
    constexpr double exponent = 8.0;
    const auto phong = [](double z)
    { return z > 0.0 ? (exponent + 1.0) / (2.0 * pi) * std::pow(z, exponent) : 0.0; };
    struct Truth
    {
        int order;
        double diffuse, glossy;
    };
    for (const auto& [order, diffuseBound, glossyBound] : std::vector<Truth>{{2, 0.09, 0.6},
                                                                             {3, 0.0185, 0.41},
                                                                             {4, 0.0185, 0.23},
                                                                             {5, 0.0065, 0.112},
                                                                             {6, 0.0065, 0.045}})
    {
        const osg::ref_ptr<EnvironmentHarmonicsPass> project = new EnvironmentHarmonicsPass(order);
        const osg::ref_ptr<IrradianceMapPass> evaluate =
            new IrradianceMapPass(project->harmonics(), order);
        const osg::ref_ptr<osg::TextureCubeMap> map = IrradianceMapPass::createMap(8);
        ASSERT_TRUE(project->dispatch(state, textureOf(picture)).ok());
        for (const bool diffuse : {true, false})
        {
            IrradianceMapPass::Sun sun;
            sun.fraction = 0.25;
            const Status done = diffuse ? evaluate->dispatchDiffuse(state, map, sun)
                                        : evaluate->dispatchGlossy(state, map, exponent, sun);
            ASSERT_TRUE(done.ok()) << done.error().message;
            const std::vector<float> found = readCube(state, *map);
            const std::function<double(double)> kernel =
                diffuse ? std::function<double(double)>(lambert) : phong;
            const auto cut = limited(eigenvaluesOf(kernel), order);
            double greatest = 0.0, ofOrder = 0.0, ofTruth = 0.0, mean = 0.0;
            for (int texel = 0; texel < 6 * 64; texel += 3)
            {
                const Vector n = directionOnCube(texel / 64, (texel % 8 + 0.5) / 4.0 - 1.0,
                                                 (texel / 8 % 8 + 0.5) / 4.0 - 1.0);
                const Colour limitedLight = convolved(samples, n, cut);
                const Colour light = convolved(samples, n, kernel);
                for (std::size_t c = 0; c < 3; ++c)
                {
                    const double value = double(found[4 * static_cast<std::size_t>(texel) + c]);
                    greatest = std::max(greatest, light[c]);
                    ofOrder = std::max(ofOrder, std::abs(value - std::max(limitedLight[c], 0.0)));
                    ofTruth = std::max(ofTruth, std::abs(limitedLight[c] - light[c]));
                    mean += std::abs(limitedLight[c] - light[c]) / 384.0;
                }
                EXPECT_EQ(found[4 * static_cast<std::size_t>(texel) + 3], 0.25f);
            }
            std::printf("order %d, %s: %.1e of the order's, %.2f %% (mean %.2f %%) of the truth, "
                        "of the greatest value\n",
                        order, diffuse ? "diffuse" : "glossy", ofOrder / greatest,
                        100.0 * ofTruth / greatest, 100.0 * mean / greatest);
            EXPECT_LT(ofOrder / greatest, 1.0 / 2048.0 + 1e-4);
            EXPECT_LT(ofTruth / greatest, diffuse ? diffuseBound : glossyBound);
        }
        EXPECT_EQ(takeGlErrors(), "");
        project->releaseGLObjects(&state);
        evaluate->releaseGLObjects(&state);
    }
}
