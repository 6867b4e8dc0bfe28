#include <osgTerrainLight/Environment.h>

#include "core/EnvironmentSun.h"
#include "core/Quadrature.h"
#include "glsl_host.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr int maxColumns = 16384;
constexpr int maxRows = 8192;
/// Sums over the sphere stay finite in float.
constexpr float maxRadiance = 1e30f;

std::string complaintOf(int columns, int rows, const std::vector<Rgb>& radiance)
{
    const std::string size = std::to_string(columns) + " x " + std::to_string(rows) + " texels";
    if (columns < 1 || rows < 1 || columns > maxColumns || rows > maxRows)
        return size + ": needs 1 x 1 to " + std::to_string(maxColumns) + " x " +
               std::to_string(maxRows);
    if (radiance.size() != static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows))
        return size + ", " + std::to_string(radiance.size()) + " values: needs one per texel";
    for (const Rgb& texel : radiance)
        if (!std::all_of(texel.begin(), texel.end(),
                         [](float value) { return value >= 0.0f && value <= maxRadiance; }))
            return "a radiance is negative, beyond 1e30 or no number: needs 0 to 1e30";
    return {};
}

/// Exact for texels of one radiance each: over a row by azimuth in closed form, then by quadrature
/// in z, of which a basis function is a polynomial times √(1 − z²).
std::vector<Rgb> project(const Environment& picture)
{
    constexpr double pi = 3.14159265358979323846;
    const GaussRule& rule = gaussRule();
    const double width = 2.0 * pi / picture.columns;
    std::array<std::array<double, 3>, 16> sum = {};
    for (int row = 0; row < picture.rows; ++row)
    {
        // [m]: ∫ L cos mφ dφ; [−m]: with the sine.
        std::array<std::array<double, 3>, 7> turns = {};
        for (int column = 0; column < picture.columns; ++column)
            for (int m = -3; m <= 3; ++m)
            {
                const double middle = std::abs(m) * width * (column + 0.5);
                const double half = 0.5 * std::abs(m) * width;
                const double weight = width * (m < 0 ? std::sin(middle) : std::cos(middle)) *
                                      (m == 0 ? 1.0 : std::sin(half) / half);
                const Rgb& texel = picture.at(column, row);
                for (std::size_t c = 0; c < 3; ++c)
                    turns[static_cast<std::size_t>(m + 3)][c] +=
                        weight * static_cast<double>(texel[c]);
            }
        const double bottom = -std::cos(pi * row / picture.rows);
        const double top = -std::cos(pi * (row + 1) / picture.rows);
        for (std::size_t node = 0; node < rule.places.size(); ++node)
        {
            const double z = bottom + (top - bottom) * rule.places[node];
            const double weight = (top - bottom) * rule.weights[node];
            // At φ = 0 those of m ≥ 0 stand alone, and −m has the same factor in z.
            const auto basis = Glsl<double>().shBasis({std::sqrt(1.0 - z * z), 0.0, z});
            for (int l = 0; l < 4; ++l)
                for (int m = -l; m <= l; ++m)
                {
                    const int even = l * (l + 1) + std::abs(m);
                    const double factor = basis.c[even / 4][even % 4];
                    for (std::size_t c = 0; c < 3; ++c)
                        sum[static_cast<std::size_t>(l * (l + 1) + m)][c] +=
                            weight * factor * turns[static_cast<std::size_t>(m + 3)][c];
                }
        }
    }
    std::vector<Rgb> harmonics(16);
    for (std::size_t i = 0; i < 16; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            harmonics[i][c] = static_cast<float>(sum[i][c]);
    return harmonics;
}
} // namespace

std::shared_ptr<const Environment>
createEnvironment(int columns, int rows, std::vector<Rgb> radiance, std::string& problem)
{
    problem = complaintOf(columns, rows, radiance);
    if (!problem.empty())
        return nullptr;
    auto made = std::make_shared<Environment>();
    made->columns = columns;
    made->rows = rows;
    made->radiance = std::move(radiance);
    takeSun(*made);
    made->harmonics = project(*made);
    return made;
}

} // namespace osgTerrainLight
