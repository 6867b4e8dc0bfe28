#pragma once

#include "core/PostRect.h"
#include "core/Raster.h"
#include "core/Result.h"
#include "io/HeightReader.h"
#include "io/OpenDem.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

/// The posts of a raster of any size, read where they are asked for, as readDem() reads them: in
/// the order of a tile whose post (0, 0) is the south-west one of the window that is lit. GDAL's
/// block cache keeps what was decoded. For one thread.
class RasterHeights
{
public:
    /// beyondWindow: whether posts of the raster outside options.window are there, up to `reach`
    /// [m] from it. options.maxPosts and options.progress do not count. dataset: of the path, where
    /// it is open already.
    static Result<std::unique_ptr<RasterHeights>> open(const std::string& path,
                                                       const DemReadOptions& options,
                                                       bool beyondWindow, double reach,
                                                       GDALDatasetUniquePtr dataset = nullptr);

    const std::string& path() const { return _path; }
    const DemInfo& info() const { return _dem.info; } ///< of the window that is lit
    const GroundSpacing& ground() const { return _dem.ground; }
    /// Null where the raster has none.
    const OGRSpatialReference* crs() const { return _dem.dataset->GetSpatialRef(); }
    /// Posts that may be valid; none lies beyond a pole.
    const PostRect& extent() const { return _extent; }
    /// Of any row, those beyond the raster too [m].
    double eastSpacing(int row) const;
    bool isBeyondPole(int row) const { return _degrees && _degrees->isBeyondPole(row); }
    /// Posts within so many metres of what is lit, in the raster or not.
    PostRect within(double reach) const;

    /// Reads all posts, to know what they say together. progress: 0 … 1; false cancels.
    Result<HeightRules> survey(const std::function<bool(double)>& progress);
    /// What the survey assumed.
    std::vector<std::string> surveyNotes() const { return _surveyed->notes(); }
    /// What rules say of all heights, as lowest and highest [m].
    std::pair<double, double> rangeOf(const HeightRules& rules) const;
    /// To be called before heights are read: those are above the origin [m].
    void use(HeightRules rules, double origin);

    double origin() const { return _origin; }
    /// A height [m above the datum] at a post, or beyond the raster: above the origin, by the map's
    /// scale there (HeightFactors); NaN where it is NaN or no tile can hold it.
    float placed(double height, int column, int row) const;

    /// NaN where void or beyond extent().
    Result<Raster<float>> read(const PostRect& posts);

    // For rasters that are too large to be read whole. Preconditions: no part of the raster was
    // asked for, and posts of a level are multiples of 2^level in the file's order: those that
    // overviews by the nearest pixel hold.

    /// The power of 2 of the coarsest overview; 0 where there is none.
    int overviewLevels() const;
    /// As survey(), of one of every 2^level posts only, from overviews where there are some. Of
    /// heights it knows which are impossible, not which is the highest.
    Result<HeightRules> surveyEvery(int level);
    /// Lowest and highest of the heights that it has seen [m].
    std::pair<double, double> seenRange() const { return _seen; }
    /// Posts (column + i · 2^level, row + j · 2^level): NaN where void or beyond extent().
    Result<Raster<float>> readEvery(int level, int column, int row, int width, int height);
    /// Every row of extent(), from the south; take is false where it cannot go on. beyond: counts
    /// posts that no tile can hold, all: those that are valid but for that.
    std::optional<Error> eachRow(const std::function<bool(double)>& progress,
                                 const std::function<bool(const float* heights)>& take,
                                 std::size_t& beyond, std::size_t& all);

private:
    RasterHeights() = default;
    PixelWindow pixelsOf(const PostRect& posts) const;
    PostRect postsOf(const PixelWindow& pixels) const;
    /// Of posts whose stored values were read, a row of them.
    struct Overview
    {
        int level;
        std::unique_ptr<HeightReader<double>> reader;
    };
    void openOverviews();
    /// The coarsest whose posts are no further apart than 2^level; level 0 is the raster.
    std::pair<int, HeightReader<double>*> overviewFor(int level);
    void convert(const double* stored, const PostRect& posts, int row, float* heights,
                 std::size_t& beyond, std::size_t& all) const;

    std::string _path;
    double _heightFactor = 1.0;
    std::shared_ptr<const HeightShift> _shift;
    /// Of a post, above the datum, from what was read of it.
    double heightOf(double metres, int column, int row) const;
    OpenDem _dem;
    std::optional<DegreeRows> _degrees;
    PostRect _extent;
    std::unique_ptr<HeightReader<double>> _reader;
    std::vector<Overview> _overviews;                ///< finest first
    const HeightReader<double>* _surveyed = nullptr; ///< which survey() or surveyEvery() used
    HeightRules _rules;
    std::pair<double, double> _seen;
    double _origin = 0.0;
};

} // namespace osgTerrainLight
