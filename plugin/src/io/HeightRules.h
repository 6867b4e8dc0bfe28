#pragma once

#include "io/RasterBand.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace osgTerrainLight
{

/// What all values of a raster together say about each of them: which are void though neither
/// nodata value nor mask say so, and whether they are radii (CustomaryVoids, HeightSurvey). Plain
/// numbers, so that a raster's can be kept.
struct HeightRules
{
    std::vector<double> voids;          ///< stored values that are void
    double lowest = 0.0, highest = 0.0; ///< of a value [m]; any beyond is void
    bool kilometres = false;            ///< values were taken as metres and are kilometres
    double radius = 0.0;                ///< that comes off [m]

    /// A stored value [m]; NaN where it is void. A stored NaN is void.
    double metresOf(double stored, const BandFacts& facts) const
    {
        const double metres = facts.metresOf(stored);
        // Comparisons with NaN are false.
        const bool isHeight = metres >= lowest && metres <= highest &&
                              std::find(voids.begin(), voids.end(), stored) == voids.end();
        return isHeight ? metres : std::numeric_limits<double>::quiet_NaN();
    }
    /// Above the radius, where there is one. metres: of metresOf().
    double heightOf(double metres) const
    {
        return (kilometres ? 1000.0 * metres : metres) - radius;
    }
};

} // namespace osgTerrainLight
