#pragma once

#include "core/Result.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class GDALDataset;
class GDALRasterBand;

namespace osgTerrainLight
{

/// How a band's pixels become values, and which of them are void.
struct PixelFacts
{
    std::string dataType;     ///< GDAL's name; Int8 also where GDAL reads signed bytes as unsigned
    bool signedBytes = false; ///< pixels are read as 0 … 255 and mean −128 … 127
    bool integer = false;     ///< whole numbers
    bool fitsFloat = false;   ///< at most 24 significant bits
    bool hasMask = false;     ///< a mask or alpha band says what is void
    int alphaBand = 0;        ///< that band, where GDAL makes no mask of it; else 0
    bool hasColourTable = false;
    std::optional<double> noData;     ///< of stored values
    double scale = 1.0, offset = 0.0; ///< value = stored · scale + offset

    bool isScaled() const { return scale != 1.0 || offset != 0.0; }
};

/// All that GDAL says of a band of heights, asked once. docs/INPUTS.md has the table.
struct BandFacts : PixelFacts
{
    std::string heightUnit;           ///< empty where nothing says one: metres
    double metresPerHeightUnit = 1.0; ///< > 0
    bool depths = false;              ///< the vertical axis points down: height = −value
    std::optional<std::array<double, 2>> statistics; ///< lowest and highest value, as once computed

    /// Of a stored value [m], up.
    double metresOf(double stored) const
    {
        const double metres = (stored * scale + offset) * metresPerHeightUnit;
        return depths ? -metres : metres;
    }
};

/// Errors: complex numbers, a scale of 0 or one that is not finite.
Result<PixelFacts> readPixelFacts(const std::string& path, GDALDataset& dataset, int band);

/// Part of a row of pixels: values by scale and offset, and whether they are void by nodata value,
/// mask or alpha band.
struct PixelRow
{
    std::vector<float> values;
    std::vector<bool> isVoid;
};

/// False where GDAL cannot read it.
bool readPixels(GDALDataset& dataset, int band, const PixelFacts& facts, int column, int row,
                int width, PixelRow& pixels);

/// A unit's length in metres by the names in use ("ft", "US survey foot", "Meters"); nothing where
/// the name is not known.
std::optional<double> metresPerHeightUnit(const std::string& name);

/// givenUnit: instead of what band and CRS say; empty where not given. Errors: complex numbers, a
/// picture's channel, a scale of 0. What is assumed goes to notes, one sentence each.
Result<BandFacts> readBandFacts(const std::string& path, GDALDataset& dataset, int band,
                                const std::string& givenUnit, std::vector<std::string>& notes);

} // namespace osgTerrainLight
