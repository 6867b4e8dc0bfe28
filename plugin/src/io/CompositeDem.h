#pragma once

#include "core/Result.h"
#include "io/DemReader.h"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

/// A raster of heights, and how it is read.
struct DemLayer
{
    std::string path;
    DemReadOptions read;
};

/// Layers of heights as one DEM.
struct CompositeDem
{
    std::optional<DemTile> tile;                        ///< nothing where no layer could be read
    std::vector<std::pair<std::size_t, Error>> leftOut; ///< layers by number, and the reason
    std::vector<std::string> notes;                     ///< with the file, one sentence each
};

/// As readDemReduced(), of a DEM of at least 2 × 2 posts, which can be drawn.
Result<DemFile> readDrawn(const std::string& path, const DemReadOptions& options, int maxSide);

/// Layers of any CRS and resolution, lowest first: a later one covers those before it, but for its
/// voids. The map is that of the first layer that can be read. The DEM spans all layers. Its posts
/// are as dense as the densest layer's, up to maxSide a side; denser layers are averaged first,
/// others sampled bilinearly. A layer that cannot be read, or not be placed on that map, is left
/// out. One layer alone is read by readDrawn().
CompositeDem readComposite(const std::vector<DemLayer>& layers, int maxSide);

} // namespace osgTerrainLight
