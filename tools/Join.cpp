#include "Join.h"

#include "Picture.h"
#include "io/GdalErrors.h"
#include "io/RasterDriver.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{

/// Rows of all windows together, as the file has them.
class PartRows
{
public:
    PartRows(const Parts& parts, const WindowGrid& grid, int width, int bands)
        : _parts(parts), _grid(grid), _width(width), _bands(bands)
    {
    }

    /// Band after band: `rows` rows each. Void is RasterWriter::noData.
    Status read(int band, int firstRow, int rows, std::vector<float>& values)
    {
        values.resize(static_cast<std::size_t>(_width) * static_cast<std::size_t>(rows));
        for (int row = firstRow; row < firstRow + rows;)
        {
            const int gridRow = row / _grid.windowHeight();
            const int end = std::min(firstRow + rows, (gridRow + 1) * _grid.windowHeight());
            if (Status opened = open(gridRow); !opened)
                return opened;
            for (int column = 0; column < _grid.columns(); ++column)
            {
                const int index = gridRow * _grid.columns() + column;
                const PixelWindow window = _grid.at(index);
                float* into = values.data() + static_cast<std::ptrdiff_t>(row - firstRow) * _width +
                              window.column;
                const GdalErrors errors;
                if (_open[static_cast<std::size_t>(column)]->GetRasterBand(band)->RasterIO(
                        GF_Read, 0, row - window.row, window.width, end - row, into, window.width,
                        end - row, GDT_Float32, sizeof(float),
                        static_cast<GSpacing>(sizeof(float)) * _width, nullptr) != CE_None)
                    return damaged(index, errors.first());
            }
            row = end;
        }
        return Nothing{};
    }

private:
    Status open(int gridRow)
    {
        if (gridRow == _gridRow)
            return Nothing{};
        _open.clear();
        _gridRow = -1;
        for (int column = 0; column < _grid.columns(); ++column)
        {
            const int index = gridRow * _grid.columns() + column;
            const PixelWindow window = _grid.at(index);
            const GdalErrors errors;
            GDALDatasetUniquePtr part(GDALDataset::Open(_parts.path(index).c_str(),
                                                        GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR));
            if (!part)
                return damaged(index, errors.first());
            if (part->GetRasterXSize() != window.width || part->GetRasterYSize() != window.height ||
                part->GetRasterCount() != _bands)
                return damaged(index, "it has another size");
            _open.push_back(std::move(part));
        }
        _gridRow = gridRow;
        return Nothing{};
    }

    Error damaged(int index, const std::string& why)
    {
        _open.clear();
        _gridRow = -1;
        std::error_code failure;
        std::filesystem::remove(_parts.path(index), failure);
        return {ErrorCode::Failed, "window " + std::to_string(index + 1) + ": " +
                                       _parts.path(index) + " cannot be read (" + why +
                                       ") and was removed, to be computed again"};
    }

    const Parts& _parts;
    const WindowGrid& _grid;
    int _width, _bands, _gridRow = -1;
    std::vector<GDALDatasetUniquePtr> _open; ///< of a row of windows
};

bool isGiven(const OutputOptions& output, const char* name)
{
    return std::any_of(output.creationOptions.begin(), output.creationOptions.end(),
                       [name](const std::string& option) {
                           return STARTS_WITH_CI(option.c_str(), (std::string(name) + "=").c_str());
                       });
}

/// Large files are tiled, compressed and may pass 4 GiB, where nothing else was asked for.
OutputOptions withDefaults(OutputOptions output)
{
    const Result<GDALDriver*> driver = findRasterDriver(output.path, output.format);
    const std::string name = driver ? (*driver)->GetDescription() : "";
    const bool isTiff = name == "GTiff";
    if (!isTiff && name != "COG")
        return output;
    const bool mayCompress = !isGiven(output, "COMPRESS") && !isGiven(output, "PREDICTOR");
    const auto add = [&output](const char* option) { output.creationOptions.emplace_back(option); };
    if (!isGiven(output, "BIGTIFF"))
        add("BIGTIFF=IF_SAFER");
    if (mayCompress)
    {
        add("COMPRESS=DEFLATE");
        add(isTiff ? "PREDICTOR=3" : "PREDICTOR=YES");
    }
    if (isTiff && !isGiven(output, "TILED"))
        add("TILED=YES");
    return output;
}

Status joinFloats(PartRows& parts, const OutputOptions& output, const std::string& folder,
                  const std::vector<BandLabel>& bands, const RasterFrame& frame,
                  const Metadata& metadata, const Fraction& progress)
{
    const DeferredSignals deferred;
    RasterWriteOptions options = writeOptions(output, metadata);
    options.scratchFolder = folder;
    Result<RasterWriter> writer = RasterWriter::open(output.path, frame, bands, options);
    if (!writer)
        return writer.error();
    constexpr int fewest = 64;
    const int block = std::clamp(writer->blockRows(), 1, 1024);
    const int strip = (fewest + block - 1) / block * block;
    std::vector<float> values;
    for (int row = 0; row < frame.height; row += strip)
    {
        const int rows = std::min(strip, frame.height - row);
        for (int band = 1; band <= static_cast<int>(bands.size()); ++band)
        {
            if (Status going = DeferredSignals::check(); !going)
                return going;
            if (Status read = parts.read(band, row, rows, values); !read)
                return read;
            if (Status written = writer->writeRows(band, row, values); !written)
                return written;
        }
        progress(static_cast<double>(row + rows) / frame.height);
    }
    return writer->finish();
}

Status joinPicture(PartRows& parts, const OutputOptions& output, const std::string& folder,
                   double gain, const RasterFrame& frame, const Metadata& metadata,
                   const Fraction& progress)
{
    const auto isVoid = [](float value) { return value == RasterWriter::noData; };
    std::vector<float> band;
    bool hasVoids = false;
    for (int row = 0; row < frame.height && !hasVoids; ++row)
    {
        if (Status read = parts.read(1, row, 1, band); !read)
            return read;
        hasVoids = std::any_of(band.begin(), band.end(), isVoid);
    }
    const auto rows = [&](int row, std::vector<float>& line) -> Status
    {
        line.clear();
        for (int channel = 1; channel <= 4; ++channel)
        {
            if (Status read = parts.read(channel, frame.fileRow(frame.height - 1 - row), 1, band);
                !read)
                return read;
            std::replace_if(band.begin(), band.end(), isVoid,
                            std::numeric_limits<float>::quiet_NaN());
            if (frame.westFirst)
                line.insert(line.end(), band.begin(), band.end());
            else
                line.insert(line.end(), band.rbegin(), band.rend());
        }
        progress((row + 1.0) / frame.height);
        return Nothing{};
    };
    return writePicture(output, frame, hasVoids, gain, metadata, rows, folder);
}

} // namespace

OutputOptions partOptions(const std::string& path)
{
    // A block of zlib's holds a checksum of its own: a part that is damaged does not read well.
    return {path,
            "GTiff",
            {"COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=1", "BLOCKYSIZE=64", "BIGTIFF=IF_SAFER"},
            true};
}

Status joinParts(const Parts& parts, const WindowGrid& grid, const OutputOptions& output,
                 const Product& product, const RasterFrame& frame, const Metadata& metadata,
                 const Fraction& progress)
{
    const GdalErrors errors;
    PartRows rows(parts, grid, frame.width, static_cast<int>(product.bands.size()));
    if (product.kind == Product::Kind::Picture)
        return joinPicture(rows, output, parts.folder(), product.gain, frame, metadata, progress);
    return joinFloats(rows, withDefaults(output), parts.folder(), product.bands, frame, metadata,
                      progress);
}

} // namespace osgTerrainLight::tool
