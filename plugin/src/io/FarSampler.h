#pragma once

#include "core/PostRect.h"
#include "io/HeightReader.h"
#include "io/PostsToPixels.h"
#include "io/RasterHeights.h"

#include <functional>
#include <optional>
#include <vector>

namespace osgTerrainLight
{

/// Samples a window of a raster's pixels at posts of another one.
class FarSampler
{
public:
    FarSampler(const std::string& path, HeightReader<double>& reader, const BandFacts& facts,
               const HeightRules& rules, const PixelWindow& window, const PostsToPixels& toPixels,
               const RasterHeights& near)
        : _path(path), _reader(reader), _facts(facts), _rules(rules), _window(window),
          _toPixels(toPixels), _near(near)
    {
    }

    /// Heights of posts of a level [m above near.origin()], row after row, NaN where void.
    std::optional<Error> sample(int level, const PostRect& posts, float* heights);

private:
    /// Of a part of the posts. first: of its heights; they lie `stride` apart from row to row.
    std::optional<Error> samplePart(int level, const PostRect& posts, float* first, int stride);
    void take(int level, const PostRect& posts, const std::vector<PostsToPixels::Places>& places,
              const PixelWindow& pixels, float* first, int stride) const;

    const std::string& _path;
    HeightReader<double>& _reader;
    const BandFacts& _facts;
    const HeightRules& _rules;
    const PixelWindow& _window;
    const PostsToPixels& _toPixels;
    const RasterHeights& _near;
    std::vector<double> _values; ///< of the pixels of a part
};

/// The pixels around places, within a window; empty where none is in it.
PixelWindow pixelsAround(const std::vector<PostsToPixels::Places>& places,
                         const PixelWindow& window);

} // namespace osgTerrainLight
