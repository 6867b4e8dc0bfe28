#include "core/WeightedSample.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

namespace osgTerrainLight
{

namespace
{
constexpr double risk = 0.01;
constexpr std::size_t resamples = 500;

struct Moments
{
    double mean = 0.0;
    double standardError = 0.0;
};

Moments momentsOf(double sum, double squares, std::size_t count)
{
    const double n = static_cast<double>(count);
    const double mean = sum / n;
    return {mean, std::sqrt(std::max(squares / n - mean * mean, 0.0) / (n - 1.0))};
}
} // namespace

WeightedSample drawByImportance(const std::vector<double>& importance, std::size_t count,
                                std::uint32_t seed)
{
    assert(!importance.empty() && count > 0);
    std::vector<double> sums; // up to and with each member
    double sum = 0.0;
    for (const double value : importance)
    {
        assert(value >= 0.0);
        sums.push_back(sum += value);
    }
    const double size = static_cast<double>(importance.size());
    const double share = sum > 0.0 ? 0.5 : 0.0; // of the draws by importance
    std::mt19937 random(seed); // the standard fixes its numbers, but not those of distributions
    const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
    WeightedSample sample;
    for (std::size_t i = 0; i < count; ++i)
    {
        const double place = unit();
        const bool byImportance = unit() < share;
        const std::size_t index =
            byImportance
                ? static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), place * sum) -
                                           sums.begin())
                : static_cast<std::size_t>(place * size);
        const std::size_t member = std::min(index, importance.size() - 1);
        double relative = 1.0 - share; // chance × size of the population
        if (share > 0.0)
            relative += share * size * importance[member] / sum;
        sample.indices.push_back(member);
        sample.weights.push_back(1.0 / relative);
    }
    return sample;
}

double meanSquareBound(const std::vector<double>& errors, const std::vector<double>& weights,
                       double largest)
{
    assert(errors.size() == weights.size() && errors.size() >= 2);
    const std::size_t count = errors.size();
    std::vector<double> values;
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < count; ++i)
    {
        const double value = weights[i] * errors[i] * errors[i];
        values.push_back(value);
        sum += value;
        squares += value * value;
    }
    const Moments all = momentsOf(sum, squares, count);
    const double spread = std::log(2.0 / risk);
    const double bernstein = all.mean + all.standardError * std::sqrt(2.0 * spread) +
                             7.0 * largest * spread / (3.0 * (static_cast<double>(count) - 1.0));

    // Student's t of resamples says how far a sample's own standard error can be trusted: a sample
    // that has missed the large errors has both a low mean and a low standard error.
    std::mt19937 random(20261127);
    std::vector<double> students;
    for (std::size_t r = 0; r < resamples; ++r)
    {
        double resum = 0.0, resquares = 0.0;
        for (std::size_t i = 0; i < count; ++i)
        {
            const double value = values[random() % count];
            resum += value;
            resquares += value * value;
        }
        const Moments part = momentsOf(resum, resquares, count);
        if (!(part.standardError > 0.0) && part.mean < all.mean)
            students.push_back(-HUGE_VAL);
        else
            students.push_back(
                part.standardError > 0.0 ? (part.mean - all.mean) / part.standardError : 0.0);
    }
    const auto least =
        students.begin() + static_cast<std::ptrdiff_t>(risk * static_cast<double>(resamples));
    std::nth_element(students.begin(), least, students.end());
    const double bootstrap =
        all.standardError > 0.0 ? all.mean - std::min(*least, 0.0) * all.standardError : all.mean;
    return std::min(bootstrap, bernstein);
}

} // namespace osgTerrainLight
