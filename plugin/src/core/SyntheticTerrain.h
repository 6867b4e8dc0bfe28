#pragma once

#include "core/Result.h"

#include <osgTerrainLight/DemTile.h>

#include <cstdint>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Kinds of generated terrain, for tests, benchmarks and trials without a DEM.
enum class TerrainKind
{
    Fractal, ///< mountains: self-affine, median slope about 22°
    Crater,  ///< one smooth crater with a rim on gently tilted ground
    Cliffs,  ///< fractal terraces with steep cliffs, one-post walls and one-post spikes
    Spikes   ///< a plain with one-post spikes and pits
};

/// "fractal", "crater", "cliffs", "spikes".
const char* toString(TerrainKind kind);
/// False where the text names no kind; kind is then unchanged.
bool fromString(const std::string& text, TerrainKind& kind);
const std::vector<TerrainKind>& allTerrainKinds();

/// A terrain of width × height posts (each ≥ 1, at most 2^30 posts) without voids, with square
/// cells of `spacing` metres, 0.001 … 10 000. Heights are proportional to the spacing, so slopes do
/// not depend on it. The same arguments give the same bits on every machine with IEEE arithmetic:
/// only integer hashes and + − × ÷ √ are used. But for Crater, which fills the tile, a post's
/// height depends on its column, its row and the seed alone, so a small tile is a corner of a large
/// one.
Result<DemTile> generateTerrain(TerrainKind kind, int width, int height, double spacing,
                                std::uint32_t seed);

} // namespace osgTerrainLight
