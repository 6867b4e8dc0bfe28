// Sampling where errors are likely, and the interval of the mean square.
#include "core/WeightedSample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

using namespace osgTerrainLight;

namespace
{
/// One error in 200 is 30 times the rest: the normal interval of 384 equal draws misses it often.
std::vector<double> heavyTailed()
{
    std::vector<double> errors;
    for (int i = 0; i < 20000; ++i)
        errors.push_back((i % 200 == 0 ? 30.0 : 1.0) * (1.0 + (i * 37 % 100) / 100.0));
    return errors;
}

double meanSquare(const std::vector<double>& values)
{
    double sum = 0.0;
    for (const double value : values)
        sum += value * value / static_cast<double>(values.size());
    return sum;
}

std::vector<double> at(const std::vector<double>& values, const WeightedSample& sample)
{
    std::vector<double> drawn;
    for (const std::size_t index : sample.indices)
        drawn.push_back(values[index]);
    return drawn;
}
} // namespace

// Expected: weights undo the chances, whatever the importance; 4 standard errors of the mean of
// 400 samples of 384.
TEST(WeightedSample, MeansAreUnbiased)
{
    const std::vector<double> errors = heavyTailed();
    std::vector<double> wrong, none(errors.size(), 0.0);
    for (std::size_t i = 0; i < errors.size(); ++i)
        wrong.push_back(i < 1000 ? 1.0 : 0.1); // says nothing about the errors
    const double expected = meanSquare(errors);
    for (const std::vector<double>& importance : {wrong, none})
    {
        double sum = 0.0, squares = 0.0;
        for (std::uint32_t seed = 0; seed < 400; ++seed)
        {
            const WeightedSample sample = drawByImportance(importance, 384, seed);
            double mean = 0.0;
            for (std::size_t i = 0; i < sample.indices.size(); ++i)
            {
                EXPECT_LE(sample.weights[i], 2.0);
                mean += sample.weights[i] * errors[sample.indices[i]] * errors[sample.indices[i]] /
                        384.0;
            }
            sum += mean / 400.0;
            squares += mean * mean / 400.0;
        }
        EXPECT_NEAR(sum, expected, 4.0 * std::sqrt((squares - sum * sum) / 400.0));
    }
}

// Expected: 99 % of intervals hold the mean square; 4 binomial deviations of 400 trials are 8 more
// than the 4 that may miss. Where the importance is the square itself, the interval is narrow as
// well.
TEST(WeightedSample, BoundHoldsForHeavyTails)
{
    const std::vector<double> errors = heavyTailed();
    std::vector<double> rough;
    std::mt19937 random(4);
    for (const double error : errors) // within a factor of two
        rough.push_back(error * error * (0.5 + 1.5 * static_cast<double>(random()) / 4294967296.0));
    const double expected = meanSquare(errors);
    int missed = 0;
    double widest = 0.0;
    for (std::uint32_t seed = 0; seed < 400; ++seed)
    {
        const WeightedSample sample = drawByImportance(rough, 384, seed);
        const double bound = meanSquareBound(at(errors, sample), sample.weights, 2.0 * 3600.0);
        missed += bound < expected ? 1 : 0;
        widest = std::max(widest, bound / expected);
    }
    std::printf("missed %d of 400, widest %.3f\n", missed, widest);
    EXPECT_LE(missed, 12);
    EXPECT_LE(widest, 1.5);
}

// Expected: theorem 4 of Maurer and Pontil by hand, with a risk of 0.01.
TEST(WeightedSample, NoErrorFoundIsNotNoError)
{
    const std::vector<double> ones(100, 1.0);
    EXPECT_EQ(meanSquareBound(std::vector<double>(100, 0.0), ones, 0.0), 0.0);
    std::vector<double> one(100, 0.0);
    one[50] = 1.0;
    // A third of resamples see no error at all, so only Bernstein's bound says something.
    const double spread = std::log(200.0);
    const double expected =
        0.01 + std::sqrt(2.0 * 0.01 * 0.99 / 99.0 * spread) + 7.0 * spread / (3.0 * 99.0);
    EXPECT_NEAR(meanSquareBound(one, ones, 1.0), expected, 1e-12);
}

// Expected: the numbers of std::mt19937 are fixed by the standard.
// So a sample is the same on every machine; here twice on this one, with weights by hand.
TEST(WeightedSample, IsTheSameEachTime)
{
    const std::vector<double> importance = {0.0, 1.0, 3.0};
    const WeightedSample first = drawByImportance(importance, 50, 7);
    const WeightedSample again = drawByImportance(importance, 50, 7);
    EXPECT_EQ(first.indices, again.indices);
    EXPECT_EQ(first.weights, again.weights);
    for (std::size_t i = 0; i < first.indices.size(); ++i) // 1 / (½ + ½·3·importance/4)
        EXPECT_DOUBLE_EQ(first.weights[i], 1.0 / (0.5 + 0.375 * importance[first.indices[i]]));
}
