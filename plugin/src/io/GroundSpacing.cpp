#include "io/GroundSpacing.h"

#include "io/MapGround.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace osgTerrainLight
{
namespace
{
constexpr double pi = 3.14159265358979323846;
/// Scale errors that maps are made with: UTM has 0.9996 to 1.001 in its zone.
constexpr double trueScale = 0.002;
/// A scale that differs by direction more than this is told of.
constexpr double tellableStretch = 0.02;
/// Of all ellipsoids of the Earth within 0.1 %; other bodies differ by more than 5 %.
constexpr double earthRadius = 6378137.0;

std::string number(double value)
{
    return CPLSPrintf("%.10g", value);
}

/// Values at columns × rows nodes spread evenly over a raster, rows from the south.
struct Nodes
{
    int columns, rows;
    std::vector<std::optional<GroundPoint>> points;

    const std::optional<GroundPoint>& at(int column, int row) const
    {
        return points[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                      static_cast<std::size_t>(column)];
    }
};

/// Tile row or column of a node.
double nodePost(int node, int nodes, int posts)
{
    return nodes == 1 ? 0.5 * (posts - 1) : static_cast<double>(node) * (posts - 1) / (nodes - 1);
}

Nodes sample(const MapGround& ground, const RasterFrame& frame, int columns, int rows)
{
    std::vector<std::pair<double, double>> places;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            places.emplace_back(frame.mapX(nodePost(column, columns, frame.width)),
                                frame.mapY(nodePost(row, rows, frame.height)));
    return {columns, rows, ground.at(places)};
}

bool isTrue(const Nodes& nodes, double metresPerUnit)
{
    return std::all_of(nodes.points.begin(), nodes.points.end(),
                       [metresPerUnit](const std::optional<GroundPoint>& point)
                       {
                           return !point ||
                                  std::max(std::abs(point->metresPerX() / metresPerUnit - 1.0),
                                           std::abs(point->metresPerY() / metresPerUnit - 1.0)) <=
                                      trueScale;
                       });
}

/// Of the greatest scale in any direction to the least.
double worstRatio(const GroundPoint& p)
{
    // Singular values of the Jacobian: those of Tissot's indicatrix (Snyder 1987, section 4).
    const double sum = std::hypot(p.eastAlongX + p.northAlongY, p.northAlongX - p.eastAlongY);
    const double difference =
        std::hypot(p.eastAlongX - p.northAlongY, p.northAlongX + p.eastAlongY);
    return (sum + difference) / std::max(std::abs(sum - difference), 1.0e-12 * sum);
}

/// East over north scale.
double ratioOf(const GroundPoint& point)
{
    return std::max(point.metresPerX() / std::max(point.metresPerY(), 1.0e-12 * point.metresPerX()),
                    1.0e-6);
}

/// By row of nodes; nothing where a ratio is not the same all along its row.
std::optional<std::vector<double>> ratiosByRow(const Nodes& nodes, double middle)
{
    std::vector<double> ratios;
    for (int row = 0; row < nodes.rows; ++row)
    {
        std::vector<double> along;
        for (int column = 0; column < nodes.columns; ++column)
            if (const std::optional<GroundPoint>& point = nodes.at(column, row))
                along.push_back(ratioOf(*point));
        if (along.empty())
            along.push_back(middle);
        const auto [least, most] = std::minmax_element(along.begin(), along.end());
        // At a pole of a cylindrical map all ratios are 0, but for rounding.
        if (*most - *least > trueScale * std::max(*most, 1.0e-3))
            return std::nullopt;
        ratios.push_back(0.5 * (*least + *most));
    }
    return ratios;
}

/// Greatest ratio of scales by direction that is left when each row's own was taken off.
double worstStretch(const Nodes& nodes, const std::vector<double>& ratios, double north)
{
    double worst = 1.0;
    for (int row = 0; row < nodes.rows; ++row)
        for (int column = 0; column < nodes.columns; ++column)
            if (const std::optional<GroundPoint>& point = nodes.at(column, row);
                point && point->metresPerX() > 1.0e-4 * north)
            {
                GroundPoint rest = *point;
                rest.eastAlongX /= ratios[static_cast<std::size_t>(row)];
                rest.northAlongX /= ratios[static_cast<std::size_t>(row)];
                worst = std::max(worst, worstRatio(rest));
            }
    return worst;
}

/// Scale of a projected map. middle: of the raster.
void takeScale(const Nodes& nodes, const GroundPoint& middle, const RasterFrame& frame, bool earth,
               GroundSpacing& spacing)
{
    const double stepX = std::abs(frame.geoTransform[1]);
    const double north = middle.metresPerY();
    spacing.north = std::abs(frame.geoTransform[5]) * north;
    std::vector<double> factors;
    for (const std::optional<GroundPoint>& point : nodes.points)
        factors.push_back(north / std::max(point.value_or(middle).metresPerY(), 1.0e-6 * north));
    spacing.factors =
        HeightFactors(frame.width, frame.height, nodes.columns, nodes.rows, std::move(factors));

    const double ratioOfMiddle = ratioOf(middle);
    const std::optional<std::vector<double>> byRow = ratiosByRow(nodes, ratioOfMiddle);
    const std::vector<double> ratios =
        byRow.value_or(std::vector<double>(static_cast<std::size_t>(nodes.rows), ratioOfMiddle));
    const auto eastOf = [&](int row)
    {
        const double at = nodes.rows == 1
                              ? 0.0
                              : static_cast<double>(row) * (nodes.rows - 1) / (frame.height - 1);
        const auto below = static_cast<std::size_t>(std::min(at, nodes.rows - 1.0));
        const std::size_t above = std::min(below + 1, ratios.size() - 1);
        const double share = at - static_cast<double>(below);
        return stepX * north * ((1.0 - share) * ratios[below] + share * ratios[above]);
    };
    const bool sameInAllDirections = std::all_of(
        ratios.begin(), ratios.end(), [](double ratio) { return std::abs(ratio - 1.0) < 1.0e-5; });
    spacing.east = {stepX * north * (byRow ? 1.0 : ratioOfMiddle)};
    if (byRow && !sameInAllDirections)
    {
        spacing.east.clear();
        for (int row = 0; row < frame.height; ++row)
            spacing.east.push_back(eastOf(row));
    }
    const double worst = worstStretch(nodes, ratios, north);
    if (worst - 1.0 > tellableStretch)
        spacing.notes.push_back(
            std::string("the map's scale differs by direction, by a factor of up to ") +
            CPLSPrintf("%.3g", worst) + ": slopes come out wrong by as much; " +
            (earth ? "warp to a conformal projection such as UTM"
                   : "warp to a conformal projection, such as a stereographic one centred on the "
                     "terrain"));
}

void measureMap(const OGRSpatialReference& crs, double metresPerUnit, const RasterFrame& frame,
                GroundSpacing& spacing)
{
    const std::unique_ptr<OGRSpatialReference> base(crs.CloneGeogCS());
    const std::optional<MapGround> ground =
        base ? MapGround::between(crs, *base) : std::optional<MapGround>();
    const std::pair<double, double> centre(frame.mapX(0.5 * (frame.width - 1)),
                                           frame.mapY(0.5 * (frame.height - 1)));
    const std::optional<GroundPoint> middle = ground ? ground->at({centre}).front() : std::nullopt;
    if (!middle || !(middle->metresPerY() > 0.0))
    {
        spacing.notes.push_back("PROJ does not know where the middle of the raster lies on the "
                                "ground: distances are taken from the map");
        return;
    }
    // Corners, edges and between: a smooth projection that is true there is true everywhere.
    const Nodes few = sample(*ground, frame, std::min(frame.width, 9), std::min(frame.height, 9));
    if (isTrue(few, metresPerUnit))
        return;
    // Enough for bilinear interpolation within 1e-5 over 1000 km.
    const Nodes nodes =
        sample(*ground, frame, std::min(frame.width, 33), std::min(frame.height, 257));
    const bool earth = std::abs(ground->semiMajor() / earthRadius - 1.0) < 0.01;
    takeScale(nodes, *middle, frame, earth, spacing);
}

std::optional<Error> measureDegrees(const std::string& path, const OGRSpatialReference& crs,
                                    const RasterFrame& frame, GroundSpacing& spacing)
{
    const DegreeRows rows(crs, frame);
    const int height = frame.height;
    spacing.geographic = true;
    spacing.east.clear();
    std::size_t beyond = 0;
    for (int row = 0; row < height; ++row)
    {
        const bool outside = rows.isBeyondPole(row);
        beyond += outside ? 1 : 0;
        spacing.east.push_back(rows.east(row));
        spacing.beyondPole.push_back(outside);
    }
    if (beyond == static_cast<std::size_t>(height))
        return Error{ErrorCode::Invalid,
                     path + ": CRS \"" + (crs.GetName() ? crs.GetName() : "") +
                         "\" is geographic, but latitudes are about " +
                         number(rows.latitude(0.5 * (height - 1)) * 180.0 / pi) +
                         "; needed -90 to 90"};
    if (beyond > 0)
        spacing.notes.push_back(std::to_string(beyond) + " rows lie beyond a pole and are void");
    else
        spacing.beyondPole.clear();
    spacing.north = rows.north(0.5 * (height - 1));
    if (crs.IsDerivedGeographic())
        spacing.notes.push_back("the CRS has a pole of its own: azimuths count from its north");
    return std::nullopt;
}

/// Quarter turns from east to where an axis of the map's coordinates points; nothing where it
/// points in none of the four directions. axis: 0 or 1, in GDAL's order, x first.
std::optional<int> quarterOf(const OGRSpatialReference& crs, std::size_t axis)
{
    const std::vector<int>& mapping = crs.GetDataAxisToSRSAxisMapping();
    if (axis >= mapping.size() || mapping[axis] == 0)
        return std::nullopt;
    OGRAxisOrientation orientation = OAO_Other;
    crs.GetAxis(nullptr, std::abs(mapping[axis]) - 1, &orientation);
    constexpr OGRAxisOrientation quarters[] = {OAO_East, OAO_North, OAO_West, OAO_South};
    for (int quarter = 0; quarter < 4; ++quarter)
        if (quarters[quarter] == orientation)
            return mapping[axis] > 0 ? quarter : (quarter + 2) % 4;
    return std::nullopt;
}

/// Rows and columns are taken to run east and north. Axes that are parallel are those of a polar
/// map.
void tellOfAxes(const OGRSpatialReference& crs, GroundSpacing& spacing)
{
    std::optional<int> x = quarterOf(crs, 0);
    std::optional<int> y = quarterOf(crs, 1);
    // GDAL puts latitudes second only where longitudes count to the east; files do so always.
    if (crs.IsGeographic() && x && *x % 2 == 1)
        std::swap(x, y);
    if (!x || !y || (*x == 0 && *y == 1) || (*x - *y) % 2 == 0)
        return;
    constexpr const char* names[] = {"east", "north", "west", "south"};
    const bool mirrored = (*y - *x + 4) % 4 == 3;
    spacing.notes.push_back(std::string("the CRS's axes point ") + names[*x] + " and " + names[*y] +
                            ", but are taken as east and north: " +
                            (mirrored ? "light comes out mirrored"
                                      : "azimuths count from the " + std::string(names[*y])) +
                            "; gdalwarp to a CRS whose axes point east and north");
}
} // namespace

MetresPerRadian metresPerRadian(double latitude, double semiMajor, double semiMinor)
{
    const double a2 = semiMajor * semiMajor;
    const double b2 = semiMinor * semiMinor;
    const double cosine = std::max(std::cos(latitude), 1.0e-6);
    const double sine = std::sin(latitude);
    const double w2 = a2 * cosine * cosine + b2 * sine * sine;
    const double w = std::sqrt(w2);
    return {a2 / w * cosine, a2 * b2 / (w2 * w)};
}

DegreeRows::DegreeRows(const OGRSpatialReference& crs, const RasterFrame& frame)
    : _frame(frame), _radiansPerUnit(crs.GetAngularUnits()), _semiMajor(crs.GetSemiMajor()),
      _semiMinor(crs.GetSemiMinor())
{
}

double DegreeRows::latitude(double row) const
{
    return _frame.mapY(row) * _radiansPerUnit;
}

bool DegreeRows::isBeyondPole(int row) const
{
    // A post on the pole itself may lie beyond it by rounding.
    return std::abs(latitude(row)) > 0.5 * pi + 1.0e-9;
}

MetresPerRadian DegreeRows::metres(double row) const
{
    return metresPerRadian(std::clamp(latitude(row), -0.5 * pi, 0.5 * pi), _semiMajor, _semiMinor);
}

double DegreeRows::east(double row) const
{
    return std::abs(_frame.geoTransform[1]) * _radiansPerUnit * metres(row).east;
}

double DegreeRows::north(double row) const
{
    return std::abs(_frame.geoTransform[5]) * _radiansPerUnit * metres(row).north;
}

HeightFactors::HeightFactors(int width, int height, int columns, int rows,
                             std::vector<double> values)
    : _width(width), _height(height), _columns(columns), _rows(rows), _values(std::move(values))
{
    assert(_values.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
}

double HeightFactors::at(int column, int row) const
{
    if (_values.empty())
        return 1.0;
    const auto place = [](int post, int posts, int nodes)
    {
        const double at = nodes == 1 ? 0.0 : static_cast<double>(post) * (nodes - 1) / (posts - 1);
        const int before = std::clamp(static_cast<int>(at), 0, std::max(nodes - 2, 0));
        return std::pair(before, at - before);
    };
    const auto [x, shareX] = place(column, _width, _columns);
    const auto [y, shareY] = place(row, _height, _rows);
    const auto value = [this](int c, int r)
    { return node(std::min(c, _columns - 1), std::min(r, _rows - 1)); };
    const double south = (1.0 - shareX) * value(x, y) + shareX * value(x + 1, y);
    const double north = (1.0 - shareX) * value(x, y + 1) + shareX * value(x + 1, y + 1);
    return (1.0 - shareY) * south + shareY * north;
}

double HeightFactors::steepest(double east, double north) const
{
    // Between nodes [m].
    const double stepX = east * (_width - 1) / std::max(_columns - 1, 1);
    const double stepY = north * (_height - 1) / std::max(_rows - 1, 1);
    double most = 0.0;
    for (int row = 0; row < _rows; ++row)
        for (int column = 0; column < _columns; ++column)
        {
            const auto change = [&](int otherColumn, int otherRow, double step)
            {
                return otherColumn < 0 || otherRow < 0
                           ? 0.0
                           : std::log(node(column, row) / node(otherColumn, otherRow)) / step;
            };
            most = std::max(
                most, std::hypot(change(column - 1, row, stepX), change(column, row - 1, stepY)));
        }
    return most;
}

Result<GroundSpacing> measureGround(const std::string& path, const OGRSpatialReference* crs,
                                    const RasterFrame& frame)
{
    GroundSpacing spacing;
    double metresPerUnit = 1.0;
    const std::string name = crs && crs->GetName() ? crs->GetName() : "";
    if (!frame.hasGeoTransform)
        crs = nullptr; // the cell size came in metres
    else if (!crs)
        spacing.notes.push_back("no CRS: map coordinates are taken as metres");
    if (crs && crs->IsGeocentric())
        return Error{ErrorCode::NotSupported,
                     path + ": CRS \"" + name + "\" is geocentric; needed a map or geographic one"};
    if (crs && (crs->IsGeographic() || crs->IsProjected()))
        tellOfAxes(*crs, spacing);
    if (crs && crs->IsGeographic())
    {
        if (auto error = measureDegrees(path, *crs, frame, spacing))
            return *error;
        return spacing;
    }
    if (crs && crs->IsProjected())
        metresPerUnit = crs->GetTargetLinearUnits("PROJCS");
    else if (crs && crs->IsLocal())
    {
        metresPerUnit = crs->GetTargetLinearUnits("LOCAL_CS");
        spacing.notes.push_back("local CRS \"" + name + "\": one unit is taken as " +
                                number(metresPerUnit) + " m");
    }
    else if (crs)
        spacing.notes.push_back("CRS \"" + name +
                                "\" has no horizontal part: map coordinates are taken as metres");
    if (!(std::isfinite(metresPerUnit) && metresPerUnit > 0.0))
        return Error{ErrorCode::Invalid, path + ": CRS has a unit of " + number(metresPerUnit) +
                                             " m; needed more than 0"};
    spacing.north = std::abs(frame.geoTransform[5]) * metresPerUnit;
    spacing.east = {std::abs(frame.geoTransform[1]) * metresPerUnit};
    if (crs && crs->IsProjected())
        measureMap(*crs, metresPerUnit, frame, spacing);
    return spacing;
}

} // namespace osgTerrainLight
