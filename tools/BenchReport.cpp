#include "BenchReport.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight::tool::bench
{

std::vector<bool> paretoFront(const std::vector<CostAndError>& points)
{
    std::vector<bool> front;
    for (const CostAndError& point : points)
        front.push_back(
            !std::isnan(point.error) && // a method that has no such thing
            std::none_of(points.begin(), points.end(),
                         [&](const CostAndError& other)
                         {
                             return other.cost <= point.cost && other.error <= point.error &&
                                    (other.cost < point.cost || other.error < point.error);
                         }));
    return front;
}

void markFronts(Report& report)
{
    for (const Quantity& quantity : report.quantities)
    {
        const std::size_t q = static_cast<std::size_t>(&quantity - report.quantities.data());
        std::vector<CostAndError> points;
        for (const Row& row : report.rows)
            if (row.skipped.empty())
                points.push_back({row.gpuMilliseconds, row.errors[q].*quantity.main});
        const std::vector<bool> front = paretoFront(points);
        auto next = front.begin();
        for (Row& row : report.rows)
            if (row.skipped.empty())
                row.onFront.push_back(*next++);
    }
}

} // namespace osgTerrainLight::tool::bench
