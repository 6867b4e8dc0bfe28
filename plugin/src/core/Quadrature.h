#pragma once

#include <array>
#include <cstddef>

namespace osgTerrainLight
{

/// Gauss-Legendre on 0 … 1, exact for polynomials up to degree 63.
struct GaussRule
{
    static constexpr int nodeCount = 32;
    std::array<double, nodeCount> places;
    std::array<double, nodeCount> weights;
};
const GaussRule& gaussRule();

/// ∫ f over a … b, where f is smooth: of entire functions that turn a few times, rounding is all
/// that it leaves.
template <class Function>
double integral(double a, double b, const Function& f)
{
    const GaussRule& rule = gaussRule();
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.places.size(); ++i)
        sum += rule.weights[i] * f(a + (b - a) * rule.places[i]);
    return (b - a) * sum;
}

} // namespace osgTerrainLight
