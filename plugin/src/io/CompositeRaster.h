#pragma once

#include "core/Result.h"
#include "io/CompositeDem.h"
#include "io/OverviewSource.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

/// Layers of heights as one raster of any size, read where it is asked for.
struct CompositeRaster
{
    std::unique_ptr<OverviewSource> source;             ///< null where no layer could be read
    std::vector<std::pair<std::size_t, Error>> leftOut; ///< layers by number, and the reason
    std::vector<std::string> notes;                     ///< with the file, one sentence each
};

/// As readComposite(), of all posts: nothing is averaged. Nothing where the layers together, those
/// that can be read, have no more than mostPosts posts a side. Coarse levels are sampled from
/// posts of each layer that are at least twice as dense, from its overviews where it has some.
std::optional<CompositeRaster> openComposite(const std::vector<DemLayer>& layers, int mostPosts);

} // namespace osgTerrainLight
