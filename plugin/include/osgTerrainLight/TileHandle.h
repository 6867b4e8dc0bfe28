#pragma once

#include <cstdint>
#include <string>
#include <tuple>

namespace osgTerrainLight
{

/// The name of a tile of a TerrainLighting: level, x and y where the tile has them, else a number
/// that the lighting gives. The lighting never gives a number to a second tile. Handles can be
/// copied and compared.
struct TileHandle
{
    int level = -1; ///< As in osgTerrain::TileID; −1 where the tile is named by a number.
    int x = 0, y = 0;
    std::uint64_t number = 0; ///< At level −1; 0 names no tile.

    static TileHandle at(int level, int x, int y)
    {
        TileHandle handle;
        handle.level = level;
        handle.x = x;
        handle.y = y;
        return handle;
    }

    /// Whether it is a name at all. The lighting need not have a tile of this name.
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

/// Whether a tile is lit, and why not.
struct TileState
{
    enum class Stage
    {
        Unknown, ///< The lighting has no such tile.
        Waiting, ///< Until its turn comes it is drawn unlit, or with former light.
        Lit,
        Failed ///< It is drawn unlit.
    };
    Stage stage = Stage::Unknown;
    std::string reason; ///< Says why it has failed; else empty.
};

} // namespace osgTerrainLight
