#include "io/RasterSource.h"

#include "io/FarTerrain.h"
#include "io/LevelBuilder.h"
#include "io/LevelCache.h"
#include "io/RasterHeights.h"

#include <cpl_string.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>
#include <tuple>
#include <utility>

namespace osgTerrainLight
{
namespace
{
/// Posts a side of the coarsest level. The raster's own has fewer, so that any window of that level
/// around a tile holds the whole raster, and coarser levels of it are never looked at.
constexpr int mostPosts = 64;
constexpr int mostOwnPosts = 16;
/// Heights of surroundings that differ more than this in the middle have another datum or unit [m].
constexpr double tellableOffset = 50.0;

int levelWith(const PostRect& extent, int posts)
{
    int level = 1;
    const auto side = [&]
    {
        const PostRect coarse = extent.coarser(level);
        return std::max(coarse.width, coarse.height);
    };
    while (side() > posts)
        ++level;
    return level;
}

/// What heights depend on beside the raster's files.
std::string contentsOf(const RasterHeights& heights, const RasterSourceOptions& options)
{
    const PixelWindow& window = heights.info().window;
    const PostRect& extent = heights.extent();
    std::string text = "raster";
    for (const int value : {window.column, window.row, window.width, window.height, extent.column,
                            extent.row, extent.width, extent.height, options.read.band})
        text += " " + std::to_string(value);
    return text + " " + options.read.heightUnit +
           CPLSPrintf(" %.17g %.17g", options.read.heightFactor,
                      options.read.cellSize.value_or(0.0));
}

/// Parts of a raster have levels of their own, side by side: they begin at the part's first post.
std::string variantOf(const DemInfo& info)
{
    const PixelWindow& window = info.window;
    if (window.width == info.rasterWidth && window.height == info.rasterHeight)
        return {};
    return CPLSPrintf("-%d-%d-%d-%d", window.column, window.row, window.width, window.height);
}

using Progress = std::function<bool(double)>;

Progress partOf(const Progress& whole, double from, double to)
{
    if (!whole)
        return {};
    return [whole, from, to](double done) { return whole(from + (to - from) * done); };
}

/// In two passes, since heights need their origin and rules, which all of them decide.
Result<LevelFacts> build(RasterHeights& heights, LevelBuilder& builder, LevelFileWriter& writer,
                         const Progress& progress)
{
    Result<HeightRules> rules = heights.survey(partOf(progress, 0.0, 0.4));
    if (!rules)
        return rules.error();
    LevelFacts facts;
    facts.rules = *rules;
    std::tie(facts.lowest, facts.highest) = heights.rangeOf(*rules);
    heights.use(*rules, originOfHeights(facts.lowest, facts.highest));
    facts.notes = heights.surveyNotes();
    if (const std::string note = noteOfSlopes(heights.ground(), facts.lowest, facts.highest);
        !note.empty())
        facts.notes.push_back(note);
    builder.begin(writer);
    std::size_t beyond = 0;
    std::size_t all = 0;
    const auto take = [&builder](const float* row) { return builder.addRow(row); };
    if (auto error = heights.eachRow(partOf(progress, 0.4, 1.0), take, beyond, all))
        return *error;
    if (auto error = tellOfBeyond(heights.path(), beyond, all, facts.notes))
        return *error;
    return facts;
}
} // namespace

RasterSource::RasterSource() = default;
RasterSource::~RasterSource() = default;

Result<std::unique_ptr<RasterSource>> RasterSource::open(const std::string& path,
                                                         const RasterSourceOptions& options)
{
    assert(options.reach > 0.0);
    std::unique_ptr<RasterSource> made(new RasterSource);
    try
    {
        const double share = 1.0 / (1.0 + static_cast<double>(options.surroundings.size()));
        if (const Status status = made->openRaster(path, options, share); !status)
            return status.error();
        if (const Status status = made->openSurroundings(options, share); !status)
            return status.error();
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed, path + ": not enough memory to read a strip of it"};
    }
    return made;
}

Status RasterSource::openRaster(const std::string& path, const RasterSourceOptions& options,
                                double share)
{
    auto heights = RasterHeights::open(path, options.read, options.beyondWindow, options.reach);
    if (!heights)
        return heights.error();
    _heights = std::move(*heights);
    _notes = _heights->info().notes;
    _ownLastLevel = levelWith(_heights->extent(), mostOwnPosts);
    LevelBuilder builder(_heights->extent(), 0, _ownLastLevel, false);
    auto levels = openLevels(
        {path, options.cacheFolder, variantOf(_heights->info()), contentsOf(*_heights, options)},
        builder.planes(), _notes,
        [&](LevelFileWriter& writer)
        { return build(*_heights, builder, writer, partOf(options.read.progress, 0.0, share)); });
    if (!levels)
        return levels.error();
    _levels = std::move(*levels);
    const LevelFacts& facts = _levels->facts();
    _lowest = facts.lowest;
    _highest = facts.highest;
    _notes.insert(_notes.end(), facts.notes.begin(), facts.notes.end());
    _heights->use(facts.rules, originOfHeights(_lowest, _highest));
    return Nothing{};
}

Status RasterSource::openSurroundings(const RasterSourceOptions& options, double share)
{
    PostRect whole = _heights->extent();
    for (const std::string& file : options.surroundings)
    {
        auto far = FarTerrain::open(file, *_heights, options.reach);
        if (!far)
            return far.error();
        whole = whole.joinedWith((*far)->extent(0));
        _surroundings.push_back(std::move(*far));
    }
    // Levels on which all of them are sampled, too.
    _lastLevel = std::max(_ownLastLevel, levelWith(whole, mostPosts));
    for (const auto& far : _surroundings)
        if (!far->extent(0).empty())
            _lastLevel = std::max(_lastLevel, far->base());
    for (std::size_t i = 0; i < _surroundings.size(); ++i)
    {
        FarTerrain& far = *_surroundings[i];
        const std::string& file = options.surroundings[i];
        const double from = share * (1.0 + static_cast<double>(i));
        if (!far.extent(0).empty())
        {
            if (const Status status =
                    far.openLevels(_lastLevel, options.cacheFolder,
                                   partOf(options.read.progress, from, from + share));
                !status)
                return status;
            if (const Status status = compareHeights(far, file); !status)
                return status;
        }
        for (const std::string& note : far.notes())
            _notes.push_back(file + ": " + note);
    }
    const auto isNowhere = [](const std::unique_ptr<FarTerrain>& far)
    { return far->extent(0).empty(); };
    _surroundings.erase(std::remove_if(_surroundings.begin(), _surroundings.end(), isNowhere),
                        _surroundings.end());
    return Nothing{};
}

/// At a few posts of what is lit.
Status RasterSource::compareHeights(FarTerrain& far, const std::string& path)
{
    constexpr int side = 15;
    std::vector<double> differences;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
        {
            const PostRect post{static_cast<int>((i + 0.5) / side * width()),
                                static_cast<int>((j + 0.5) / side * height()), 1, 1};
            const auto theirs = far.read(0, CrestAxis::East, post);
            if (!theirs)
                return theirs.error();
            if (std::isnan(theirs->at(0, 0)))
                continue;
            const auto ours = _heights->read(post);
            if (!ours)
                return ours.error();
            if (!std::isnan(ours->at(0, 0)))
                differences.push_back(static_cast<double>(theirs->at(0, 0)) -
                                      static_cast<double>(ours->at(0, 0)));
        }
    if (differences.empty())
        return Nothing{};
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    if (std::abs(*middle) > tellableOffset)
        _notes.push_back(path + ": heights are " + CPLSPrintf("%.0f", std::abs(*middle)) + " m " +
                         (*middle > 0.0 ? "above" : "below") + " those of " + _heights->path() +
                         " in the middle of their differences; another vertical datum or unit?");
    return Nothing{};
}

int RasterSource::width() const
{
    return info().window.width;
}

int RasterSource::height() const
{
    return info().window.height;
}

PostRect RasterSource::extent(int level) const
{
    PostRect result = level <= _ownLastLevel ? _heights->extent().coarser(level) : PostRect();
    for (const auto& far : _surroundings)
        result = result.joinedWith(far->extent(level));
    return result;
}

double RasterSource::heightOrigin() const
{
    return _heights->origin();
}

double RasterSource::northSpacing() const
{
    return _heights->ground().north;
}

double RasterSource::eastSpacing(int row) const
{
    return _heights->eastSpacing(row);
}

const RasterFrame& RasterSource::frame() const
{
    return info().frame;
}

const DemInfo& RasterSource::info() const
{
    return _heights->info();
}

Result<Raster<float>> RasterSource::readPosts(const PostRect& posts)
{
    Result<Raster<float>> heights = _heights->read(posts);
    if (heights)
        if (const Status status = fill(0, CrestAxis::East, posts, *heights); !status)
            return status.error();
    return heights;
}

Result<Raster<float>> RasterSource::readLevel(int level, CrestAxis axis, const PostRect& posts)
{
    assert(level >= 1 && level <= lastLevel());
    Result<Raster<float>> heights = _levels->read(level, axis, posts);
    if (heights)
        if (const Status status = fill(level, axis, posts, *heights); !status)
            return status.error();
    return heights;
}

Status RasterSource::fill(int level, CrestAxis axis, const PostRect& posts, Raster<float>& heights)
{
    // Voids of what is lit are void at all levels: light would depend on which level sees them.
    const PostRect lit{0, 0, (width() - 1) / (1 << level) + 1, (height() - 1) / (1 << level) + 1};
    for (const auto& far : _surroundings)
    {
        const std::vector<float>& ours = heights.values();
        if (posts.clippedTo(far->extent(level)).empty() ||
            std::none_of(ours.begin(), ours.end(), [](float h) { return std::isnan(h); }))
            continue;
        const Result<Raster<float>> theirs = far->read(level, axis, posts);
        if (!theirs)
            return theirs.error();
        for (int row = 0; row < posts.height; ++row)
            for (int column = 0; column < posts.width; ++column)
                if (float& own = heights.at(column, row);
                    std::isnan(own) && !lit.contains(posts.column + column, posts.row + row))
                    own = theirs->at(column, row);
    }
    return Nothing{};
}

} // namespace osgTerrainLight
