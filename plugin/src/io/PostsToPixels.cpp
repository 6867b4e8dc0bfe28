#include "io/PostsToPixels.h"

#include <gdal_alg.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = 3.14159265358979323846;

/// Columns around the whole body; 0 where the map is not of degrees.
double turnOf(const OGRSpatialReference* crs, double step)
{
    return crs && crs->IsGeographic() ? 2.0 * pi / crs->GetAngularUnits() / std::abs(step) : 0.0;
}

/// The value, or one that is whole turns away, nearest to the middle.
double nearest(double value, double middle, double turn)
{
    return turn > 0.0 ? value + turn * std::round((middle - value) / turn) : value;
}

/// Map coordinates to others in place; NaN where there are none.
void transform(void* transformer, bool back, PostsToPixels::Places& places)
{
    if (!transformer)
        return;
    const std::size_t count = places.x.size();
    std::vector<double> heights(count, 0.0);
    std::vector<int> found(count, 0);
    const auto function = back ? GDALReprojectionTransform : GDALApproxTransform;
    function(transformer, back ? 1 : 0, static_cast<int>(count), places.x.data(), places.y.data(),
             heights.data(), found.data());
    for (std::size_t i = 0; i < count; ++i)
        if (found[i] == 0 || !std::isfinite(places.x[i]) || !std::isfinite(places.y[i]))
            places.x[i] = places.y[i] = missing;
}
} // namespace

void PostsToPixels::Release::operator()(void* transformer) const
{
    GDALDestroyTransformer(transformer);
}

std::optional<PostsToPixels> PostsToPixels::between(const RasterFrame& posts,
                                                    const OGRSpatialReference* crsOfPosts,
                                                    const RasterFrame& raster,
                                                    const OGRSpatialReference* crsOfRaster)
{
    PostsToPixels made;
    made._frame = posts;
    made._transform = raster.geoTransform;
    made._width = raster.width;
    made._turn = turnOf(crsOfRaster, made._transform[1]);
    made._turnOfPosts = turnOf(crsOfPosts, posts.geoTransform[1]);
    if (!crsOfRaster || !crsOfPosts)
        return made;
    const auto handle = [](const OGRSpatialReference* reference)
    { return OGRSpatialReference::ToHandle(const_cast<OGRSpatialReference*>(reference)); };
    made._exact.reset(
        GDALCreateReprojectionTransformerEx(handle(crsOfPosts), handle(crsOfRaster), nullptr));
    if (!made._exact)
        return std::nullopt;
    constexpr double tolerance = 0.01; // of a pixel
    made._quick.reset(GDALCreateApproxTransformer(
        GDALReprojectionTransform, made._exact.get(),
        tolerance * std::min(std::abs(made._transform[1]), std::abs(made._transform[5]))));
    return made;
}

PostsToPixels::Places PostsToPixels::row(double firstColumn, double step, int count,
                                         double row) const
{
    Places places;
    for (int i = 0; i < count; ++i)
        places.x.push_back(_frame.mapX(firstColumn + step * i));
    places.y.assign(places.x.size(), _frame.mapY(row));
    transform(_quick.get(), false, places);
    for (std::size_t i = 0; i < places.x.size(); ++i)
    {
        const double x = (places.x[i] - _transform[0]) / _transform[1] - 0.5;
        places.x[i] = nearest(x, 0.5 * (_width - 1), _turn);
        places.y[i] = (places.y[i] - _transform[3]) / _transform[5] - 0.5;
    }
    return places;
}

PostsToPixels::Places PostsToPixels::posts(const Places& pixels) const
{
    Places places = pixels;
    for (std::size_t i = 0; i < places.x.size(); ++i)
    {
        places.x[i] = _transform[0] + (pixels.x[i] + 0.5) * _transform[1];
        places.y[i] = _transform[3] + (pixels.y[i] + 0.5) * _transform[5];
    }
    transform(_exact.get(), true, places);
    const auto& t = _frame.geoTransform;
    for (std::size_t i = 0; i < places.x.size(); ++i)
    {
        const double column = (places.x[i] - t[0]) / t[1] - 0.5;
        const double row = (places.y[i] - t[3]) / t[5] - 0.5;
        places.x[i] = nearest(_frame.westFirst ? column : _frame.width - 1 - column,
                              0.5 * (_frame.width - 1), _turnOfPosts);
        places.y[i] = _frame.northUp ? _frame.height - 1 - row : row;
    }
    return places;
}

} // namespace osgTerrainLight
