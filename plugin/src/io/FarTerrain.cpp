#include "io/FarTerrain.h"

#include "io/Bilinear.h"
#include "io/FarSampler.h"
#include "io/GdalErrors.h"
#include "io/LevelBuilder.h"
#include "io/LevelCache.h"

#include <cpl_string.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace osgTerrainLight
{
namespace
{
/// Places that an extent is found by: along each side of a rectangle.
constexpr int lattice = 65;

double latticeStep(int count)
{
    return static_cast<double>(count - 1) / (lattice - 1);
}
} // namespace

/// Smallest rectangle around places.
struct FarTerrain::Box
{
    double west = std::numeric_limits<double>::infinity();
    double east = -std::numeric_limits<double>::infinity();
    double south = std::numeric_limits<double>::infinity();
    double north = -std::numeric_limits<double>::infinity();

    void add(double x, double y, double marginX, double marginY)
    {
        west = std::min(west, x - marginX);
        east = std::max(east, x + marginX);
        south = std::min(south, y - marginY);
        north = std::max(north, y + marginY);
    }
    /// The posts or pixels in it, within a rectangle.
    PostRect inside(const PostRect& limits) const
    {
        if (!(east >= limits.column && north >= limits.row && west < limits.endColumn() &&
              south < limits.endRow()))
            return {};
        PostRect result;
        result.column = static_cast<int>(std::max(std::floor(west), 1.0 * limits.column));
        result.row = static_cast<int>(std::max(std::floor(south), 1.0 * limits.row));
        result.width = static_cast<int>(std::min(std::ceil(east) + 1.0, 1.0 * limits.endColumn())) -
                       result.column;
        result.height =
            static_cast<int>(std::min(std::ceil(north) + 1.0, 1.0 * limits.endRow())) - result.row;
        return result;
    }
};

Result<std::unique_ptr<FarTerrain>> FarTerrain::open(const std::string& path,
                                                     const RasterHeights& near, double reach)
{
    GdalErrors errors;
    Result<OpenDem> opened = openDem(path, {}, false, errors);
    if (!opened)
        return opened.error();
    std::unique_ptr<FarTerrain> made(new FarTerrain);
    made->_path = path;
    made->_near = &near;
    made->_dem = std::move(*opened);
    const RasterFrame& frame = near.info().frame;
    const DemInfo& info = made->_dem.info;
    if (!frame.hasGeoTransform)
        return Error{ErrorCode::Invalid, near.path() + ": has no geotransform, so no surroundings "
                                                       "can be placed around it"};
    if (frame.crs.empty() != info.frame.crs.empty())
        return Error{ErrorCode::Invalid, (frame.crs.empty() ? near.path() : path) +
                                             ": has no CRS, but " +
                                             (frame.crs.empty() ? path : near.path()) +
                                             " has one; needed both or none"};
    if (frame.crs.empty())
        made->_notes.push_back("no CRS: map coordinates are taken as those of " + near.path());
    made->_toPixels =
        PostsToPixels::between(frame, near.crs(), info.frame, made->_dem.dataset->GetSpatialRef());
    if (!made->_toPixels)
        return Error{ErrorCode::Invalid, path + ": there is no way from CRS \"" +
                                             near.info().crsName + "\" to \"" + info.crsName +
                                             "\" (" + errors.first() + ")"};
    made->_reader = std::make_unique<HeightReader<double>>(made->_dem);
    // A tenth for rounding, and for spacings that differ within the raster.
    made->_base = std::clamp(static_cast<int>(std::log2(made->postDistance() * 1.1)), 0, 24);
    made->findExtent(reach);
    if (!made->_extent.empty() && made->surroundedPixels().width == 0)
        made->_extent = {};
    if (made->_extent.empty())
        made->_notes.push_back("has no terrain within " + std::string(CPLSPrintf("%.10g", reach)) +
                               " m of " + near.path() + ": not used");
    return made;
}

/// Of its own, where the middle of what is lit lies, in posts of that, ≥ 1.
double FarTerrain::postDistance() const
{
    const DemInfo& near = _near->info();
    const double column = 0.5 * (near.window.width - 1);
    const double row = 0.5 * (near.window.height - 1);
    const double nearSpacing = std::max(near.eastSpacing, near.northSpacing);
    const PostsToPixels::Places here = _toPixels->row(column, 1.0, 2, row);
    if (_dem.info.geographic && !std::isnan(here.y[0]))
    {
        // Meridians meet at a pole, where columns do not tell more than rows do.
        const DegreeRows degrees(*_dem.dataset->GetSpatialRef(), _dem.info.frame);
        const RasterFrame& frame = _dem.info.frame;
        const double at = frame.northUp ? frame.height - 1 - here.y[0] : here.y[0];
        const double north = degrees.north(at);
        return std::max(1.0, std::clamp(degrees.east(at), 0.25 * north, north) / nearSpacing);
    }
    const PostsToPixels::Places there = _toPixels->row(column, 1.0, 1, row + 1.0);
    const double posts = 1.0 / std::max(std::hypot(here.x[1] - here.x[0], here.y[1] - here.y[0]),
                                        std::hypot(there.x[0] - here.x[0], there.y[0] - here.y[0]));
    if (std::isfinite(posts))
        return std::max(1.0, posts);
    // The map does not show that place: by its own middle.
    return std::max(1.0, std::min(_dem.info.eastSpacing, _dem.info.northSpacing) / nearSpacing);
}

void FarTerrain::findExtent(double reach)
{
    PostRect limits = _near->within(reach);
    const double half = _toPixels->halfTurnOfPosts();
    if (half > 0.0 && limits.width > 2.0 * half)
    {
        limits.column = static_cast<int>(0.5 * _near->info().window.width - half);
        limits.width = static_cast<int>(2.0 * half);
    }
    Box box;
    // A map that does not show all of it, or shows it in two parts, is asked the other way round.
    if (!addOutline(box) || _toPixels->isWholeTurn())
        addSeen(box, limits);
    _extent = box.inside(limits).coarser(_base);
}

/// Where the raster's own pixels lie. False where some have no place.
bool FarTerrain::addOutline(Box& box) const
{
    const double margin = std::ldexp(2.0, _base);
    bool isWhole = true;
    for (int j = 0; j < lattice; ++j)
    {
        PostsToPixels::Places line;
        for (int i = 0; i < lattice; ++i)
        {
            line.x.push_back(-0.5 + static_cast<double>(_dem.info.rasterWidth) * i / (lattice - 1));
            line.y.push_back(-0.5 +
                             static_cast<double>(_dem.info.rasterHeight) * j / (lattice - 1));
        }
        const PostsToPixels::Places places = _toPixels->posts(line);
        for (std::size_t i = 0; i < places.x.size(); ++i)
            if (std::isnan(places.x[i]))
                isWhole = false;
            else
                box.add(places.x[i], places.y[i], margin, margin);
    }
    return isWhole;
}

/// Posts within limits, not all of them, that lie in the raster.
void FarTerrain::addSeen(Box& box, const PostRect& limits) const
{
    const double stepX = latticeStep(limits.width);
    const double stepY = latticeStep(limits.height);
    for (int j = 0; j < lattice; ++j)
    {
        const double row = limits.row + stepY * j;
        const PostsToPixels::Places places = _toPixels->row(limits.column, stepX, lattice, row);
        for (int i = 0; i < lattice; ++i)
        {
            const double x = places.x[static_cast<std::size_t>(i)];
            const double y = places.y[static_cast<std::size_t>(i)];
            if (x >= -0.5 && x <= _dem.info.rasterWidth - 0.5 && y >= -0.5 &&
                y <= _dem.info.rasterHeight - 0.5)
                box.add(limits.column + stepX * i, row, stepX, stepY);
        }
    }
}

PostRect FarTerrain::extent(int level) const
{
    if (level >= _base)
        return _extent.coarser(level - _base);
    const int posts = 1 << (_base - level);
    return _extent.empty()
               ? PostRect()
               : PostRect{_extent.column * posts, _extent.row * posts,
                          (_extent.width - 1) * posts + 1, (_extent.height - 1) * posts + 1};
}

/// All that may be sampled for the extent.
PixelWindow FarTerrain::surroundedPixels() const
{
    const double step = std::ldexp(1.0, _base);
    const double stepX = step * latticeStep(_extent.width);
    const double stepY = step * latticeStep(_extent.height);
    std::vector<PostsToPixels::Places> rows; // with one more on each side, since edges are bent
    for (int j = -1; j <= lattice; ++j)
        rows.push_back(_toPixels->row(step * _extent.column - stepX, stepX, lattice + 2,
                                      step * _extent.row + stepY * j));
    const PixelWindow whole{0, 0, _dem.info.rasterWidth, _dem.info.rasterHeight};
    const PixelWindow found = pixelsAround(rows, whole);
    PostRect pixels{found.column, found.row, found.width, found.height};
    if (pixels.empty())
        return {};
    pixels = pixels.grownBy(2).clippedTo({0, 0, whole.width, whole.height});
    return {pixels.column, pixels.row, pixels.width, pixels.height};
}

Status FarTerrain::openLevels(int lastLevel, const std::string& folder,
                              const std::function<bool(double)>& progress)
{
    const DemInfo& near = _near->info();
    const RasterFrame& frame = near.frame;
    std::string contents = "surroundings of " + frame.crs;
    for (const double value : frame.geoTransform)
        contents += CPLSPrintf(" %.17g", value);
    contents += CPLSPrintf(" %d %d %d %.17g %d", frame.width, frame.height, lastLevel,
                           _near->origin(), _base);
    for (const int value : {_extent.column, _extent.row, _extent.width, _extent.height})
        contents += " " + std::to_string(value);
    // Two rasters with the same surroundings keep one each.
    const std::string variant =
        CPLSPrintf("-%08x", static_cast<unsigned>(checksumOf(_near->path()) & 0xffffffffu));
    const LevelCache cache{_path, folder, variant, contents};
    const LevelBuilder builder(_extent, _base, lastLevel, true);
    Result<std::unique_ptr<LevelFile>> levels = osgTerrainLight::openLevels(
        cache, builder.planes(), _notes,
        [&](LevelFileWriter& writer) { return build(writer, lastLevel, progress); });
    if (!levels)
        return levels.error();
    _levels = std::move(*levels);
    const std::vector<std::string>& notes = _levels->facts().notes;
    _notes.insert(_notes.end(), _dem.info.notes.begin(), _dem.info.notes.end());
    _notes.insert(_notes.end(), notes.begin(), notes.end());
    return Nothing{};
}

Result<LevelFacts> FarTerrain::build(LevelFileWriter& writer, int lastLevel,
                                     const std::function<bool(double)>& progress)
{
    const auto upTo = [&progress](double from, double to)
    {
        return [&progress, from, to](double done)
        { return !progress || progress(from + (to - from) * done); };
    };
    const PixelWindow window = surroundedPixels();
    std::vector<double> strip(static_cast<std::size_t>(_reader->stripRows(window)) *
                              static_cast<std::size_t>(window.width));
    GdalErrors errors;
    const auto see = [&](const PixelWindow& rows)
    { return _reader->read(rows, strip.data(), true); };
    if (auto error = _reader->eachStrip(window, false, _path, errors, upTo(0.0, 0.3), see))
        return *error;
    Result<HeightRules> rules = _reader->rules(_path, window);
    if (!rules)
        return rules.error();
    strip = {};

    FarSampler sampler(_path, *_reader, _dem.info, *rules, window, *_toPixels, *_near);
    LevelBuilder builder(_extent, _base, lastLevel, true);
    builder.begin(writer);
    const int most = std::clamp((1 << 22) / _extent.width, 1, 256);
    std::vector<float> heights(static_cast<std::size_t>(most) *
                               static_cast<std::size_t>(_extent.width));
    const auto report = upTo(0.3, 1.0);
    for (PostRect rows = _extent; rows.row < _extent.endRow(); rows.row += rows.height)
    {
        rows.height = std::min(most, _extent.endRow() - rows.row);
        if (auto error = sampler.sample(_base, rows, heights.data()))
            return *error;
        for (int row = 0; row < rows.height; ++row)
            if (!builder.addRow(heights.data() + static_cast<std::size_t>(row) *
                                                     static_cast<std::size_t>(rows.width)))
                return Error{ErrorCode::Failed, _path + ": its levels cannot be written"};
        if (!report(static_cast<double>(rows.endRow() - _extent.row) / _extent.height))
            return Error{ErrorCode::Failed, _path + ": reading was cancelled"};
    }
    LevelFacts facts;
    facts.rules = *rules;
    std::tie(facts.lowest, facts.highest) =
        std::minmax({rules->heightOf(rules->lowest), rules->heightOf(rules->highest)});
    facts.notes = _reader->notes();
    return facts;
}

Result<Raster<float>> FarTerrain::read(int level, CrestAxis axis, const PostRect& posts)
{
    if (level >= _base)
        return _levels->read(level, axis, posts);
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height),
                         std::numeric_limits<float>::quiet_NaN());
    const PostRect inside = posts.clippedTo(extent(level));
    if (inside.empty())
        return result;
    const int finer = _base - level;
    const PostRect coarse = inside.coarser(finer);
    const Result<Raster<float>> own = _levels->read(_base, axis, coarse);
    if (!own)
        return own.error();
    const auto at = [&own](int column, int row) { return own->at(column, row); };
    for (int row = inside.row; row < inside.endRow(); ++row)
        for (int column = inside.column; column < inside.endColumn(); ++column)
            result.at(column - posts.column, row - posts.row) = static_cast<float>(
                bilinear(std::ldexp(column, -finer) - coarse.column,
                         std::ldexp(row, -finer) - coarse.row, coarse.width, coarse.height, at));
    return result;
}

} // namespace osgTerrainLight
