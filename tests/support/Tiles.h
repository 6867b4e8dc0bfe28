#pragma once

#include "lighting/TileLight.h"
#include "lighting/TileWindows.h"

#include <osgTerrainLight/DemTile.h>

#include <functional>
#include <vector>

/// One terrain lit in one piece, and as tiles side by side with windows around them.
namespace osgTerrainLight::testing
{

struct TileCase
{
    LightingSettings settings;
    SkyLight sky;
    bool farLight = true; ///< tiles take bounced light from coarser levels, too
};

/// Some values per post of a tile that is lit, in tile order.
using ReadTile = std::function<std::vector<float>(osg::State&, TileLight&)>;

/// Horizons [degrees], those below 0 as 0; rgb of shading; all bounces together, green; visible
/// fraction of the sun; sky-view factor.
std::vector<float> horizonsOf(osg::State& state, TileLight& light);
std::vector<float> shadingOf(osg::State& state, TileLight& light);
std::vector<float> bouncedOf(osg::State& state, TileLight& light);
std::vector<float> sunOf(osg::State& state, TileLight& light);
std::vector<float> skyViewOf(osg::State& state, TileLight& light);

/// Lit by a uniform sky, and by a sun in the west-south-west besides.
TileCase underSky(int azimuths, HorizonQuality quality = HorizonQuality::Normal);
TileCase inTheAfternoon(int azimuths, int bounces);

std::vector<float> inOnePiece(osg::State& state, const DemTile& tile, const TileCase& lit,
                              const ReadTile& read);
/// side × side tiles; the values of all, as of one tile.
std::vector<float> inTiles(osg::State& state, const DemTile& tile, const TileCase& lit, int side,
                           const ReadTile& read);

struct Differences
{
    double median = 0.0, mean = 0.0, p99 = 0.0, worst = 0.0;
};
Differences differencesOf(const std::vector<float>& a, const std::vector<float>& b);
/// Of b from a, over the root of the mean square of a [%].
double relativeRms(const std::vector<float>& a, const std::vector<float>& b);

/// Of horizonsOf() a whole tile with 32 azimuths, from the exhaustive reference in double, those
/// below 0 as 0, at 500 posts without voids [degrees].
Differences errorsOf(const DemTile& tile, const std::vector<float>& horizons);

/// What a terrain's light in tiles differs in from its light in one piece.
struct LightDifferences
{
    Differences shading;
    double bounced = 0.0; ///< relativeRms() of bounced light [%]; 0 without bounces
};
LightDifferences lightDifferences(osg::State& state, const DemTile& tile, const TileCase& lit,
                                  int side);

/// Mean jump of a value per post across the seams between side × side tiles, over that one column
/// or row inside of them.
double seamRatio(const std::vector<float>& values, int width, int height, int side);

} // namespace osgTerrainLight::testing
