#include "fields/Signs.h"

#include "fields/Slices.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

namespace
{
/// What is known of a voxel. Outside, Inside and Mirrored are plain: the winding number is near 0,
/// at least nearly 1, at most nearly -1.
enum class Kind : std::uint8_t
{
    Far, ///< not known yet
    Outside,
    Inside,
    Mirrored,
    AmbiguousOutside,
    AmbiguousInside
};

bool isInside(Kind kind)
{
    return kind == Kind::Inside || kind == Kind::Mirrored || kind == Kind::AmbiguousInside;
}

bool isAmbiguous(Kind kind)
{
    return kind == Kind::AmbiguousOutside || kind == Kind::AmbiguousInside;
}

Kind kindOf(double winding)
{
    // Between whole numbers lies what has no plain answer. Next to closed parts the groups of
    // triangles err by about 0.01, and whole triangles by rounding.
    constexpr double plain = 0.2;
    if (std::abs(winding - std::round(winding)) > plain)
        return std::abs(winding) > 0.5 ? Kind::AmbiguousInside : Kind::AmbiguousOutside;
    return winding > 0.5 ? Kind::Inside : winding < -0.5 ? Kind::Mirrored : Kind::Outside;
}

class Signing
{
public:
    Signing(DistanceGrid& grid, const WindingNumber& winding, const glm::dvec3& low,
            const glm::dvec3& high)
        : _grid(grid), _winding(winding), _low(low), _high(high),
          _kinds(grid.distances.size(), Kind::Far)
    {
    }

    std::optional<SigningReport> run(const std::function<bool(double)>& progress)
    {
        // The second half of the work is none where all is closed.
        if (!forEachSlice(
                _grid.size.z, [this](int z) { signNear(z); },
                [&](double share) { return !progress || progress(0.5 * share); }))
            return std::nullopt;
        fill();
        if (!forEachSlice(
                _grid.size.z, [this](int z) { signFar(z); },
                [&](double share) { return !progress || progress(0.5 + 0.5 * share); }))
            return std::nullopt;
        return SigningReport{_near, _ambiguous, _computed};
    }

private:
    Kind compute(int x, int y, int z)
    {
        ++_computed;
        return kindOf(_winding.at(_grid.centre(x, y, z)));
    }

    /// What is beyond the box, and what is near the surface.
    void signNear(int z)
    {
        for (int y = 0; y < _grid.size.y; ++y)
            for (int x = 0; x < _grid.size.x; ++x)
            {
                Kind& kind = _kinds[_grid.indexOf(x, y, z)];
                const glm::dvec3 centre = _grid.centre(x, y, z);
                const bool beyond = glm::any(glm::lessThan(centre, _low)) ||
                                    glm::any(glm::greaterThan(centre, _high));
                if (beyond)
                    kind = Kind::Outside;
                else if (_grid.at(x, y, z) <= _grid.spacing)
                {
                    kind = compute(x, y, z);
                    // On the surface itself no sign is wrong.
                    if (_grid.at(x, y, z) > 1e-3f * _grid.spacing)
                    {
                        ++_near;
                        if (isAmbiguous(kind))
                            ++_ambiguous;
                    }
                }
            }
    }

    /// Gives each region of far voxels the kind of its border, where that has one plain kind. Two
    /// neighbours with a surface between them are at most a spacing away from it together, so no
    /// surface parts a far voxel from any neighbour.
    void fill()
    {
        std::vector<std::size_t> region;
        std::vector<std::uint8_t> seen(_kinds.size(), 0);
        const std::size_t along[3] = {1, static_cast<std::size_t>(_grid.size.x),
                                      static_cast<std::size_t>(_grid.size.x) *
                                          static_cast<std::size_t>(_grid.size.y)};
        for (std::size_t start = 0; start < _kinds.size(); ++start)
        {
            if (_kinds[start] != Kind::Far || seen[start])
                continue;
            region.assign(1, start);
            seen[start] = 1;
            Kind border = Kind::Far;
            bool hasOneKind = true;
            for (std::size_t i = 0; i < region.size(); ++i)
            {
                // No far voxel is at the grid's end, since the margin is beyond the box.
                for (const std::size_t step : along)
                    for (const std::size_t next : {region[i] - step, region[i] + step})
                        if (_kinds[next] != Kind::Far)
                        {
                            if (border == Kind::Far)
                                border = _kinds[next];
                            hasOneKind = hasOneKind && _kinds[next] == border;
                        }
                        else if (!seen[next])
                        {
                            seen[next] = 1;
                            region.push_back(next);
                        }
            }
            if (hasOneKind && !isAmbiguous(border))
                for (const std::size_t voxel : region)
                    _kinds[voxel] = border;
        }
    }

    void signFar(int z)
    {
        for (int y = 0; y < _grid.size.y; ++y)
            for (int x = 0; x < _grid.size.x; ++x)
            {
                const std::size_t voxel = _grid.indexOf(x, y, z);
                if (_kinds[voxel] == Kind::Far)
                    _kinds[voxel] = compute(x, y, z);
                if (isInside(_kinds[voxel]))
                    _grid.distances[voxel] = -_grid.distances[voxel];
            }
    }

    DistanceGrid& _grid;
    const WindingNumber& _winding;
    const glm::dvec3 _low, _high;
    std::vector<Kind> _kinds;
    std::atomic<std::size_t> _near{0}, _ambiguous{0}, _computed{0};
};
} // namespace

std::optional<SigningReport> giveSigns(DistanceGrid& grid, const WindingNumber& winding,
                                       const glm::dvec3& low, const glm::dvec3& high,
                                       const std::function<bool(double)>& progress)
{
    return Signing(grid, winding, low, high).run(progress);
}

} // namespace osgTerrainLight
