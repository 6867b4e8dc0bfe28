#pragma once

#include "fields/TriangleMesh.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

/// Bodies whose surface is a formula, as triangles: for forms that are sampled.
namespace osgTerrainLight::bodies
{

constexpr double pi = 3.14159265358979323846;

/// A sum of waves over space, about -1 ... 1. A phase shifts them: the form of another frame.
inline double waves(const glm::dvec3& at, double phase)
{
    constexpr double ways[5][4] = {{0.8, -0.4, 0.45, 2.0},
                                   {-0.3, 0.9, 0.3, 3.0},
                                   {0.5, 0.5, -0.7, 4.0},
                                   {-0.7, -0.2, -0.68, 5.0},
                                   {0.1, -0.6, 0.8, 6.0}};
    double sum = 0.0;
    for (const auto& way : ways)
        sum += std::sin(way[3] * glm::dot(glm::dvec3(way[0], way[1], way[2]), at) +
                        phase * (0.5 + 0.3 * way[3]));
    return sum / 1.6;
}

/// Radius [m] of a star-shaped body about its origin. amplitude: of its waves, over its mean.
struct Blob
{
    double amplitude = 0.25, phase = 0.0, mean = 2.5;

    double radius(const glm::dvec3& direction) const
    {
        return mean * std::max(1.0 + amplitude * waves(direction, phase), 0.15);
    }
    /// Rows from the south pole, and twice as many columns.
    TriangleMesh mesh(int rows = 48) const
    {
        const auto turned = [rows](int row, int column)
        {
            const double polar = pi * row / rows, turn = pi * column / rows;
            return glm::dvec3(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                              -std::cos(polar));
        };
        TriangleMesh mesh;
        const auto at = [&](int row, int column)
        { return std::uint32_t(row * 2 * rows + column % (2 * rows)); };
        for (int row = 0; row <= rows; ++row)
            for (int column = 0; column < 2 * rows; ++column)
            {
                const glm::dvec3 direction =
                    turned(row, row == 0 || row == rows ? 0 : column); // a pole is one place
                mesh.vertices.emplace_back(direction * radius(direction));
            }
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < 2 * rows; ++column)
            {
                if (row > 0)
                    mesh.triangles.push_back(
                        {at(row, column), at(row, column + 1), at(row + 1, column + 1)});
                if (row + 1 < rows)
                    mesh.triangles.push_back(
                        {at(row, column), at(row + 1, column + 1), at(row + 1, column)});
            }
        return mesh;
    }
};

/// Solid from z = bottom() to top() over a round (or, where isSquare, square) place.
struct Mound
{
    double height = 2.0, phase = 0.0, size = 4.0; ///< [m]; size: half the side
    bool isRock = false;                          ///< with a bottom that is rough, too

    /// 1 in the middle, 0 at the edge: both surfaces meet there.
    double edge(double x, double y) const
    {
        const double across = std::min(std::hypot(x, y) / size, 1.0);
        return 1.0 - across * across;
    }
    double top(double x, double y) const
    {
        const double form = 0.7 + 0.5 * waves({0.5 * x, 0.5 * y, 0.0}, phase);
        return height * edge(x, y) * std::max(form, 0.1);
    }
    double bottom(double x, double y) const
    {
        if (!isRock)
            return 0.0;
        const double form = 0.6 + 0.4 * waves({0.6 * x, 0.6 * y, 2.0}, -phase);
        return -0.8 * height * edge(x, y) * std::max(form, 0.1);
    }
    /// Rings, of which the outermost is the edge.
    TriangleMesh mesh(int rings = 64) const
    {
        TriangleMesh mesh;
        const int columns = 3 * rings;
        for (const bool isTop : {true, false})
        {
            const auto first = std::uint32_t(mesh.vertices.size());
            for (int ring = 0; ring <= rings; ++ring)
                for (int column = 0; column < columns; ++column)
                {
                    const double turn = 2.0 * pi * column / columns;
                    const double x = size * ring / rings * std::cos(turn);
                    const double y = size * ring / rings * std::sin(turn);
                    mesh.vertices.emplace_back(x, y, isTop ? top(x, y) : bottom(x, y));
                }
            const auto at = [&](int ring, int column)
            { return first + std::uint32_t(ring * columns + column % columns); };
            for (int ring = 0; ring < rings; ++ring)
                for (int column = 0; column < columns; ++column)
                {
                    std::uint32_t a = at(ring, column), b = at(ring + 1, column);
                    std::uint32_t c = at(ring + 1, column + 1), d = at(ring, column + 1);
                    if (!isTop)
                        std::swap(b, d);
                    if (ring > 0 || isTop)
                        mesh.triangles.push_back({a, b, c});
                    if (ring > 0 || !isTop)
                        mesh.triangles.push_back({a, c, d});
                }
        }
        return mesh;
    }
};

} // namespace osgTerrainLight::bodies
