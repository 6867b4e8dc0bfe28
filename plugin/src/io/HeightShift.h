#pragma once

#include "core/Result.h"
#include "io/RasterFrame.h"

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A surface that heights are above.
struct VerticalDatum
{
    std::string name;  ///< as it was given; empty where none is known
    std::string known; ///< the same text for all names of one datum; empty where PROJ knows none
    std::string crs;   ///< degrees on WGS 84 with heights above it, as PROJ takes it

    bool isNamed() const { return !name.empty(); }
};

/// By a name of osgEarth (egm84, egm96, egm2008), a vertical CRS of EPSG (epsg:5703), the ellipsoid
/// (ellipsoid, wgs84), or a file of a geoid's grid that PROJ reads (.gtx, .tif).
VerticalDatum verticalDatumByName(const std::string& name);

/// Of a compound CRS (WKT); without a name where the CRS is none.
VerticalDatum verticalDatumOfCrs(const std::string& wkt);

/// How much higher heights of a raster are above another vertical datum. Both datums are read at a
/// lattice of at most 129 × 129 places over the raster, bilinear between them: the geoid is smooth.
class HeightShift
{
public:
    /// Errors: a datum is not known, PROJ has no grid for it, or the grid does not cover the
    /// raster.
    static Result<HeightShift> between(const VerticalDatum& from, const VerticalDatum& to,
                                       const RasterFrame& raster);

    double at(double mapX, double mapY) const; ///< [m]
    double lowest() const { return _lowest; }
    double highest() const { return _highest; }

private:
    HeightShift() = default;

    int _columns = 1, _rows = 1;
    double _west = 0.0, _south = 0.0;       ///< of node (0, 0), in map units
    double _perColumn = 0.0, _perRow = 0.0; ///< nodes per map unit
    std::vector<double> _values;            ///< [m], from the south-west
    double _lowest = 0.0, _highest = 0.0;
};

} // namespace osgTerrainLight
