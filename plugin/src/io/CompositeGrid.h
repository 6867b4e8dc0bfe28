#pragma once

#include "core/Result.h"
#include "io/DemReader.h"
#include "io/PostsToPixels.h"

#include <ogr_spatialref.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A layer on the map of the first one, in posts of that.
struct PlacedLayer
{
    std::size_t number = 0;
    DemInfo info;
    double west = 0.0, east = 0.0, south = 0.0, north = 0.0; ///< edges of the outermost pixels
    double step = 1.0;                                       ///< between its own posts
};

/// Of WKT, with x before y.
class Crs
{
public:
    explicit Crs(const std::string& wkt);
    /// Null where there is none.
    const OGRSpatialReference* get() const { return _isThere ? &_reference : nullptr; }

private:
    OGRSpatialReference _reference;
    bool _isThere;
};

/// Why the layer cannot be placed on the first one's map; else nothing, and it is placed.
std::optional<Error> place(const std::string& path, const DemInfo& first, PlacedLayer& source);

/// Of the composite, in posts of the first layer.
struct CompositeGrid
{
    double west = -0.5, south = -0.5;
    double step = 1.0;
    RasterFrame frame;
};

/// Spans all layers, which are placed. Posts are as dense as the densest layer's, up to maxSide a
/// side.
CompositeGrid gridOf(const std::vector<PlacedLayer>& sources, int maxSide);

} // namespace osgTerrainLight
