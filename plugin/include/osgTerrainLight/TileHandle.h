#pragma once

#include <cstdint>
#include <string>
#include <tuple>

namespace osgTerrainLight
{

/// Names a tile of a TerrainLighting: by level, x and y where the tile has them, else by a number
/// that the lighting gives. A number is never given to a second tile. Plain and comparable.
struct TileHandle
{
    int level = -1; ///< as in osgTerrain::TileID; −1: the tile is named by number
    int x = 0, y = 0;
    std::uint64_t number = 0; ///< 0 at level −1: names no tile

    static TileHandle at(int level, int x, int y)
    {
        TileHandle handle;
        handle.level = level;
        handle.x = x;
        handle.y = y;
        return handle;
    }

    /// Whether it names a tile, of which the lighting need not know.
    bool valid() const { return level >= 0 || number != 0; }
    explicit operator bool() const { return valid(); }
};

inline bool operator<(const TileHandle& a, const TileHandle& b)
{
    return std::tie(a.level, a.x, a.y, a.number) < std::tie(b.level, b.x, b.y, b.number);
}
inline bool operator==(const TileHandle& a, const TileHandle& b)
{
    return std::tie(a.level, a.x, a.y, a.number) == std::tie(b.level, b.x, b.y, b.number);
}
inline bool operator!=(const TileHandle& a, const TileHandle& b)
{
    return !(a == b);
}

/// How far a tile has come.
struct TileState
{
    enum class Stage
    {
        Unknown, ///< the lighting has no such tile
        Waiting, ///< drawn unlit, until its turn comes
        Lit,
        Failed ///< drawn unlit
    };
    Stage stage = Stage::Unknown;
    std::string reason; ///< why it failed; else empty
};

} // namespace osgTerrainLight
