#include "io/CubeFaces.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;

using Vector = std::array<double, 3>;
struct Point
{
    double x, y;
};

/// A face of the cube, seen from inside: axes of the file, y up.
struct Face
{
    Vector forward, right, down;
};

/// From the top of the picture down (ImfEnvmap.h).
constexpr std::array<Face, 6> faces = {{
    {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}},
    {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}},
}};

double dot(const Vector& a, const Vector& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Convex; a quadrangle gains one corner at most by each of four cuts. Rounding may find more in a
/// sliver without area, which may lose them.
struct Polygon
{
    std::array<Point, 10> corners = {};
    std::size_t count = 0;

    void add(const Point& corner)
    {
        if (count < corners.size())
            corners[count++] = corner;
    }
    const Point& after(std::size_t i) const { return corners[i + 1 < count ? i + 1 : 0]; }
};

/// The part where side · (coordinate − edge) ≥ 0.
Polygon clipped(const Polygon& polygon, double Point::*axis, double edge, double side)
{
    Polygon result;
    for (std::size_t i = 0; i < polygon.count; ++i)
    {
        const Point& a = polygon.corners[i];
        const Point& b = polygon.after(i);
        const double before = side * (a.*axis - edge);
        const double after = side * (b.*axis - edge);
        if (before >= 0.0)
            result.add(a);
        if ((before < 0.0) == (after < 0.0))
            continue;
        const double t = before / (before - after);
        result.add({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
    return result;
}

/// Of a convex polygon on a face, in texels: triangles about its first corner (Van Oosterom and
/// Strackee 1983, Eq. 8).
double solidAngle(const Polygon& polygon, int side)
{
    const auto place = [&](const Point& p) {
        return Vector{2.0 * p.x / side - 1.0, 2.0 * p.y / side - 1.0, 1.0};
    };
    const Vector a = place(polygon.corners[0]);
    const double lengthA = std::sqrt(dot(a, a));
    double sum = 0.0;
    for (std::size_t i = 2; i < polygon.count; ++i)
    {
        const Vector b = place(polygon.corners[i - 1]);
        const Vector c = place(polygon.corners[i]);
        const double lengthB = std::sqrt(dot(b, b));
        const double lengthC = std::sqrt(dot(c, c));
        // All three at depth 1: the triple product is twice the plane's area.
        const double volume = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        sum += 2.0 * std::atan2(volume, lengthA * lengthB * lengthC + dot(a, b) * lengthC +
                                            dot(a, c) * lengthB + dot(b, c) * lengthA);
    }
    return std::abs(sum);
}
} // namespace

/// Each texel is a quadrangle of great circles (of a parallel's arc, its chord), which are straight
/// lines on the cube's faces; the texels there are cut by it, so the mean is exact. The chords are
/// the same for texels below and above.
EnvironmentPicture fromCube(const Picture& cube)
{
    const int side = cube.width;
    EnvironmentPicture result;
    // No texel that meets a face reaches behind its plane.
    result.rows = std::max(2 * side, 32);
    result.columns = 2 * result.rows;
    result.radiance.resize(static_cast<std::size_t>(result.columns) *
                           static_cast<std::size_t>(result.rows));
    Polygon quad;
    quad.count = 4;
    for (int row = 0; row < result.rows; ++row)
        for (int column = 0; column < result.columns; ++column)
        {
            std::array<Vector, 4> corners;
            for (int i = 0; i < 4; ++i)
            {
                const double elevation = pi * (row + (i < 2 ? 0 : 1)) / result.rows - 0.5 * pi;
                const double azimuth =
                    2.0 * pi * (column + (i == 1 || i == 2 ? 1 : 0)) / result.columns;
                // East is the file's -x, north its z, up its y.
                corners[static_cast<std::size_t>(i)] = {-std::cos(elevation) * std::cos(azimuth),
                                                        std::sin(elevation),
                                                        std::cos(elevation) * std::sin(azimuth)};
            }
            Vector sum = {};
            double weights = 0.0;
            for (std::size_t f = 0; f < faces.size(); ++f)
            {
                const Face& face = faces[f];
                Point low = {double(side), double(side)}, high = {0.0, 0.0};
                bool isBefore = true;
                for (std::size_t i = 0; isBefore && i < 4; ++i)
                {
                    const double depth = dot(corners[i], face.forward);
                    isBefore = depth > 0.2;
                    Point& corner = quad.corners[i];
                    corner = {0.5 * side * (1.0 + dot(corners[i], face.right) / depth),
                              0.5 * side * (1.0 + dot(corners[i], face.down) / depth)};
                    low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
                    high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
                }
                if (!isBefore)
                    continue;
                const auto from = [](double place)
                { return std::max(static_cast<int>(std::floor(place)), 0); };
                const auto to = [&](double place)
                { return std::min(static_cast<int>(std::ceil(place)), side); };
                for (int y = from(low.y); y < to(high.y); ++y)
                {
                    const Polygon strip =
                        clipped(clipped(quad, &Point::y, y, 1.0), &Point::y, y + 1.0, -1.0);
                    for (int x = from(low.x); strip.count > 2 && x < to(high.x); ++x)
                    {
                        const Polygon piece =
                            clipped(clipped(strip, &Point::x, x, 1.0), &Point::x, x + 1.0, -1.0);
                        if (piece.count < 3)
                            continue;
                        const double weight = solidAngle(piece, side);
                        const Rgb& pixel = cube.at(x, static_cast<int>(f) * side + y);
                        for (std::size_t c = 0; c < 3; ++c)
                            sum[c] += weight * static_cast<double>(pixel[c]);
                        weights += weight;
                    }
                }
            }
            Rgb& texel = result.radiance[static_cast<std::size_t>(row) *
                                             static_cast<std::size_t>(result.columns) +
                                         static_cast<std::size_t>(column)];
            for (std::size_t c = 0; c < 3; ++c)
                texel[c] = static_cast<float>(sum[c] / weights);
        }
    return result;
}

} // namespace osgTerrainLight
