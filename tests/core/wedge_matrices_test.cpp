#include "core/WedgeMatrices.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <vector>

// Expected values come from the standard library's Legendre functions, integrated over azimuth and
// zenith angle by Simpson's rule, and from closed forms. Double throughout: the rounding of sums of
// a few thousand terms below 1 stays under 1e-12.

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

using Slice = std::array<double, 4>;
using Sh = std::array<double, 16>;

/// Simpson's rule in 2·halves steps h: its error is at most (b − a)·h⁴/180 times the greatest
/// fourth derivative.
double integral(double a, double b, int halves, const std::function<double(double)>& f)
{
    const double h = (b - a) / (2.0 * halves);
    double sum = f(a) + f(b);
    for (int i = 1; i < 2 * halves; ++i)
        sum += (i % 2 == 1 ? 4.0 : 2.0) * f(a + h * i);
    return sum * h / 3.0;
}

/// Over zenith angles: products of N, P̂ and sin θ are trigonometric polynomials of degree 7 below
/// 1, so their fourth derivative is below 7⁴ (Bernstein): 2401·π/180·(π/256)⁴.
constexpr int zenithHalves = 128;
constexpr double zenithBound = 1e-6;

/// Over one wedge, in 32 steps, of a blend's basis function times cos or sin 3φ: with x = 3·spacing
/// and derivatives of the basis below 1, 1, 2 and 3 per spacing, the fourth derivative per spacing
/// is below x⁴ + 4x³ + 12x² + 12x. The integral over zenith angles is below 0.55.
constexpr int wedgeHalves = 16;
double wedgeBound(double spacing)
{
    const double x = 3.0 * spacing;
    return spacing * (zenithBound + 0.55 * x * (((x + 4.0) * x + 12.0) * x + 12.0) /
                                        (180.0 * std::pow(2.0 * wedgeHalves, 4.0)));
}

double legendreSum(const Slice& slice, double theta)
{
    double sum = 0.0;
    for (unsigned c = 0; c < 4; ++c)
        sum += slice[c] * std::sqrt(c + 0.5) * std::legendre(c, std::cos(theta));
    return sum;
}

double elevationPart(int l, int m, double theta)
{
    return std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) * std::tgamma(l - m + 1) /
                     std::tgamma(l + m + 1)) *
           std::assoc_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m), std::cos(theta));
}

double harmonic(int l, int m, double theta, double phi)
{
    return elevationPart(l, std::abs(m), theta) * (m < 0 ? std::sin(-m * phi) : std::cos(m * phi));
}

template <class Function>
void forEachHarmonic(const Function& function)
{
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
            function(static_cast<std::size_t>(l * (l + 1) + m), l, m);
}

/// ∫∫ sliceAt(φ)(θ) Y(θ, φ) sin θ dθ dφ over azimuths a … b: brute force, nothing taken apart.
Sh project(double a, double b, int halves, const std::function<Slice(double)>& sliceAt)
{
    Sh sh = {};
    forEachHarmonic(
        [&](std::size_t row, int l, int m)
        {
            sh[row] = integral(a, b, halves,
                               [&](double phi)
                               {
                                   const Slice slice = sliceAt(phi);
                                   return integral(0.0, pi, zenithHalves,
                                                   [&](double theta) {
                                                       return legendreSum(slice, theta) *
                                                              harmonic(l, m, theta, phi) *
                                                              std::sin(theta);
                                                   });
                               });
        });
    return sh;
}

/// Uniform cubic B-spline in its usual form: knots −2 … 2.
double bspline(double t)
{
    const double x = std::abs(t);
    if (x < 1.0)
        return (4.0 - 6.0 * x * x + 3.0 * x * x * x) / 6.0;
    return x < 2.0 ? (2.0 - x) * (2.0 - x) * (2.0 - x) / 6.0 : 0.0;
}

double hat(double t)
{
    return std::max(0.0, 1.0 - std::abs(t));
}

Slice blend(const std::vector<Slice>& slices, const std::vector<double>& weights)
{
    Slice sum = {};
    for (std::size_t j = 0; j < slices.size(); ++j)
        for (std::size_t c = 0; c < 4; ++c)
            sum[c] += weights[j] * slices[j][c];
    return sum;
}

/// Turned about z: coefficients of f(θ, φ − angle).
Sh turned(const Sh& sh, double angle)
{
    Sh result = {};
    forEachHarmonic(
        [&](std::size_t row, int l, int m)
        {
            const auto other = static_cast<std::size_t>(l * (l + 1) - m);
            const double sign = m < 0 ? 1.0 : -1.0;
            result[row] = m == 0 ? sh[row]
                                 : std::cos(std::abs(m) * angle) * sh[row] +
                                       sign * std::sin(std::abs(m) * angle) * sh[other];
        });
    return result;
}

template <std::size_t columns>
Sh apply(const ShMatrix<columns>& matrix, const std::vector<Slice>& slices)
{
    Sh sh = {};
    for (std::size_t row = 0; row < 16; ++row)
        for (std::size_t c = 0; c < columns; ++c)
            sh[row] += matrix[row][c] * slices.at(c / 4)[c % 4];
    return sh;
}

void add(Sh& sum, const Sh& sh)
{
    for (std::size_t i = 0; i < 16; ++i)
        sum[i] += sh[i];
}

void expectNear(const Sh& found, const Sh& expected, double bound)
{
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_NEAR(found[i], expected[i], bound) << i;
}

std::vector<Slice> randomSlices(int count, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<Slice> slices(static_cast<std::size_t>(count));
    for (Slice& slice : slices)
        for (double& coefficient : slice)
            coefficient = uniform(random);
    return slices;
}

/// Sums of all wedges of a full circle, each turned to its place: NS09, Eq. 20 and 21.
Sh sumOfWedges(const WedgeMatrices& wedges, AzimuthBlend kind, const std::vector<Slice>& slices)
{
    const std::size_t count = slices.size();
    const auto at = [&](std::size_t j) { return slices[j % count]; };
    Sh sum = {};
    for (std::size_t j = 0; j < count; ++j)
    {
        const Sh wedge =
            kind == AzimuthBlend::Linear
                ? apply(wedges.linear(), {at(j), at(j + 1)})
                : apply(wedges.bspline(), {at(j + count - 1), at(j), at(j + 1), at(j + 2)});
        add(sum, turned(wedge, static_cast<double>(j) * wedges.spacing()));
    }
    return sum;
}

Sh sumFolded(const WedgeMatrices& wedges, AzimuthBlend kind, const std::vector<Slice>& slices)
{
    Sh sum = {};
    for (std::size_t j = 0; j < slices.size(); ++j)
        add(sum, turned(apply(wedges.folded(kind), {slices[j]}),
                        static_cast<double>(j) * wedges.spacing()));
    return sum;
}
} // namespace

TEST(WedgeMatrices, WedgesAreTheIntegralsOfTheirDefinition)
{
    for (const double spacing : {2.0 * pi / 4.0, 2.0 * pi / 32.0, 0.05})
    {
        const WedgeMatrices wedges(spacing);
        EXPECT_EQ(wedges.spacing(), spacing);
        for (std::size_t c = 0; c < 16; ++c)
        {
            Slice unit = {};
            unit[c % 4] = 1.0;
            const double from = static_cast<double>(c / 4);
            const auto columnOf = [&](const std::function<double(double)>& weight)
            {
                return project(0.0, spacing, wedgeHalves,
                               [&](double phi) { return blend({unit}, {weight(phi / spacing)}); });
            };
            const double bound = wedgeBound(spacing);
            Sh found = {};
            for (std::size_t row = 0; row < 16; ++row)
                found[row] = wedges.bspline()[row][c];
            expectNear(found, columnOf([&](double a) { return bspline(a - (from - 1.0)); }), bound);
            if (c < 8)
            {
                for (std::size_t row = 0; row < 16; ++row)
                    found[row] = wedges.linear()[row][c];
                expectNear(found, columnOf([&](double a) { return hat(a - from); }), bound);
            }
        }
    }
}

TEST(WedgeMatrices, WeightsHaveTheirClosedForms)
{
    // Fourier transforms of box functions convolved with themselves: spacing·sinc² and ·sinc⁴; of
    // half a hat, (1 − cos x)/(m² spacing) and (1 − sin x / x)/m with x = m·spacing.
    for (const double spacing : {2.0 * pi / 3.0, 2.0 * pi / 4.0, 2.0 * pi / 32.0, 2.0 * pi / 256.0})
    {
        const WedgeMatrices wedges(spacing);
        const double bound = 4e-15; // rounding of sums of 32 terms, 2 at most
        const AzimuthWeights linear = wedges.weights(AzimuthBlend::Linear);
        const AzimuthWeights smooth = wedges.weights(AzimuthBlend::BSpline);
        const AzimuthWeights first = wedges.firstWeights();
        const AzimuthWeights last = wedges.lastWeights();
        for (std::size_t m = 0; m < 4; ++m)
        {
            const double x = static_cast<double>(m) * spacing;
            const double sinc = m == 0 ? 1.0 : std::sin(0.5 * x) / (0.5 * x);
            EXPECT_NEAR(linear.even[m], spacing * sinc * sinc, bound);
            EXPECT_NEAR(smooth.even[m], spacing * sinc * sinc * sinc * sinc, bound);
            EXPECT_EQ(linear.odd[m], 0.0);
            EXPECT_EQ(smooth.odd[m], 0.0);
            EXPECT_NEAR(first.even[m], 0.5 * linear.even[m], bound);
            EXPECT_NEAR(last.even[m], 0.5 * linear.even[m], bound);
            const double odd = m == 0 ? 0.0 : (1.0 - std::sin(x) / x) / static_cast<double>(m);
            EXPECT_NEAR(first.odd[m], odd, bound);
            EXPECT_NEAR(last.odd[m], -odd, bound);
        }
    }
}

TEST(WedgeMatrices, ElevationIntegralsHaveTheirClosedForms)
{
    const auto expect = [](int l, int m, const Slice& expected)
    {
        for (std::size_t c = 0; c < 4; ++c)
            EXPECT_NEAR(WedgeMatrices::elevationIntegrals(l, m)[c], expected[c], 1e-15)
                << l << ' ' << m << ' ' << c;
    };
    // Beta functions. m even: polynomials over √π; m odd: √(1 − z²) makes them times √π.
    for (std::size_t l = 0; l < 4; ++l)
    {
        Slice expected = {};
        expected[l] = 1.0 / std::sqrt(2.0 * pi);
        expect(static_cast<int>(l), 0, expected);
    }
    expect(1, 1, {std::sqrt(3.0 * pi / 32.0), 0.0, -std::sqrt(15.0 * pi / 2048.0), 0.0});
    expect(2, 1, {0.0, std::sqrt(45.0 * pi / 512.0), 0.0, -std::sqrt(105.0 * pi / 8192.0)});
    expect(2, 2, {std::sqrt(5.0 / (6.0 * pi)), 0.0, -std::sqrt(1.0 / (6.0 * pi)), 0.0});
    expect(3, 1, {std::sqrt(21.0 * pi / 4096.0), 0.0, std::sqrt(5145.0 * pi / 65536.0), 0.0});
    expect(3, 2, {0.0, std::sqrt(7.0 / (10.0 * pi)), 0.0, -std::sqrt(3.0 / (10.0 * pi))});
    expect(3, 3, {std::sqrt(315.0 * pi / 4096.0), 0.0, -std::sqrt(1575.0 * pi / 65536.0), 0.0});
}

TEST(WedgeMatrices, FourPolynomialsKeepEvenOrdersWhole)
{
    // How much of N_lm the four polynomials span: Σ_c of squares over ∫ N² = 1/π (1/2π for m = 0).
    // Whole for even m; for odd m N_lm is no polynomial, and (3, 1) keeps only 82.5 %: a limit of
    // the method, from the closed forms above.
    const auto kept = [](int l, int m)
    {
        double sum = 0.0;
        for (const double a : WedgeMatrices::elevationIntegrals(l, m))
            sum += a * a;
        return sum * (m == 0 ? 2.0 * pi : pi);
    };
    for (int l = 0; l < 4; ++l)
        for (int m = 0; m <= l; m += 2)
            EXPECT_NEAR(kept(l, m), 1.0, 1e-14);
    EXPECT_NEAR(kept(1, 1), (3.0 / 32.0 + 15.0 / 2048.0) * pi * pi, 1e-14);
    EXPECT_NEAR(kept(2, 1), (45.0 / 512.0 + 105.0 / 8192.0) * pi * pi, 1e-14);
    EXPECT_NEAR(kept(3, 1), (21.0 / 4096.0 + 5145.0 / 65536.0) * pi * pi, 1e-14);
    EXPECT_NEAR(kept(3, 1), 0.8254, 1e-4);
    EXPECT_NEAR(kept(3, 3), (315.0 / 4096.0 + 1575.0 / 65536.0) * pi * pi, 1e-14);
}

TEST(WedgeMatrices, FullCircleIsTheIntegralOfTheBlendedFunction)
{
    for (const int count : {3, 4, 8, 12})
    {
        const double spacing = 2.0 * pi / count;
        const WedgeMatrices wedges(spacing);
        const std::vector<Slice> slices = randomSlices(count, static_cast<unsigned>(count));
        for (const AzimuthBlend kind : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        {
            const auto sliceAt = [&](double phi)
            {
                std::vector<double> weights(slices.size());
                for (int j = 0; j < count; ++j)
                    for (int turn = -2; turn <= 2; ++turn)
                    {
                        const double t = phi / spacing - j - turn * count;
                        weights[static_cast<std::size_t>(j)] +=
                            kind == AzimuthBlend::Linear ? hat(t) : bspline(t);
                    }
                return blend(slices, weights);
            };
            Sh expected = {};
            // Wedge by wedge, so that Simpson meets no kink.
            for (int j = 0; j < count; ++j)
                add(expected, project(j * spacing, (j + 1) * spacing, wedgeHalves, sliceAt));
            // Four coefficients of up to four slices per wedge.
            const double bound = 16.0 * count * wedgeBound(spacing);
            expectNear(sumOfWedges(wedges, kind, slices), expected, bound);
            expectNear(sumFolded(wedges, kind, slices), expected, bound);
        }
    }
}

TEST(WedgeMatrices, FoldedIsUnfolded)
{
    for (const int count : {3, 4, 5, 8, 32, 256})
    {
        const WedgeMatrices wedges(2.0 * pi / count);
        const std::vector<Slice> slices = randomSlices(count, 11);
        for (const AzimuthBlend kind : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
            expectNear(sumFolded(wedges, kind, slices), sumOfWedges(wedges, kind, slices), 1e-13);
    }
}

TEST(WedgeMatrices, PartialRangeIsTheIntegralOfTheBlendedFunction)
{
    // Key lights: m azimuths, m − 1 wedges; the paper's own m is 3.
    for (const int count : {2, 3, 6})
    {
        const double spacing = 0.2, begin = 1.7;
        const WedgeMatrices wedges(spacing);
        const std::vector<Slice> slices = randomSlices(count, 5);
        Sh expected = {}, unfolded = {}, folded = {};
        for (int j = 0; j + 1 < count; ++j)
        {
            const auto here = static_cast<std::size_t>(j);
            add(expected, project(begin + j * spacing, begin + (j + 1) * spacing, wedgeHalves,
                                  [&](double phi)
                                  {
                                      const double t = (phi - begin) / spacing - j;
                                      return blend({slices[here], slices[here + 1]}, {1.0 - t, t});
                                  }));
            add(unfolded, turned(apply(wedges.linear(), {slices[here], slices[here + 1]}),
                                 begin + j * spacing));
        }
        for (int j = 0; j < count; ++j)
        {
            const ShMatrix<4> matrix = j == 0           ? wedges.foldedFirst()
                                       : j == count - 1 ? wedges.foldedLast()
                                                        : wedges.folded(AzimuthBlend::Linear);
            add(folded,
                turned(apply(matrix, {slices[static_cast<std::size_t>(j)]}), begin + j * spacing));
        }
        expectNear(unfolded, expected, 8.0 * count * wedgeBound(spacing));
        expectNear(folded, unfolded, 1e-14);
    }
}

TEST(WedgeMatrices, ConstantLightHasOneCoefficient)
{
    // 2√π L (MATHS, Environment maps): L = 1 is the slice (√2, 0, 0, 0).
    for (const int count : {4, 32, 256})
        for (const AzimuthBlend kind : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        {
            const WedgeMatrices wedges(2.0 * pi / count);
            const std::vector<Slice> slices(static_cast<std::size_t>(count),
                                            Slice{std::sqrt(2.0), 0.0, 0.0, 0.0});
            Sh expected = {};
            expected[0] = 2.0 * std::sqrt(pi);
            expectNear(sumFolded(wedges, kind, slices), expected, 1e-13);
            expectNear(sumOfWedges(wedges, kind, slices), expected, 1e-13);
        }
}

TEST(WedgeMatrices, SymmetricLightKeepsItsZonalPart)
{
    // Any slice w in all azimuths: c_l0 = √(2π) w_l, by N_l0 = P̂_l / √(2π); and no other order.
    const Slice slice = {0.3, -1.2, 0.7, 2.0};
    const WedgeMatrices wedges(2.0 * pi / 16.0);
    const Sh found = sumFolded(wedges, AzimuthBlend::Linear, std::vector<Slice>(16, slice));
    forEachHarmonic(
        [&](std::size_t row, int l, int m)
        {
            EXPECT_NEAR(found[row],
                        m == 0 ? std::sqrt(2.0 * pi) * slice[static_cast<std::size_t>(l)] : 0.0,
                        1e-13);
        });
}

TEST(WedgeMatrices, MoreAzimuthsConverge)
{
    // Slices of 1 + cos φ: what blending loses of order 1 is 1 − sinc² = x²/12 and 1 − sinc⁴ = x²/6
    // of the spacing x, to second order.
    for (const AzimuthBlend kind : {AzimuthBlend::Linear, AzimuthBlend::BSpline})
        for (const int count : {8, 16, 32, 64})
        {
            const double x = 2.0 * pi / count;
            const WedgeMatrices wedges(x);
            std::vector<Slice> slices;
            for (int j = 0; j < count; ++j)
                slices.push_back({1.0 + std::cos(j * x), 0.0, 0.0, 0.0});
            const double whole = pi * WedgeMatrices::elevationIntegrals(1, 1)[0];
            const double lost = 1.0 - sumFolded(wedges, kind, slices)[3] / whole;
            const double expected = x * x / (kind == AzimuthBlend::Linear ? 12.0 : 6.0);
            EXPECT_NEAR(lost, expected, 0.05 * expected + 1e-12);
        }
}
