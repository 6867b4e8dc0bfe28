// Tiles of one row or column, of one post, and of two.
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/HardCase.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::hard;

// Along the row every sample is a post: exact for the method. Any other ray leaves the data at once
// and has no horizon, -90 degrees, which is what the reference says too. There is no cell, so
// normals point straight up and light is that of level ground below its horizons.
TEST(OneRow, OneByN)
{
    OTL_NEED_GL(context);
    for (const auto& [width, height] : {std::pair{1, 1},
                                        {1, 2},
                                        {2, 1},
                                        {2, 2},
                                        {1, 17},
                                        {17, 1},
                                        {1, 256},
                                        {257, 1},
                                        {2, 129},
                                        {128, 2}})
        checkHardCase(
            context->state(),
            {std::to_string(width) + " x " + std::to_string(height),
             analytic::makeTile(width, height, 30.0,
                                [](int x, int y) { return (x * 7919 + y * 104729) % 1009 * 0.5; }),
             16,
             {{90.0, 20.0}, {0.0, 20.0}, {45.0, 20.0}}});
}
