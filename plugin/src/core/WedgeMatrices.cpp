#include "core/WedgeMatrices.h"

#include "core/Quadrature.h"

#include <cassert>
#include <cmath>
#include <cstdlib>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

/// Associated Legendre function P_lm(cos θ), without the sign (−1)^m, by recurrence in l.
double associatedLegendre(int l, int m, double theta)
{
    double value = 1.0; // P_mm = (2m − 1)!! sin^m θ
    for (int i = 1; i <= m; ++i)
        value *= (2 * i - 1) * std::sin(theta);
    double before = 0.0;
    for (int i = m + 1; i <= l; ++i)
    {
        const double next =
            ((2 * i - 1) * std::cos(theta) * value - (i + m - 1) * before) / (i - m);
        before = value;
        value = next;
    }
    return value;
}

/// P̂_c(cos θ)
double legendre(int c, double theta)
{
    return std::sqrt(c + 0.5) * associatedLegendre(c, 0, theta);
}

/// N_lm: Y_l,±m without its cosine or sine of azimuth.
double elevationPart(int l, int m, double theta)
{
    double ratio = 1.0; // (l − m)! / (l + m)!
    for (int i = l - m + 1; i <= l + m; ++i)
        ratio /= i;
    return std::sqrt((m == 0 ? 1.0 : 2.0) * (2 * l + 1) / (4.0 * pi) * ratio) *
           associatedLegendre(l, m, theta);
}

/// Basis functions of the uniform cubic B-spline between knots 1 and 2 of four.
double bsplineBasis(int index, double a)
{
    switch (index)
    {
    case 0:
        return (1.0 - a) * (1.0 - a) * (1.0 - a) / 6.0;
    case 1:
        return (3.0 * a * a * a - 6.0 * a * a + 4.0) / 6.0;
    case 2:
        return bsplineBasis(1, 1.0 - a);
    default:
        return a * a * a / 6.0;
    }
}

template <class Function>
AzimuthWeights moments(double spacing, const Function& basis)
{
    AzimuthWeights result;
    for (int m = 0; m < 4; ++m)
    {
        const auto at = static_cast<std::size_t>(m);
        result.even[at] = integral(
            0.0, spacing, [&](double phi) { return basis(phi / spacing) * std::cos(m * phi); });
        result.odd[at] = integral(
            0.0, spacing, [&](double phi) { return basis(phi / spacing) * std::sin(m * phi); });
    }
    return result;
}

/// The moments about azimuth `angle` in place of 0.
AzimuthWeights momentsAbout(double angle, const AzimuthWeights& about0)
{
    AzimuthWeights result;
    for (std::size_t m = 0; m < 4; ++m)
    {
        const double c = std::cos(static_cast<double>(m) * angle);
        const double s = std::sin(static_cast<double>(m) * angle);
        result.even[m] = c * about0.even[m] + s * about0.odd[m];
        result.odd[m] = c * about0.odd[m] - s * about0.even[m];
    }
    return result;
}

template <class Function>
void forEachHarmonic(const Function& function)
{
    for (int l = 0; l < 4; ++l)
        for (int m = -l; m <= l; ++m)
            function(static_cast<std::size_t>(l * (l + 1) + m), l, m);
}
} // namespace

WedgeMatrices::WedgeMatrices(double spacing) : _spacing(spacing), _linear(), _bspline()
{
    // All integrands are products of a cubic and of cosines of at most 7 half turns.
    assert(spacing > 0.0 && spacing <= 2.1);
    _linear[0] = moments(spacing, [](double a) { return 1.0 - a; });
    _linear[1] = moments(spacing, [](double a) { return a; });
    for (int i = 0; i < 4; ++i)
        _bspline[static_cast<std::size_t>(i)] =
            moments(spacing, [i](double a) { return bsplineBasis(i, a); });
}

const std::array<double, 4>& WedgeMatrices::elevationIntegrals(int l, int m)
{
    assert(l >= 0 && l < 4 && m >= 0 && m <= l);
    static const auto all = []
    {
        std::array<std::array<double, 4>, 16> result = {};
        forEachHarmonic(
            [&](std::size_t row, int band, int order)
            {
                for (int c = 0; c < 4; ++c)
                    // By parity; the quadrature would leave its rounding there.
                    if ((band + order + c) % 2 == 0)
                        result[row][static_cast<std::size_t>(c)] =
                            integral(0.0, pi,
                                     [&](double theta) {
                                         return elevationPart(band, std::abs(order), theta) *
                                                legendre(c, theta) * std::sin(theta);
                                     });
            });
        return result;
    }();
    return all[static_cast<std::size_t>(l * (l + 1) + m)];
}

ShMatrix<4> WedgeMatrices::matrixOf(const AzimuthWeights& weights)
{
    ShMatrix<4> matrix = {};
    forEachHarmonic(
        [&](std::size_t row, int l, int m)
        {
            const auto order = static_cast<std::size_t>(std::abs(m));
            const double weight = m < 0 ? weights.odd[order] : weights.even[order];
            for (std::size_t c = 0; c < 4; ++c)
                matrix[row][c] = weight * elevationIntegrals(l, std::abs(m))[c];
        });
    return matrix;
}

ShMatrix<8> WedgeMatrices::linear() const
{
    ShMatrix<8> matrix = {};
    for (std::size_t i = 0; i < 2; ++i)
    {
        const ShMatrix<4> part = matrixOf(_linear[i]);
        for (std::size_t row = 0; row < 16; ++row)
            for (std::size_t c = 0; c < 4; ++c)
                matrix[row][4 * i + c] = part[row][c];
    }
    return matrix;
}

ShMatrix<16> WedgeMatrices::bspline() const
{
    ShMatrix<16> matrix = {};
    for (std::size_t i = 0; i < 4; ++i)
    {
        const ShMatrix<4> part = matrixOf(_bspline[i]);
        for (std::size_t row = 0; row < 16; ++row)
            for (std::size_t c = 0; c < 4; ++c)
                matrix[row][4 * i + c] = part[row][c];
    }
    return matrix;
}

AzimuthWeights WedgeMatrices::weights(AzimuthBlend blend) const
{
    // The slice is number i of a wedge that begins (i − first) spacings before it.
    const bool smooth = blend == AzimuthBlend::BSpline;
    const Moments& wedge = smooth ? _bspline : _linear;
    const int count = smooth ? 4 : 2;
    const int first = smooth ? 1 : 0;
    AzimuthWeights result;
    for (int i = 0; i < count; ++i)
    {
        const AzimuthWeights own =
            momentsAbout((i - first) * _spacing, wedge[static_cast<std::size_t>(i)]);
        for (std::size_t m = 0; m < 4; ++m)
            result.even[m] += own.even[m];
    }
    return result; // odd: 0, by symmetry
}

AzimuthWeights WedgeMatrices::firstWeights() const
{
    return _linear[0];
}

AzimuthWeights WedgeMatrices::lastWeights() const
{
    return momentsAbout(_spacing, _linear[1]);
}

ShMatrix<4> WedgeMatrices::folded(AzimuthBlend blend) const
{
    return matrixOf(weights(blend));
}

ShMatrix<4> WedgeMatrices::foldedFirst() const
{
    return matrixOf(firstWeights());
}

ShMatrix<4> WedgeMatrices::foldedLast() const
{
    return matrixOf(lastWeights());
}

} // namespace osgTerrainLight
