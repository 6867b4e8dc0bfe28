#pragma once

#include "core/Result.h"
#include "io/RasterFrame.h"

#include <cstddef>
#include <string>
#include <vector>

class OGRSpatialReference;

namespace osgTerrainLight
{

/// Length on the ground of a small step in longitude and latitude.
struct MetresPerRadian
{
    double east = 0.0;
    double north = 0.0;
};

/// On an ellipsoid with semi-axes a ≥ b > 0 [m] at a geodetic latitude [rad], −π/2 … π/2:
/// north is the meridional radius of curvature a²b²/w³, east the prime vertical radius a²/w times
/// cos(latitude), with w² = a²cos² + b²sin² (Snyder, Map Projections, 1987, eqs 4-18 to 4-20). At
/// the poles, where all longitudes meet, cos is kept at 1e-6, so that a spacing is always > 0.
MetresPerRadian metresPerRadian(double latitude, double semiMajor, double semiMinor);

/// Ground distances in a raster of degrees, of any tile row: of one beyond the frame as well.
class DegreeRows
{
public:
    /// crs: geographic.
    DegreeRows(const OGRSpatialReference& crs, const RasterFrame& frame);

    double latitude(double row) const; ///< [rad]
    bool isBeyondPole(int row) const;
    double east(double row) const;  ///< between columns [m]
    double north(double row) const; ///< between rows, there [m]

private:
    MetresPerRadian metres(double row) const;

    RasterFrame _frame;
    double _radiansPerUnit, _semiMajor, _semiMinor;
};

/// What heights of a map are multiplied by, above the height in the middle of their range, so that
/// one spacing of rows serves posts whose ground spacing differs: with a spacing twice too long,
/// slopes are right on heights twice as high. Between posts p and q the tangent is then that of
/// the mean scale, but for at most |gradient of ln(factor)| times the greatest height above or
/// below the middle of the range.
class HeightFactors
{
public:
    HeightFactors() = default; ///< 1 everywhere
    /// values > 0 at nodes spread evenly over width × height posts, corners included; rows of nodes
    /// from the south.
    HeightFactors(int width, int height, int columns, int rows, std::vector<double> values);

    bool areOne() const { return _values.empty(); }
    /// Of a post of the tile, bilinear between nodes.
    double at(int column, int row) const;
    /// Greatest |gradient of ln(factor)| [1/m] between neighbouring nodes; east, north: between
    /// posts [m].
    double steepest(double east, double north) const;

private:
    double node(int column, int row) const
    {
        return _values[static_cast<std::size_t>(row) * static_cast<std::size_t>(_columns) +
                       static_cast<std::size_t>(column)];
    }

    int _width = 1, _height = 1, _columns = 0, _rows = 0;
    std::vector<double> _values;
};

/// Ground distances between the posts of a raster.
struct GroundSpacing
{
    double north = 1.0;             ///< between rows [m]
    std::vector<double> east;       ///< between columns [m], tile rows, or one for all
    std::vector<bool> beyondPole;   ///< by tile row; empty where none is
    HeightFactors factors;          ///< for heights
    bool geographic = false;        ///< degrees
    std::vector<std::string> notes; ///< assumptions made, one sentence each
};

/// crs: null where the raster has none, and map units are then metres. Degrees: per row, after
/// metresPerRadian(). Maps that are true within 0.2 % in the whole raster (UTM in its zone,
/// national grids): the map's own. All others: the projection's scale at each post, by MapGround;
/// exact where it is the same in all directions (conformal maps, Web Mercator) or differs between
/// east and north in the same way along each row (equirectangular and other cylindrical maps). On
/// what is neither the middle of the raster is right, and a note tells by how much slopes are wrong
/// elsewhere.
Result<GroundSpacing> measureGround(const std::string& path, const OGRSpatialReference* crs,
                                    const RasterFrame& frame);

} // namespace osgTerrainLight
