#pragma once

#include "core/Result.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

class GDALDriver;

namespace osgTerrainLight
{

/// What went into a raster file, row by row in the file's order, to be held against what comes out
/// of it again: drivers report a full disk by messages at best.
class WrittenFile
{
public:
    WrittenFile(int width, int height, int bands);

    /// A value of a row; void ones count as such.
    void add(int band, int row, double value, bool isVoid);

    /// Opens the file by its driver and compares size, bands, and of each row the voids and the sum
    /// of the values, to 1e-3 of their magnitudes, for formats of decimal text. Where `isExact` is
    /// false (formats that lose values on purpose) rows need only be there. Nothing to compare
    /// where the driver only writes.
    Status compare(const std::string& path, GDALDriver& driver, bool isExact) const;

    /// Whether the driver and its options keep values.
    static bool isExact(GDALDriver& driver, const std::vector<std::string>& creationOptions);

private:
    struct Row
    {
        double sum = 0.0, size = 0.0;
        int voids = 0;
    };
    const Row& at(int band, int row) const;
    Row& at(int band, int row) { return const_cast<Row&>(std::as_const(*this).at(band, row)); }

    int _width, _height, _bands;
    std::vector<Row> _rows;
};

} // namespace osgTerrainLight
