#include "io/CompositeRaster.h"

#include "io/Bilinear.h"
#include "io/CompositeGrid.h"
#include "io/PostsToPixels.h"
#include "io/RasterHeights.h"

#include <cpl_error.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
constexpr double missing = std::numeric_limits<double>::quiet_NaN();
/// So that places in the quadtree stay whole numbers of 32 bits.
constexpr int mostPostsOfGrid = 1 << 24;
constexpr int blockSide = 256;

/// Posts of the grid, every so many of them: first is in the order of a tile.
struct Posts
{
    int column = 0, row = 0, step = 1, width = 0, height = 0;
};

/// One layer, sampled at posts of the grid.
class SampledLayer
{
public:
    SampledLayer(std::unique_ptr<OverviewSource> source, PostsToPixels toPixels, double step)
        : _source(std::move(source)), _toPixels(std::move(toPixels)), _step(step)
    {
    }

    /// Takes heights where the layer has some. step: between posts of the grid, in those of the
    /// first layer. heights: from the south-west.
    Status cover(const Posts& posts, double step, std::vector<double>& heights)
    {
        const int level = levelFor(step * posts.step);
        const Places places = placesOf(posts, level);
        const PostRect all = _source->extent(level);
        const PostRect part = around(places).clippedTo({0, 0, all.width, all.height});
        if (part.empty())
            return Nothing{};
        const Result<Raster<float>> read = _source->readSurface(
            level, {all.column + part.column, all.row + part.row, part.width, part.height});
        if (!read)
            return read.error();
        const double origin = _source->heightOrigin();
        const auto at = [&](int column, int row)
        { return origin + double(read->at(column - part.column, row - part.row)); };
        for (std::size_t i = 0; i < heights.size(); ++i)
        {
            const double height = bilinear(places.x[i], places.y[i], all.width, all.height, at);
            if (!std::isnan(height))
                heights[i] = height;
        }
        return Nothing{};
    }

private:
    using Places = PostsToPixels::Places;

    /// Its posts are at least twice as dense as the ones asked for, so that those lose little by
    /// the bilinear mean; the finest where the layer has no such posts.
    int levelFor(double spacing) const
    {
        int level = 0;
        while (level < _source->root() &&
               _step * static_cast<double>(2 << level) <= 0.5 * spacing * (1.0 + 1.0e-6))
            ++level;
        return level;
    }

    /// In posts of a level, from the first of its extent; NaN outside the layer.
    Places placesOf(const Posts& posts, int level) const
    {
        const RasterFrame& frame = _source->frame();
        const PostRect raster = _source->raster();
        const PostRect whole = _source->extent(0);
        const PostRect all = _source->extent(level);
        const auto along = [&](double post, int from, int begin, int count, int first, int most)
        {
            const double place = post + from - begin;
            if (!(place >= -0.5 && place <= count - 0.5))
                return missing;
            if (level == 0)
                return place;
            return std::clamp((post + from) / (1 << level) - first, 0.0, std::max(0.0, most - 1.0));
        };
        Places result;
        for (int row = 0; row < posts.height; ++row)
        {
            const Places pixels = _toPixels.row(posts.column, posts.step, posts.width,
                                                posts.row + double(row) * posts.step);
            for (std::size_t i = 0; i < pixels.x.size(); ++i)
            {
                const double x = frame.westFirst ? pixels.x[i] : frame.width - 1 - pixels.x[i];
                const double y = frame.northUp ? frame.height - 1 - pixels.y[i] : pixels.y[i];
                result.x.push_back(
                    along(x, raster.column, whole.column, whole.width, all.column, all.width));
                result.y.push_back(
                    along(y, raster.row, whole.row, whole.height, all.row, all.height));
            }
        }
        return result;
    }

    static PostRect around(const Places& places)
    {
        double west = 1.0e9, east = -1.0e9, south = 1.0e9, north = -1.0e9;
        for (std::size_t i = 0; i < places.x.size(); ++i)
            if (!std::isnan(places.x[i]) && !std::isnan(places.y[i]))
            {
                west = std::min(west, places.x[i]);
                east = std::max(east, places.x[i]);
                south = std::min(south, places.y[i]);
                north = std::max(north, places.y[i]);
            }
        if (west > east)
            return {0, 0, 0, 0};
        const auto first = [](double place) { return static_cast<int>(std::floor(place)); };
        return {first(west), first(south), first(east) - first(west) + 2,
                first(north) - first(south) + 2};
    }

    std::unique_ptr<OverviewSource> _source;
    PostsToPixels _toPixels;
    double _step; ///< between its posts, in those of the first layer
};

struct SampledLayers
{
    CompositeGrid grid;
    std::vector<SampledLayer> layers; ///< lowest first

    /// Status of the first layer that cannot be read.
    Status read(const Posts& posts, std::vector<double>& heights)
    {
        heights.assign(static_cast<std::size_t>(posts.width) *
                           static_cast<std::size_t>(posts.height),
                       missing);
        for (SampledLayer& layer : layers)
            if (const Status read = layer.cover(posts, grid.step, heights); !read)
                return read;
        return Nothing{};
    }
};

/// A level of the composite for GDAL, which keeps its blocks: overviews by the nearest pixel.
class LevelDataset : public GDALDataset
{
public:
    LevelDataset(std::shared_ptr<SampledLayers> layers, int level);

#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 12, 0)
    CPLErr GetGeoTransform(GDALGeoTransform& transform) const override
    {
        const RasterFrame& frame = _layers->grid.frame;
        transform = GDALGeoTransform(frame.geoTransform.data());
        return CE_None;
    }
#else
    CPLErr GetGeoTransform(double* transform) override
    {
        const RasterFrame& frame = _layers->grid.frame;
        std::copy(frame.geoTransform.begin(), frame.geoTransform.end(), transform);
        return CE_None;
    }
#endif
    const OGRSpatialReference* GetSpatialRef() const override
    {
        return _crs.IsEmpty() ? nullptr : &_crs;
    }

    const std::shared_ptr<SampledLayers>& layers() const
    {
        return _layers;
    }
    int level() const
    {
        return _level;
    }
    std::vector<std::unique_ptr<LevelDataset>>& overviews()
    {
        return _overviews;
    }

private:
    std::shared_ptr<SampledLayers> _layers;
    int _level;
    OGRSpatialReference _crs;
    std::vector<std::unique_ptr<LevelDataset>> _overviews; ///< finest first
};

class LevelBand : public GDALRasterBand
{
public:
    explicit LevelBand(LevelDataset& dataset) : _dataset(dataset)
    {
        poDS = &dataset;
        nBand = 1;
        eDataType = GDT_Float64;
        eAccess = GA_ReadOnly;
        nRasterXSize = dataset.GetRasterXSize();
        nRasterYSize = dataset.GetRasterYSize();
        nBlockXSize = std::min(blockSide, nRasterXSize);
        nBlockYSize = std::min(blockSide, nRasterYSize);
    }

    double GetNoDataValue(int* found) override
    {
        if (found)
            *found = TRUE;
        return missing;
    }
    const char* GetUnitType() override { return "m"; }
    /// Heights, whatever a vertical axis of the CRS says.
    const char* GetMetadataItem(const char* name, const char* domain) override
    {
        return EQUAL(name, "positive") && (!domain || !*domain)
                   ? "up"
                   : GDALRasterBand::GetMetadataItem(name, domain);
    }
    int GetOverviewCount() override { return static_cast<int>(_dataset.overviews().size()); }
    GDALRasterBand* GetOverview(int i) override
    {
        return i < 0 || i >= GetOverviewCount()
                   ? nullptr
                   : _dataset.overviews()[static_cast<std::size_t>(i)]->GetRasterBand(1);
    }

protected:
    CPLErr IReadBlock(int blockX, int blockY, void* to) override;

private:
    LevelDataset& _dataset;
};

int sizeAt(int posts, int level)
{
    return ((posts - 1) >> level) + 1;
}

LevelDataset::LevelDataset(std::shared_ptr<SampledLayers> layers, int level)
    : _layers(std::move(layers)), _level(level)
{
    const RasterFrame& frame = _layers->grid.frame;
    nRasterXSize = sizeAt(frame.width, level);
    nRasterYSize = sizeAt(frame.height, level);
    eAccess = GA_ReadOnly;
    const Crs crs(frame.crs);
    if (crs.get())
        _crs = *crs.get();
    if (frame.coordinateEpoch != 0.0)
        _crs.SetCoordinateEpoch(frame.coordinateEpoch);
    SetBand(1, new LevelBand(*this)); // GDAL deletes it
}

CPLErr LevelBand::IReadBlock(int blockX, int blockY, void* to)
{
    const RasterFrame& frame = _dataset.layers()->grid.frame;
    const int left = blockX * nBlockXSize;
    const int top = blockY * nBlockYSize;
    const int step = 1 << _dataset.level();
    Posts posts;
    posts.step = step;
    posts.width = std::min(nBlockXSize, nRasterXSize - left);
    posts.height = std::min(nBlockYSize, nRasterYSize - top);
    posts.column = left * step;
    posts.row = frame.fileRow((top + posts.height - 1) * step);
    std::vector<double> heights;
    if (const Status read = _dataset.layers()->read(posts, heights); !read)
    {
        CPLError(CE_Failure, CPLE_FileIO, "%s", read.error().message.c_str());
        return CE_Failure;
    }
    auto* const pixels = static_cast<double*>(to);
    std::fill_n(pixels, static_cast<std::ptrdiff_t>(nBlockXSize) * nBlockYSize, missing);
    for (int row = 0; row < posts.height; ++row)
        std::copy_n(heights.begin() + static_cast<std::ptrdiff_t>(row) * posts.width, posts.width,
                    pixels + static_cast<std::ptrdiff_t>(posts.height - 1 - row) * nBlockXSize);
    return CE_None;
}

GDALDatasetUniquePtr datasetOf(const std::shared_ptr<SampledLayers>& layers)
{
    auto made = std::make_unique<LevelDataset>(layers, 0);
    const int longest = std::max(made->GetRasterXSize(), made->GetRasterYSize());
    for (int level = 1; (longest >> level) >= blockSide / 4; ++level)
        made->overviews().push_back(std::make_unique<LevelDataset>(layers, level));
    return GDALDatasetUniquePtr(made.release());
}

class Opener
{
public:
    Opener(const std::vector<DemLayer>& layers, int mostPosts)
        : _layers(layers), _mostPosts(mostPosts)
    {
    }

    std::optional<CompositeRaster> open()
    {
        for (std::size_t i = 0; i < _layers.size(); ++i)
            if (Result<DemInfo> info = describeDem(_layers[i].path, _layers[i].read))
            {
                _placed.emplace_back();
                _placed.back().number = i;
                _placed.back().info = std::move(*info);
            }
            else
                _result.leftOut.emplace_back(i, info.error());
        if (_placed.empty())
            return std::nullopt;
        // Without the layer that was found bad, others may have another map.
        while (!_result.source && !_placed.empty())
        {
            _notes.clear();
            std::size_t bad = 0;
            const Result<bool> isOpen = _placed.size() == 1 ? openOne() : compose(bad);
            if (isOpen && !*isOpen)
                return std::nullopt;
            if (isOpen)
                break;
            _result.leftOut.emplace_back(_placed[bad].number, isOpen.error());
            _placed.erase(_placed.begin() + static_cast<std::ptrdiff_t>(bad));
        }
        _result.notes = std::move(_notes);
        return std::move(_result);
    }

private:
    const DemLayer& layerOf(std::size_t i) const { return _layers[_placed[i].number]; }
    bool isLarge(int width, int height) const { return std::max(width, height) > _mostPosts; }
    void tell(const std::string& path, const std::vector<std::string>& notes)
    {
        for (const std::string& note : notes)
            _notes.push_back(path + ": " + note);
    }

    /// False where it is not large.
    Result<bool> openOne()
    {
        if (!isLarge(_placed[0].info.rasterWidth, _placed[0].info.rasterHeight))
            return false;
        const DemLayer& layer = layerOf(0);
        return take(layer.path, OverviewSource::open(layer.path, layer.read));
    }

    Result<bool> take(const std::string& path, Result<std::unique_ptr<OverviewSource>> source)
    {
        if (!source)
            return source.error();
        tell(path, (*source)->notes());
        _result.source = std::move(*source);
        return true;
    }

    /// bad: the layer that an error is of.
    Result<bool> compose(std::size_t& bad)
    {
        for (bad = 0; bad < _placed.size(); ++bad)
            if (const auto error = place(layerOf(bad).path, _placed[0].info, _placed[bad]))
                return *error;
        const auto layers = std::make_shared<SampledLayers>();
        layers->grid = gridOf(_placed, mostPostsOfGrid);
        const RasterFrame& grid = layers->grid.frame;
        if (!isLarge(grid.width, grid.height))
            return false;
        for (bad = 0; bad < _placed.size(); ++bad)
        {
            DemReadOptions options = layerOf(bad).read;
            options.byMapScale = false;
            auto source = OverviewSource::open(layerOf(bad).path, options);
            if (!source)
                return source.error();
            tell(layerOf(bad).path, (*source)->notes());
            const RasterFrame& frame = (*source)->frame();
            auto toPixels =
                PostsToPixels::between(grid, Crs(grid.crs).get(), frame, Crs(frame.crs).get());
            if (!toPixels)
                return Error{ErrorCode::Invalid, layerOf(bad).path + ": cannot be placed"};
            layers->layers.emplace_back(std::move(*source), std::move(*toPixels),
                                        _placed[bad].step);
        }
        _notes.push_back(std::to_string(_placed.size()) + " layers of heights make one of " +
                         std::to_string(grid.width) + " x " + std::to_string(grid.height) +
                         " posts");
        bad = 0;
        const std::string& path = layerOf(0).path;
        auto heights = RasterHeights::open(path, {}, true, std::numeric_limits<double>::max(),
                                           datasetOf(layers));
        if (!heights)
            return heights.error();
        return take(path, OverviewSource::open(std::move(*heights)));
    }

    const std::vector<DemLayer>& _layers;
    const int _mostPosts;
    std::vector<PlacedLayer> _placed;
    std::vector<std::string> _notes;
    CompositeRaster _result;
};
} // namespace

std::optional<CompositeRaster> openComposite(const std::vector<DemLayer>& layers, int mostPosts)
{
    return Opener(layers, mostPosts).open();
}

} // namespace osgTerrainLight
