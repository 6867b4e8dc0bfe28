#pragma once

#include "io/CustomaryVoids.h"
#include "io/DemReader.h"
#include "io/HeightRules.h"
#include "io/HeightSurvey.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

class GDALDataset;
class GDALRasterBand;

namespace osgTerrainLight
{

class GdalErrors;
struct GroundSpacing;
struct OpenDem;

/// Reads a band's stored values in rectangles, marks as NaN what nodata value or mask say is void,
/// and finds out what all values together say.
///
/// Real holds stored values exactly: float for up to 24 bits, double for all. Instantiated for
/// both.
template <class Real>
class HeightReader
{
public:
    explicit HeightReader(const OpenDem& dem);

    /// Of a raster with so many posts to read, the smallest overview that has no fewer than maxSide
    /// posts a side stands for the raster from then on. False where there is none.
    bool useOverview(int maxSide);
    int width() const;  ///< of what is read
    int height() const; ///< of it

    /// values: of so many posts. survey: shows them to rules(). False where GDAL cannot read.
    bool read(const PixelWindow& window, Real* values, bool survey);

    /// Whole rows of blocks, so that none is decoded twice, in strips of at most about 4 M posts.
    int stripRows(const PixelWindow& window) const;

    /// take(strip): from the first row to the last, or the other way round; false where it cannot
    /// be read. progress: called with 0 … 1 of the window.
    std::optional<Error> eachStrip(const PixelWindow& window, bool lastFirst,
                                   const std::string& path, const GdalErrors& errors,
                                   const std::function<bool(double)>& progress,
                                   const std::function<bool(const PixelWindow& strip)>& take) const;

    /// All values were seen. An error where none is a height. window: for messages.
    Result<HeightRules> rules(const std::string& path, const PixelWindow& window);
    /// What rules() assumes, one sentence each.
    std::vector<std::string> notes() const;

    /// An error of reading these rows.
    Error unreadable(const std::string& path, const PixelWindow& window,
                     const GdalErrors& errors) const;

private:
    bool isNoData(Real stored) const;
    std::vector<std::string> voidNotes() const;

    const DemInfo& _info;
    GDALDataset& _dataset;
    GDALRasterBand* _band;     ///< what is read: the raster's, or an overview
    GDALRasterBand* _maskBand; ///< of _band
    std::vector<float> _mask;  ///< of a read; an alpha band can hold fractions
    CustomaryVoids _customs;
    HeightSurvey _survey;
};

/// As DemTile::setHeight(): no tile holds one further above or below its origin [m].
constexpr float greatestHeight = 1.0e6f;

/// What heights of a raster are told above: whole metres in the middle of their range.
double originOfHeights(double lowest, double highest);

/// By how much slopes are wrong, since the map's scale differs within the raster (HeightFactors);
/// empty where that is little.
std::string noteOfSlopes(const GroundSpacing& ground, double lowest, double highest);

/// Posts that z factor or map scale take further from the origin than a tile's heights may lie: a
/// note that counts them, or an error where that is all of them.
std::optional<Error> tellOfBeyond(const std::string& path, std::size_t beyond, std::size_t all,
                                  std::vector<std::string>& notes);

/// True where a row of a frame in the file's order lies beyond a pole.
bool isBeyondPole(const GroundSpacing& ground, const RasterFrame& frame, int fileRow);

} // namespace osgTerrainLight
