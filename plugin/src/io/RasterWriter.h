#pragma once

#include "core/Raster.h"
#include "core/Result.h"
#include "io/DemReader.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

struct BandLabel
{
    std::string description;
    std::string unit; ///< empty where the values have none
};

/// A band that is in memory as a whole: values in tile order (row 0 south), void is NaN.
struct RasterBand
{
    BandLabel label;
    Raster<float> values;
};

struct RasterWriteOptions
{
    /// GDAL's short name (-of); empty: by the path's extension as GDAL's own tools do, GTiff where
    /// it has none.
    std::string driver;
    /// NAME=VALUE (-co); one that the driver does not know is an error.
    std::vector<std::string> creationOptions;
    /// Dataset metadata, key and value.
    std::vector<std::pair<std::string, std::string>> metadata;
    /// False: an existing file is an error.
    bool overwrite = true;
    /// Where the file is written until it is complete, a folder of the target's file system; empty:
    /// a hidden one beside the target.
    std::string scratchFolder;
};

/// Writes Float32 bands, one at a time, so that a file may be larger than memory.
///
/// The pixels coincide with those of the raster that `frame` came from. Void is −9999 and declared
/// as the nodata value, since more programs honour it than NaN. Everything is written into a hidden
/// folder beside the target and moved over it by finish(): until then, and after any failure, the
/// target and its sidecar files are as they were. Drivers that can only copy (COG, AAIGrid) are fed
/// from memory, or from a scratch file in that folder beyond 256 MiB.
class RasterWriter
{
public:
    static constexpr float noData = -9999.0f;

    static Result<RasterWriter> open(const std::string& path, const RasterFrame& frame,
                                     const std::vector<BandLabel>& bands,
                                     const RasterWriteOptions& options = {});

    RasterWriter(RasterWriter&& other) noexcept;
    RasterWriter& operator=(RasterWriter&& other) noexcept;
    /// Removes what was written, unless finish() succeeded.
    ~RasterWriter();

    /// band: 1 … band count, each once, best in order; values in tile order, of the frame's size.
    Status writeBand(int band, const Raster<float>& values);

    /// Instead of writeBand(), a band in parts: whole rows of the file from `firstRow`, each row
    /// once, in the file's order. The last of them completes the band.
    Status writeRows(int band, int firstRow, const std::vector<float>& values);
    /// Rows to write at once so that no block of the file is written twice.
    int blockRows() const;

    /// Completes the file, reads it again, compares it with what was written and puts it in place.
    /// Nothing can be written afterwards.
    Status finish();
    /// As finish(), but nothing is put in place: whether a file of this kind can be written there,
    /// and whether the format keeps the frame's coordinate epoch, if it has one.
    Result<bool> rehearse();

private:
    struct State;
    explicit RasterWriter(std::unique_ptr<State> state);
    /// Whether so many more rows of a band may be written.
    Status checkRows(int band, int rows) const;
    /// The end of writing: takes the state.
    Result<std::unique_ptr<State>> end();

    std::unique_ptr<State> _state;
};

/// Writes bands that are all in memory.
Status writeRaster(const std::string& path, const RasterFrame& frame,
                   const std::vector<RasterBand>& bands, const RasterWriteOptions& options = {});

/// Writes a picture: 3 (RGB) or 4 (RGBA, void is alpha 0) bytes per pixel, in tile order (row 0
/// south). It comes out with north up; CRS and geotransform go where the driver puts them (for PNG
/// a .aux.xml file, and a world file with the creation option WORLDFILE=YES).
Status writeRgb8(const std::string& path, const RasterFrame& frame,
                 const std::vector<std::uint8_t>& pixels, const RasterWriteOptions& options = {});
/// The same of 3 or 4 channels, row by row from the north, from the west on.
using PixelRows = std::function<Status(int row, std::vector<std::uint8_t>& pixels)>;
Status writeRgb8(const std::string& path, const RasterFrame& frame, int channels,
                 const PixelRows& rows, const RasterWriteOptions& options = {});

} // namespace osgTerrainLight
