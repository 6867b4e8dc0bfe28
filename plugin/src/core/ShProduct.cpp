#include "core/ShProduct.h"

#include "core/Quadrature.h"
#include "glsl_host.h"

#include <cmath>
#include <memory>

namespace osgTerrainLight
{

namespace
{
/// ∫ Y_i Y_j Y_k over the sphere. Products of three have degree 9 in z where they do not vanish,
/// and at most 9 turns of azimuth: both rules are exact.
using Triples = std::array<ShMatrix<16>, 16>;

Triples computed()
{
    constexpr double pi = 3.14159265358979323846;
    constexpr int turns = 16;
    Triples triples = {};
    const GaussRule& rule = gaussRule();
    for (std::size_t node = 0; node < rule.places.size(); ++node)
        for (int turn = 0; turn < turns; ++turn)
        {
            const double z = 2.0 * rule.places[node] - 1.0;
            const double side = std::sqrt(1.0 - z * z);
            const double azimuth = 2.0 * pi * turn / turns;
            const auto sh =
                Glsl<double>().shBasis({side * std::cos(azimuth), side * std::sin(azimuth), z});
            ShFunction basis;
            for (std::size_t i = 0; i < 16; ++i)
                basis[i] = sh.c[i / 4][static_cast<int>(i % 4)];
            const double weight = 2.0 * rule.weights[node] * 2.0 * pi / turns;
            for (std::size_t i = 0; i < 16; ++i)
                for (std::size_t j = 0; j < 16; ++j)
                    for (std::size_t k = 0; k < 16; ++k)
                        triples[k][i][j] += weight * basis[i] * basis[j] * basis[k];
        }
    return triples;
}
} // namespace

ShMatrix<16> shProduct(const ShFunction& f)
{
    static const auto triples = std::make_unique<const Triples>(computed()); // 32 KiB
    ShMatrix<16> matrix = {};
    for (std::size_t k = 0; k < 16; ++k)
        for (std::size_t i = 0; i < 16; ++i)
            for (std::size_t j = 0; j < 16; ++j)
                matrix[i][j] += f[k] * (*triples)[k][i][j];
    return matrix;
}

} // namespace osgTerrainLight
