#pragma once

#include "core/Result.h"
#include "io/EarthModel.h"
#include "io/EarthViewpoint.h"
#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Viewpoint.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Where the local frame of a terrain lies on its map. The frame is in metres: x east, y north from
/// the middle of the outermost posts, z up from the vertical datum.
struct LocalFrame
{
    std::string crs;                                ///< WKT; empty where it is not known
    double mapX = 0.0, mapY = 0.0;                  ///< of the frame's origin, in units of the CRS
    double metresPerX = 1.0;                        ///< of the frame, per unit of the CRS along x
    double metresPerY = 1.0;                        ///< the same along y
    double halfWidth = 0.0;                         ///< from the origin to the outermost posts [m]
    double halfHeight = 0.0;                        ///< the same along y [m]
    std::function<double(double, double)> heightAt; ///< of the terrain at x, y [m]; NaN: unknown
};

/// Of a tile as createTerrain() draws it. The tile is used as long as the frame is.
LocalFrame localFrameOf(const DemTile& tile);

/// The viewpoint in the frame. A place without a height lies on the terrain. Without a range the
/// camera is as far away as the corners of the terrain are from each other. A camera that would
/// stand in the terrain is raised above it, and `notes` gets a sentence. Errors: the terrain has no
/// CRS, its map does not show the place, or the place is farther from its edge than that.
Result<Viewpoint> placeViewpoint(const EarthViewpoint& viewpoint, const LocalFrame& frame,
                                 std::vector<std::string>& notes);

/// Where a model stands in the frame.
struct ModelPlace
{
    double x = 0.0, y = 0.0, z = 0.0; ///< of its origin [m]
    double heading = 0.0;             ///< degrees clockwise from the frame's y axis
    std::optional<double> ground;     ///< height of the terrain there [m], where it is known
};

/// A plain place that fits degrees is one in degrees, where the terrain has a CRS that tells them;
/// all other plain places are those of the terrain's map. Errors: those of placeViewpoint(), the
/// place is not on the terrain, or the model stands on the ground where there is none.
Result<ModelPlace> placeModel(const EarthModel& model, const LocalFrame& frame);

} // namespace osgTerrainLight
