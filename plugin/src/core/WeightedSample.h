#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

/// Members of a population drawn at random, not all with the same chance. The mean of weight ×
/// value over the sample estimates the mean of the value over the population.
struct WeightedSample
{
    std::vector<std::size_t> indices;
    std::vector<double> weights;
};

/// Draws `count` > 0 members with replacement: a half with equal chances, so that no weight exceeds
/// 2 and nothing is left out, and a half in proportion to `importance` (one value ≥ 0 per member,
/// at least one member). The best importance is what is to be averaged (Hansen and Hurwitz 1943).
/// The same arguments give the same sample on every machine.
WeightedSample drawByImportance(const std::vector<double>& importance, std::size_t count,
                                std::uint32_t seed);

/// Upper end of the one-sided 99 % confidence interval of the mean square of what `errors` are
/// drawn from, each with its weight, by a studentized bootstrap (Efron and Tibshirani 1993, 12.5),
/// or by an empirical Bernstein bound (Maurer and Pontil 2009) where that is lower: where nearly
/// all errors are 0. largest: no weight × error² exceeds it. At least two errors.
double meanSquareBound(const std::vector<double>& errors, const std::vector<double>& weights,
                       double largest);

} // namespace osgTerrainLight
