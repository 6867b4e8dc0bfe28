#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/HorizonMap.h>

#include "core/AzimuthSet.h"
#include "core/PostRect.h"
#include "core/Raster.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace osgTerrainLight
{

/// Heights that changed: an edit, or an arrival or a departure of terrain.
struct TerrainEdit
{
    /// All posts whose height or validity changed, in posts of the level of the tiles that are
    /// asked about.
    PostRect posts;
    /// tops[k]: the highest valid post, before or after the change, at most 2^(k+1) posts beyond
    /// `posts` [m above the tiles' heightOrigin]; −∞ where all are void. It is what level k
    /// interpolates between around the change. Levels beyond have the last one. Not empty.
    std::vector<double> tops = {-std::numeric_limits<double>::infinity()};

    double top(int level) const;

    /// The same change in posts that are 2^levels times as far apart.
    TerrainEdit coarsened(int levels) const;
};

/// The change of `changed` from heights of the posts of `area`, NaN where void. The area contains
/// `changed`, and should reach beyond it as far as coarse levels mix heights: 4 of their cells.
TerrainEdit terrainEdit(const PostRect& changed, const PostRect& area, const Raster<float>& before,
                        const Raster<float>& after);

/// How a tile sees what surrounds it (WindowScheme), and what changes it in any case.
struct ReachScheme
{
    int ring = 128;   ///< around the tile, of its own level [posts], ≥ 1
    int farRing = 64; ///< that each coarser level adds [posts of it], ≥ 4
    /// An edit this near to the tile changes it whatever its height [posts], ≥ 1. By default the
    /// ring, where a bounce sees ground that no horizon tells of.
    int always = 128;
    /// Radius of the planet [m]; 0: flat ground.
    double bodyRadius = 0.0;
};

/// Which changes of terrain can change the horizons of a tile, by a bound that takes 36 bytes per
/// azimuth.
///
/// A point of terrain at distance d matters to a post of height z only if it rises above the
/// post's horizon h, or is that horizon: from the height z + d·tan h on. Per azimuth the tile keeps
/// the minimum of that height over its posts, for 9 distances from its middle that double, the
/// first where the tile ends. The minimum is concave, so chords between the 9 are below it. An edit
/// outside reach changes no horizon, of those above the horizontal, by more than 0.01°, seen from
/// the state the tile was lit in: edits that it was not lit again for do not add up.
class Reach
{
public:
    /// What no horizon changes by, out of reach [degrees].
    static constexpr double tolerance = 0.01;

    Reach() = default; ///< of a void tile of no posts
    /// place: of the tile in the whole terrain. horizons: of the same posts, to all that surrounds
    /// the tile.
    Reach(const DemTile& tile, const PostRect& place, const HorizonMap& horizons,
          const ReachScheme& scheme = {});

    /// Whether the tile must be lit again. Always where the edit is in the tile; never elsewhere
    /// where the tile is wholly void.
    bool isReached(const TerrainEdit& edit) const;

    std::size_t bytes() const;

private:
    static constexpr int distanceCount = 9;

    double extent(const MapDirection& direction) const;
    double firstDistance(const MapDirection& direction) const;
    double bound(int azimuth, double distances) const;
    int levelOf(const PostRect& posts) const;

    PostRect _place;
    ReachScheme _scheme;
    int _azimuthCount = 0;      ///< 0: wholly void
    double _lowest = 0.0;       ///< valid post [m above heightOrigin]
    double _eastSpacing = 0.0;  ///< that azimuths are laid out with [m]
    double _northSpacing = 0.0; ///< [m]
    double _leastRatio = 1.0;   ///< of a row's east spacing to that one, at most 1
    std::vector<float> _above;  ///< by azimuth, then distance [m above _lowest], rounded down
};

} // namespace osgTerrainLight
