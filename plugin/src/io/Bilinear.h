#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{

/// Between posts at whole coordinates 0 … width − 1 and 0 … height − 1; up to half a post beyond
/// them it is the nearest. Voids (NaN) are left out, as long as the others have half of the weight;
/// else NaN. at(column, row): a post.
template <class At>
double bilinear(double x, double y, int width, int height, const At& at)
{
    constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    if (!(x >= -0.5 && y >= -0.5 && x <= width - 0.5 && y <= height - 0.5))
        return missing;
    const double left = std::clamp(std::floor(x), 0.0, width - 1.0);
    const double low = std::clamp(std::floor(y), 0.0, height - 1.0);
    const double shareX = std::clamp(x - left, 0.0, 1.0);
    const double shareY = std::clamp(y - low, 0.0, 1.0);
    double sum = 0.0;
    double weights = 0.0;
    for (int i = 0; i < 4; ++i)
    {
        const double weight =
            (i % 2 == 0 ? 1.0 - shareX : shareX) * (i < 2 ? 1.0 - shareY : shareY);
        if (weight == 0.0)
            continue;
        const auto value =
            static_cast<double>(at(std::min(static_cast<int>(left) + i % 2, width - 1),
                                   std::min(static_cast<int>(low) + i / 2, height - 1)));
        if (std::isnan(value))
            continue;
        sum += weight * value;
        weights += weight;
    }
    return weights >= 0.5 ? sum / weights : missing;
}

} // namespace osgTerrainLight
