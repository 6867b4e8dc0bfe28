#pragma once

#include "core/Result.h"
#include "io/EarthFile.h"
#include "io/LightParameters.h"
#include "io/MapReader.h"
#include "terrain/PagedTerrain.h"
#include <osgTerrainLight/TerrainLighting.h>
#include <osgTerrainLight/Viewpoint.h>

#include <osg/BoundingBox>

#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A scene made from files, and what there is to say about it, one sentence each.
struct TerrainModel
{
    osg::ref_ptr<TerrainLighting> node;
    std::optional<Globe> globe;        ///< that the node stands on; none: it lies on a plane
    osg::BoundingBoxd terrain;         ///< of valid posts [m], as createTerrain() places them
    std::vector<Viewpoint> viewpoints; ///< of a map, in the frame of createTerrain(); home first
    std::vector<std::string> warnings; ///< parts that are missing from the scene
    std::vector<std::string> notes;    ///< assumptions
};

/// Most posts a side of terrain that is drawn as one tile; larger rasters, and layers that are
/// larger together, are paged (PagedTerrain).
constexpr int mostDrawnPosts = 2048;

/// The tile as an osgTerrain::TerrainTile in metres: x east, y north, from its middle; z above the
/// vertical datum. Voids have no geometry. colours: bottom first, over white. Precondition: at
/// least 2 × 2 posts.
osg::ref_ptr<osg::Node> createTerrain(const DemTile& tile,
                                      const std::vector<ColourImage>& colours = {});

/// Of the valid posts of a tile, as createTerrain() places them [m].
osg::BoundingBoxd extentOf(const DemTile& tile);

/// A path or URL as it stands in a map, relative to the map's folder, as GDAL and OSG take it.
std::string resolved(const std::string& url, const std::string& folder);

/// A node with the light that people asked for, without terrain. folder: what the relative name of
/// a sky's file starts from. A sky that cannot be read is left out, with a warning.
osg::ref_ptr<TerrainLighting> createLighting(const LightParameters& light,
                                             const std::string& folder,
                                             std::vector<std::string>& warnings);

/// Time and place of the light, the place of the tile below where none was given. An error where
/// there is a time and no place.
Status setTimeAndPlace(TerrainLighting& node, const LightParameters& light,
                       const std::optional<DemTile>& tile);

/// Whether the raster is one that is paged; not where it cannot be read.
bool isPaged(const std::string& path, const DemReadOptions& read);

/// Adds paged terrain to a model, whose node is there, on its globe where it has one. Error: of
/// reading the first tile.
Status addPaged(TerrainModel& model, std::unique_ptr<OverviewSource> source,
                std::vector<DrapedColour> colours, const LightParameters& light);

/// A lit DEM. geocentric: on its ellipsoid.
Result<TerrainModel> loadRaster(const std::string& path, const DemReadOptions& read,
                                const LightParameters& light, bool geocentric = false);

/// A lit map; layers that cannot be read are left out, with a warning each. Where none is left and
/// all their files are missing, the scene is empty; else the error lists what was left out. folder:
/// what relative URLs start from. source: what messages call the map.
Result<TerrainModel> loadMap(const EarthMap& map, const std::string& folder,
                             const std::string& source);

} // namespace osgTerrainLight
