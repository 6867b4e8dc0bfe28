#include "reference/ExhaustiveHorizon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace osgTerrainLight::reference
{

namespace
{
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = 3.14159265358979323846;

/// Fraction of a cell within which a crossing is the post itself. Rounding moves a crossing by
/// 1e-11 of a cell at 100 000 cells; moving it by this much changes the height by 1e-9 of a cell's
/// relief.
constexpr double snap = 1e-9;

/// The ray, mirrored so that it leads towards growing x (columns) and y (rows) from the receiver at
/// (0, 0): x = t·xPerMetre, y = t·yPerMetre.
class Ray
{
public:
    Ray(const DemTile& tile, int column, int row, double xPerMetre, double yPerMetre, bool west,
        bool south)
        : _xPerMetre(xPerMetre), _yPerMetre(yPerMetre),
          _xEnd(west ? column : tile.width() - 1 - column),
          _yEnd(south ? row : tile.height() - 1 - row), _xStride(west ? -1 : 1),
          _yStride(south ? -tile.width() : tile.width())
    {
        const std::ptrdiff_t here = std::ptrdiff_t(row) * tile.width() + column;
        _heights = tile.heights().data() + here;
        _valid = tile.validity().data() + here;
        _origin = height(0);
    }

    /// Slopes are per metre of t.
    Horizon scan(const HorizonOptions& options)
    {
        const double highest = options.highest - _origin;
        const double yPerColumn = _yPerMetre / _xPerMetre;
        const double xPerRow = _xPerMetre / _yPerMetre;
        // The next column and row to cross, and the place t of the last crossing.
        std::ptrdiff_t i = 1;
        std::ptrdiff_t j = 1;
        double last = 0.0;
        while (true)
        {
            // y where column i is crossed tells which of column i and row j comes first. A ray
            // along an axis never meets the other kind of line.
            const double y = _xPerMetre > 0.0 ? static_cast<double>(i) * yPerColumn : infinity;
            const double fromRow = y - static_cast<double>(j);
            const bool crossesColumn = fromRow < snap;
            const bool crossesRow = fromRow > -snap && _yPerMetre > 0.0;
            const double x =
                crossesColumn ? static_cast<double>(i) : static_cast<double>(j) * xPerRow;
            const double t = crossesColumn ? static_cast<double>(i) / _xPerMetre
                                           : static_cast<double>(j) / _yPerMetre;
            if (x > static_cast<double>(_xEnd) + snap ||
                (crossesRow ? j > _yEnd : y > static_cast<double>(_yEnd) + snap))
                return _best;

            if (options.insideCells && _xPerMetre > 0.0 && _yPerMetre > 0.0)
                testCell(i, j, last, t);
            if (crossesColumn && crossesRow)
                testCrossing(offset(i, j), offset(i, j), 0.0, t);
            else if (crossesColumn)
                testCrossing(offset(i, j - 1), offset(i, j), y - static_cast<double>(j - 1), t);
            else
                testCrossing(offset(i - 1, j), offset(i, j), x - static_cast<double>(i - 1), t);
            if (highest <= _best.slope * t)
                return _best;
            last = t;
            i += crossesColumn;
            j += crossesRow;
        }
    }

private:
    std::ptrdiff_t offset(std::ptrdiff_t i, std::ptrdiff_t j) const
    {
        return i * _xStride + j * _yStride;
    }

    double height(std::ptrdiff_t at) const { return double(_heights[at]); }

    void offer(double slope, double t)
    {
        if (slope > _best.slope)
        {
            _best.slope = slope;
            _best.distance = t;
        }
    }

    /// A point at `part` (0 … 1) of the way from post a to post b. One that is not needed is not
    /// read: it may lie outside the tile.
    void testCrossing(std::ptrdiff_t a, std::ptrdiff_t b, double part, double t)
    {
        if (part > 1.0 - snap)
            a = b;
        else if (part < snap)
            b = a;
        if (!_valid[a] || !_valid[b])
            return;
        const double za = height(a);
        const double zb = height(b);
        offer((za + part * (zb - za) - _origin) / t, t);
    }

    /// The maximum inside the cell below column i and row j, which the ray is in from t0 to t1.
    /// There the height is z = a + b·t + c·t² above the receiver, so the slope a/t + b + c·t has
    /// its maximum b − 2·√(a·c) at t = √(a/c), where a and c are negative. In the receiver's own
    /// cell a is 0, and the slope tends to b at the receiver.
    void testCell(std::ptrdiff_t i, std::ptrdiff_t j, double t0, double t1)
    {
        if (i > _xEnd || j > _yEnd)
            return;
        const std::ptrdiff_t p00 = offset(i - 1, j - 1);
        const std::ptrdiff_t p10 = p00 + _xStride;
        const std::ptrdiff_t p01 = p00 + _yStride;
        const std::ptrdiff_t p11 = p01 + _xStride;
        if (!(_valid[p00] & _valid[p10] & _valid[p01] & _valid[p11]))
            return;
        // Height in the cell: z00 + zx·u + zy·v + zxy·u·v, u = x − (i − 1), v = y − (j − 1).
        const double z00 = height(p00);
        const double zx = height(p10) - z00;
        const double zy = height(p01) - z00;
        const double zxy = height(p11) - z00 - zx - zy;
        const double x0 = static_cast<double>(i - 1);
        const double y0 = static_cast<double>(j - 1);
        if (i == 1 && j == 1)
            offer(zx * _xPerMetre + zy * _yPerMetre, 0.0);
        const double c = zxy * _xPerMetre * _yPerMetre;
        if (!(c < 0.0))
            return;
        const double a = z00 - _origin - zx * x0 - zy * y0 + zxy * x0 * y0;
        // t0² < a/c < t1², without a division.
        if (!(a < c * t0 * t0 && a > c * t1 * t1))
            return;
        const double b =
            zx * _xPerMetre + zy * _yPerMetre - zxy * (x0 * _yPerMetre + y0 * _xPerMetre);
        offer(b - 2.0 * std::sqrt(a * c), std::sqrt(a / c));
    }

    const double _xPerMetre;
    const double _yPerMetre;
    const std::ptrdiff_t _xEnd;
    const std::ptrdiff_t _yEnd;
    const std::ptrdiff_t _xStride;
    const std::ptrdiff_t _yStride;
    const float* _heights = nullptr;
    const std::uint8_t* _valid = nullptr;
    double _origin = 0.0;
    Horizon _best;
};
} // namespace

double Horizon::elevationDegrees() const
{
    return std::atan(slope) * 180.0 / pi;
}

Horizon exhaustiveHorizon(const DemTile& tile, int column, int row, const MapDirection& direction,
                          const HorizonOptions& options)
{
    if (!tile.isValid(column, row))
        return {};
    const double length = std::hypot(direction.east, direction.north);
    const double east = direction.east / length;
    const double north = direction.north / length;
    const double eastStep = tile.nominalEastSpacing();
    Ray ray(tile, column, row, std::abs(east) / eastStep, std::abs(north) / tile.northSpacing,
            east < 0.0, north < 0.0);
    // t is metres on the nominal grid; true metres differ by one ratio for the whole ray.
    const double ratio = std::hypot(east * tile.eastSpacing(row) / eastStep, north);
    Horizon horizon = ray.scan(options);
    horizon.slope /= ratio;
    horizon.distance *= ratio;
    return horizon;
}

double highestPost(const DemTile& tile)
{
    double highest = -infinity;
    for (std::size_t i = 0; i < tile.postCount(); ++i)
        if (tile.validity()[i])
            highest = std::max(highest, double(tile.heights()[i]));
    return highest;
}

} // namespace osgTerrainLight::reference
