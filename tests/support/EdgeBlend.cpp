#include "support/EdgeBlend.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace osgTerrainLight
{
namespace
{
/// 0 at 0, 1 from 1 on, level at both.
float smooth(float at)
{
    const float x = std::min(at, 1.0f);
    return x * x * (3.0f - 2.0f * x);
}

float mix(float a, float b, float part)
{
    // Both ends to the last bit, whatever the other value is.
    return part <= 0.0f ? a : part >= 1.0f ? b : a + part * (b - a);
}

Rgb mix(const Rgb& a, const Rgb& b, float part)
{
    return {mix(a[0], b[0], part), mix(a[1], b[1], part), mix(a[2], b[2], part)};
}

bool isFinite(float value)
{
    return std::isfinite(value);
}

bool isFinite(const Rgb& value)
{
    return isFinite(value[0]) && isFinite(value[1]) && isFinite(value[2]);
}

/// The post before a place, and how far beyond it the place is.
struct Between
{
    int before;
    int after; ///< the same where the place is on the post
    float part;
};

Between between(int post, int first, int levels)
{
    const int step = 1 << levels;
    const int at = post - first * step;
    assert(at >= 0);
    const int rest = at % step;
    return {at / step, at / step + (rest > 0), static_cast<float>(rest) / static_cast<float>(step)};
}

template <class T>
void blend(Raster<T>& light, const PostRect& place, const Raster<T>& parent,
           const PostRect& parentPlace, int levels, const Raster<float>& weights)
{
    assert(levels >= 1 && light.width() == place.width && light.height() == place.height);
    assert(weights.width() == place.width && weights.height() == place.height);
    assert(parent.width() == parentPlace.width && parent.height() == parentPlace.height);
    for (int row = 0; row < place.height; ++row)
    {
        const Between y = between(place.row + row, parentPlace.row, levels);
        for (int column = 0; column < place.width; ++column)
        {
            const float own = weights.at(column, row);
            T& value = light.at(column, row);
            if (own >= 1.0f || !isFinite(value))
                continue;
            const Between x = between(place.column + column, parentPlace.column, levels);
            const T coarse =
                mix(mix(parent.at(x.before, y.before), parent.at(x.after, y.before), x.part),
                    mix(parent.at(x.before, y.after), parent.at(x.after, y.after), x.part), y.part);
            if (isFinite(coarse))
                value = mix(coarse, value, own);
        }
    }
}
} // namespace

Raster<float> edgeBlend(int width, int height, const CoarserNeighbours& coarser, int band)
{
    assert(width >= 1 && height >= 1 && band >= 1);
    Raster<float> weights(width, height, 1.0f);
    if (!coarser.any())
        return weights;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            // To the edges [bands].
            const float west = static_cast<float>(column) / static_cast<float>(band);
            const float east = static_cast<float>(width - 1 - column) / static_cast<float>(band);
            const float south = static_cast<float>(row) / static_cast<float>(band);
            const float north = static_cast<float>(height - 1 - row) / static_cast<float>(band);
            float nearest = 1.0f;
            const auto offer = [&nearest](bool isCoarser, float distance)
            {
                if (isCoarser)
                    nearest = std::min(nearest, distance);
            };
            offer(coarser.west, west);
            offer(coarser.east, east);
            offer(coarser.south, south);
            offer(coarser.north, north);
            offer(coarser.southWest, std::hypot(west, south));
            offer(coarser.southEast, std::hypot(east, south));
            offer(coarser.northWest, std::hypot(west, north));
            offer(coarser.northEast, std::hypot(east, north));
            weights.at(column, row) = smooth(nearest);
        }
    return weights;
}

void blendToParent(Raster<float>& light, const PostRect& place, const Raster<float>& parent,
                   const PostRect& parentPlace, int levels, const Raster<float>& weights)
{
    blend(light, place, parent, parentPlace, levels, weights);
}

void blendToParent(Raster<Rgb>& light, const PostRect& place, const Raster<Rgb>& parent,
                   const PostRect& parentPlace, int levels, const Raster<float>& weights)
{
    blend(light, place, parent, parentPlace, levels, weights);
}

} // namespace osgTerrainLight
