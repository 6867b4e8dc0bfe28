// A half sphere, corner to corner: the sweep's worst stack. Every post is a vertex of its line's
// hull, which has room for 64.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// The dome falls away from each of its posts ever faster, so each post's horizon is in its own cell
// or at its first crossing: the near field gives it exactly, whatever the hull has lost. What the
// thinned hull names must not rise above it.
TEST(HalfSphere, CornerToCorner)
{
    OTL_NEED_GL(context);
    HardCase dome = {"half sphere, on it",
                     analytic::dome(129, 129, 10.0, 64, 64, 640.0 * std::sqrt(2.0))};
    dome.hullOverflows = true;
    checkHardCase(context->state(), dome);
}

// Seen from the ground, with a radius r of 0.6 of the half diagonal. A post that is a steps old has
// been through at most a/16 thinnings (asked once in 16 steps), each of which doubles the distance
// of the vertices left. From D >= 1.3 r the tangent point is at most r - r^2/D = 434 m, 43 steps,
// past the foot: three thinnings, a vertex at least every 8 steps, so one within 4; one step more
// for the line that is not the ray. A step is at most 10.8 m where it takes 40 of them (14.1 m on
// the diagonal, 31 steps, two thinnings: less). A horizontal miss x of the tangent point of a
// circle of radius q lowers the elevation e by x^2/(2 q cos(e) X) at the distance X = D - r^2/D >=
// 577 m. With x = 54 m, q >= 0.866 r = 940 m (axis of the ray within r/2 of the centre) and e
// <= 50.3 degrees that is 0.0042 rad. The posts' own sampling of the dome, half a step from the
// tangent point, is in it.
TEST(HalfSphere, FromTheGround)
{
    OTL_NEED_GL(context);
    constexpr double spacing = 10.0, radius = 1086.0;
    HardCase dome = {"half sphere, beside it", analytic::dome(257, 257, spacing, 128, 128, radius)};
    dome.hullOverflows = true;
    checkHardCase(context->state(), dome);
    expectHorizons(
        context->state(), dome,
        [](int x, int y, const MapDirection& d) -> std::optional<double>
        {
            const double east = spacing * (128 - x), north = spacing * (128 - y);
            const double distance = std::hypot(east, north);
            const double aside = d.east * north - d.north * east;
            const double ahead = d.east * east + d.north * north;
            if (distance < 1.3 * radius || ahead <= 0.0 || std::abs(aside) > 0.5 * radius)
                return std::nullopt;
            return analytic::domeHorizon(radius, distance, std::atan2(aside, ahead));
        },
        0.0042 * 180.0 / 3.14159265);
}
