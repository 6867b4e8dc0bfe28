#include "core/Quadrature.h"

#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

GaussRule computed()
{
    GaussRule rule = {};
    for (int i = 0; i < GaussRule::nodeCount; ++i)
    {
        // Newton's method on P_n, from the usual estimate of its roots.
        double x = std::cos(pi * (i + 0.75) / (GaussRule::nodeCount + 0.5));
        double derivative = 1.0;
        for (int step = 0; step < 8; ++step)
        {
            double before = 1.0;
            double value = x;
            for (int n = 2; n <= GaussRule::nodeCount; ++n)
            {
                const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
                before = value;
                value = next;
            }
            derivative = GaussRule::nodeCount * (x * value - before) / (x * x - 1.0);
            x -= value / derivative;
        }
        const auto at = static_cast<std::size_t>(i);
        rule.places[at] = 0.5 * (1.0 - x);
        rule.weights[at] = 1.0 / ((1.0 - x * x) * derivative * derivative);
    }
    return rule;
}
} // namespace

const GaussRule& gaussRule()
{
    static const GaussRule rule = computed();
    return rule;
}

} // namespace osgTerrainLight
