#pragma once

#include "io/EnvironmentFile.h"

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// Pixels, row by row from the top.
struct Picture
{
    int width = 0;
    int height = 0;
    std::vector<Rgb> pixels;
    Rgb& at(int x, int y)
    {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
    const Rgb& at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
};

/// Of a cube's six faces below each other (ImfEnvmap.h): 4 n × 2 n texels for faces of n × n, at
/// least 64 × 32, each the mean of what it covers, so that no light is lost.
EnvironmentPicture fromCube(const Picture& cube);

} // namespace osgTerrainLight
