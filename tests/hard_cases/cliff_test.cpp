// A cliff of 1000 m in one cell, of 30 m and of 1 m.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Seen from the ground the crest is the straight line of the plateau's first posts. A ray that goes
// mainly east crosses it in a column, where it is sampled, and the line beside it finds the same
// column: exact for the method, up to 89.94 degrees. What goes mainly north meets the crest between
// two samples; that is bounded by HardCase.h.
TEST(Cliff, AThousandMetresInOneCell)
{
    OTL_NEED_GL(context);
    constexpr int crest = 70;
    for (const double spacing : {30.0, 1.0})
    {
        const DemTile tile = analytic::wall(97, 83, spacing, crest, 1000.0);
        const HardCase hardCase = {spacing > 1.0 ? "cliff, cells of 30 m" : "cliff, cells of 1 m",
                                   tile,
                                   16,
                                   {{90.0, 80.0}, {315.0, 35.0}}};
        checkHardCase(context->state(), hardCase);
        expectHorizons(context->state(), hardCase,
                       [&](int x, int y, const MapDirection& d) -> std::optional<double>
                       {
                           const int away = crest - x;
                           const double aside = away * d.north / d.east;
                           if (away < 1 || d.east < std::abs(d.north) || y + aside < 1.0 ||
                               y + aside > 81.0 || y < 1 || y > 81)
                               return std::nullopt;
                           return analytic::wallHorizon(1000.0, away * spacing, d);
                       });
    }
}
