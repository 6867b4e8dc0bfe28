// The table of docs/methods/tiles.md: terrains as tiles against the same in one piece. Usage:
// tile_table [TERRAIN...], by default all; minutes for each. Real terrain is taken as on a
// projected map, with rows of equal spacing, since in degrees tiles and one piece differ in their
// azimuths.
#include "support/HardGround.h"
#include "support/Horizons.h"
#include "support/Tiles.h"

#include "core/SyntheticTerrain.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{
constexpr int side = 1025;

std::optional<DemTile> terrainOf(const std::string& name)
{
    if (name == "town")
        return hard::town(side, 77);
    if (name == "mine")
        return hard::mine(side, 77);
    if (name == "dunes")
        return hard::dunes(side, 77);
    if (name == "sinkholes")
        return hard::sinkholes(side, 77);
    TerrainKind kind = TerrainKind::Fractal;
    if (fromString(name, kind))
        return generateTerrain(kind, side, side, 30.0, 7).value();
    std::optional<DemTile> real = realDem(name + ".tif");
    if (real)
        real->eastSpacings = {real->nominalEastSpacing()};
    return real;
}

void printHorizons(osg::State& state, const DemTile& tile, HorizonQuality quality,
                   const std::vector<int>& sides)
{
    const TileCase lit = underSky(32, quality);
    const std::clock_t start = std::clock();
    const std::vector<float> whole = inOnePiece(state, tile, lit, horizonsOf);
    const std::clock_t alone = std::clock() - start;
    const Differences exactly = errorsOf(tile, whole);
    std::printf("  one piece, %-6s: from the reference [degrees]: mean %.4f p99 %.3f\n",
                toString(quality), exactly.mean, exactly.p99);
    for (const int tiles : sides)
    {
        const std::clock_t begun = std::clock();
        const std::vector<float> inAll = inTiles(state, tile, lit, tiles, horizonsOf);
        const Differences found = differencesOf(whole, inAll);
        const double time = static_cast<double>(std::clock() - begun) / static_cast<double>(alone);
        std::printf("  %2d tiles, %-6s: horizons [degrees]: median %.4f mean %.4f p99 %.3f worst "
                    "%.1f, CPU time %.2f\n",
                    tiles * tiles, toString(quality), found.median, found.mean, found.p99,
                    found.worst, time);
        const Differences errors = errorsOf(tile, inAll);
        std::printf("            from the reference [degrees]: mean %.4f p99 %.3f\n", errors.mean,
                    errors.p99);
        std::fflush(stdout);
    }
}

void printSkyView(osg::State& state, const DemTile& tile)
{
    const std::vector<float> whole = inOnePiece(state, tile, underSky(32), skyViewOf);
    for (const int tiles : {2, 4, 8})
    {
        const std::vector<float> found = inTiles(state, tile, underSky(32), tiles, skyViewOf);
        const Differences differences = differencesOf(whole, found);
        std::printf("  %2d tiles: sky view: mean %.6f p99 %.5f worst %.4f, seams %.4f\n",
                    tiles * tiles, differences.mean, differences.p99, differences.worst,
                    seamRatio(found, tile.width(), tile.height(), tiles) /
                        seamRatio(whole, tile.width(), tile.height(), tiles));
        std::fflush(stdout);
    }
}

void printLight(osg::State& state, const DemTile& tile, int bounces)
{
    TileCase lit = inTheAfternoon(16, bounces);
    const LightDifferences found = lightDifferences(state, tile, lit, 4);
    std::printf("  16 tiles, %d bounces: shading: mean %.5f p99 %.5f worst %.3f", bounces,
                found.shading.mean, found.shading.p99, found.shading.worst);
    if (bounces > 0)
    {
        lit.farLight = false;
        const LightDifferences near = lightDifferences(state, tile, lit, 4);
        std::printf("; bounced light: %.2f %%, without that of coarser levels %.2f %%, shading "
                    "p99 %.5f",
                    found.bounced, near.bounced, near.shading.p99);
    }
    std::printf("\n");
    std::fflush(stdout);
}
} // namespace

int main(int argc, char** argv)
{
    std::vector<std::string> names(argv + 1, argv + argc);
    if (names.empty())
        names = {"fractal", "cliffs", "mt_rainier_90m", "halfdome_1s",
                 "town",    "mine",   "dunes",          "sinkholes"};
    std::string problem;
    const auto context = HeadlessContext::create(16, 16, problem);
    if (!context)
    {
        std::fprintf(stderr, "tile_table: %s\n", problem.c_str());
        return 1;
    }
    for (const std::string& name : names)
    {
        const std::optional<DemTile> tile = terrainOf(name);
        if (!tile)
        {
            std::fprintf(stderr, "tile_table: no terrain \"%s\", and no such file in data/dem\n",
                         name.c_str());
            return 1;
        }
        std::printf("%s, %d x %d posts\n", name.c_str(), tile->width(), tile->height());
        printHorizons(context->state(), *tile, HorizonQuality::Normal, {1, 2, 4, 8});
        printHorizons(context->state(), *tile, HorizonQuality::Best, {4});
        printSkyView(context->state(), *tile);
        for (const int bounces : {0, 1, 3})
            printLight(context->state(), *tile, bounces);
    }
    return 0;
}
