#pragma once

#include "core/PostRect.h"
#include "core/Result.h"
#include "core/TileSource.h"
#include "io/HeightRules.h"

#include <cpl_vsi.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Heights of one level in a LevelFile.
struct LevelPlane
{
    int level = 0;
    PostRect posts;
    bool hasCrests = true; ///< two heights a post, by CrestAxis; else one, of the post itself
};

/// What stands in a LevelFile beside its heights.
struct LevelFacts
{
    std::string stamp; ///< of what it was made from, one line
    std::vector<LevelPlane> planes;
    HeightRules rules;
    double lowest = 0.0, highest = 0.0; ///< of the raster's heights [m]
    std::vector<std::string> notes;     ///< one line each
};

/// Of a text, to tell whether another one is the same.
std::uint64_t checksumOf(const std::string& text);

/// Coarse levels of a raster in a file, for reading in small rectangles: rows of float heights in
/// this machine's byte order, south first, plane after plane, and the facts as text behind them.
/// The head, written last, has the text's place and checksum, so that a file that is not whole is
/// known as such. Heights themselves have no checksum.
class LevelFile
{
public:
    ~LevelFile();
    LevelFile(const LevelFile&) = delete;
    LevelFile& operator=(const LevelFile&) = delete;

    /// Errors: NotFound; Invalid where the file is no such file, of another version or damaged.
    static Result<std::unique_ptr<LevelFile>> open(const std::string& path);

    const LevelFacts& facts() const { return _facts; }
    /// Null where the file does not have it.
    const LevelPlane* plane(int level) const;
    /// Posts of a level; NaN beyond its plane. axis counts where the plane has crests.
    Result<Raster<float>> read(int level, CrestAxis axis, const PostRect& posts);

private:
    LevelFile() = default;

    std::string _path;
    VSILFILE* _file = nullptr;
    LevelFacts _facts;
};

/// Writes a LevelFile row by row, in any order. Errors give GDAL's reason only.
class LevelFileWriter
{
public:
    ~LevelFileWriter();
    LevelFileWriter() = default;
    LevelFileWriter(const LevelFileWriter&) = delete;
    LevelFileWriter& operator=(const LevelFileWriter&) = delete;

    /// Bytes of a file with these planes, without the text.
    static double bytes(const std::vector<LevelPlane>& planes);

    bool create(const std::string& path, std::vector<LevelPlane> planes);
    /// row: of the plane, from its south. heights: as many as it has columns. Rows that are not
    /// written hold zeros.
    bool writeRow(int level, CrestAxis axis, int row, const float* heights);
    /// facts: the planes are those of create(). Closes the file.
    bool finish(LevelFacts facts);
    /// Whether one of these was false.
    bool failed() const { return _failed; }

private:
    bool keep(bool written);

    std::vector<LevelPlane> _planes;
    VSILFILE* _file = nullptr;
    bool _failed = false;
};

} // namespace osgTerrainLight
