#include "io/WrittenFile.h"

#include "io/GdalErrors.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

WrittenFile::WrittenFile(int width, int height, int bands)
    : _width(width), _height(height), _bands(bands),
      _rows(static_cast<std::size_t>(height) * static_cast<std::size_t>(bands))
{
}

const WrittenFile::Row& WrittenFile::at(int band, int row) const
{
    return _rows[static_cast<std::size_t>(band - 1) * static_cast<std::size_t>(_height) +
                 static_cast<std::size_t>(row)];
}

void WrittenFile::add(int band, int row, double value, bool isVoid)
{
    Row& into = at(band, row);
    into.voids += isVoid;
    into.sum += isVoid ? 0.0 : value;
    into.size += isVoid ? 0.0 : std::abs(value);
}

bool WrittenFile::isExact(GDALDriver& driver, const std::vector<std::string>& creationOptions)
{
    for (const char* name : {"JPEG", "WEBP", "JPEGXL", "JP2OpenJPEG", "JP2ECW", "HEIF", "GRIB",
                             "GIF", "MBTiles", "PDF", "KMLSUPEROVERLAY", "HF2", "BAG"})
        if (EQUAL(driver.GetDescription(), name))
            return false;
    for (const std::string& option : creationOptions)
        for (const char* lossy : {"PRECISION", "DECIMAL", "QUALITY", "MAX_Z_ERROR", "JXL_", "JPEG",
                                  "WEBP", "NBITS", "DISCARD_LSB", "TARGET_SRS", "TILING_SCHEME"})
            if (CPLString(option).toupper().find(lossy) != std::string::npos)
                return false;
    return true;
}

Status WrittenFile::compare(const std::string& path, GDALDriver& driver, bool isExact) const
{
    const auto wrong = [](const std::string& what) {
        return Error{ErrorCode::Failed, "what was written cannot be read again: " + what};
    };
    const GdalErrors errors;
    const char* drivers[] = {driver.GetDescription(), "GTiff", nullptr}; // COG is read by GTiff
    if (!EQUAL(driver.GetDescription(), "COG"))
        drivers[1] = nullptr;
    if (!driver.GetMetadataItem(GDAL_DCAP_OPEN) && !drivers[1])
        return Nothing{};
    const CPLConfigOptionSetter strict("GDAL_ERROR_ON_LIBJPEG_WARNING", "YES", true);
    const GDALDatasetUniquePtr file(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR, drivers));
    if (!file)
        return wrong(errors.first());
    if (isExact && (file->GetRasterXSize() != _width || file->GetRasterYSize() != _height ||
                    file->GetRasterCount() != _bands))
        return wrong(std::to_string(file->GetRasterXSize()) + " x " +
                     std::to_string(file->GetRasterYSize()) + " pixels in " +
                     std::to_string(file->GetRasterCount()) + " bands");
    const int width = file->GetRasterXSize();
    std::vector<double> rows;
    for (int band = 1; band <= file->GetRasterCount(); ++band)
    {
        GDALRasterBand& from = *file->GetRasterBand(band);
        int hasNoData = 0;
        const double noData = from.GetNoDataValue(&hasNoData);
        // Whole blocks, so that none is decoded twice, of some 32 MiB at most.
        int blockWidth = 1;
        int blockHeight = 1;
        from.GetBlockSize(&blockWidth, &blockHeight);
        const int stripRows = std::clamp(blockHeight, 1, std::max(1, (1 << 22) / width));
        for (int first = 0; first < file->GetRasterYSize(); first += stripRows)
        {
            const int count = std::min(stripRows, file->GetRasterYSize() - first);
            rows.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(count));
            if (from.RasterIO(GF_Read, 0, first, width, count, rows.data(), width, count,
                              GDT_Float64, 0, 0, nullptr) != CE_None)
                return wrong(errors.first());
            for (int row = first; isExact && row < first + count; ++row)
            {
                const double* line = rows.data() + static_cast<std::ptrdiff_t>(row - first) * width;
                Row found;
                for (int column = 0; column < width; ++column)
                {
                    const double value = line[column];
                    const bool isVoid = std::isnan(value) || (hasNoData && value == noData);
                    found.voids += isVoid;
                    found.sum += isVoid ? 0.0 : value;
                }
                const Row& put = at(band, row);
                if (found.voids != put.voids ||
                    !(std::abs(found.sum - put.sum) <= 1e-3 * put.size + 1e-5 * _width))
                    return wrong("row " + std::to_string(row + 1) + " of band " +
                                 std::to_string(band) + " has other values");
            }
        }
    }
    return Nothing{};
}

} // namespace osgTerrainLight
