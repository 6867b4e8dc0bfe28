#include "scene/TerrainTileReader.h"

#include "io/AlbedoFile.h"

#include "io/GroundSpacing.h"
#include "lighting/TileWindows.h"

#include <osgTerrain/Layer>
#include <osgTerrain/Locator>
#include <osgTerrain/Terrain>

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{

namespace
{
/// Places on a tile, in the frame of TerrainLighting.
class Placement
{
public:
    Placement(const osgTerrain::Locator& locator, const osg::Matrixd& toScene)
        : _locator(locator), _toScene(toScene)
    {
    }

    osg::Vec3d at(double u, double v, double height = 0.0) const
    {
        osg::Vec3d model;
        _locator.convertLocalToModel(osg::Vec3d(u, v, height), model);
        return model * _toScene;
    }

private:
    const osgTerrain::Locator& _locator;
    const osg::Matrixd& _toScene;
};

/// The rotation to axes east, north and up, from those in which two of them are given.
osg::Matrixd rotationTo(osg::Vec3d east, osg::Vec3d up)
{
    up.normalize();
    east -= up * (east * up);
    east.normalize();
    const osg::Vec3d north = up ^ east;
    return osg::Matrixd(east.x(), north.x(), up.x(), 0.0, east.y(), north.y(), up.y(), 0.0,
                        east.z(), north.z(), up.z(), 0.0, 0.0, 0.0, 0.0, 1.0);
}

/// True where v points along axis within a thousandth.
bool isAlong(osg::Vec3d v, const osg::Vec3d& axis)
{
    v.normalize();
    return v * axis > 1.0 - 5.0e-7;
}

/// Spacings of posts [m]; false where the tile does not lie as the lighting takes it.
bool measure(const osgTerrain::Locator& locator, const Placement& place, DemTile& dem)
{
    const double du = 1.0 / std::max(1, dem.width() - 1);
    const double dv = 1.0 / std::max(1, dem.height() - 1);
    const osg::Vec3d east = place.at(1.0, 0.5) - place.at(0.0, 0.5);
    const osg::Vec3d north = place.at(0.5, 1.0) - place.at(0.5, 0.0);
    if (!(east.length() > 0.0 && north.length() > 0.0))
        return false;
    if (locator.getCoordinateSystemType() == osgTerrain::Locator::GEOCENTRIC)
    {
        const double u = 0.5 - 0.5 * du;
        const double v = 0.5 - 0.5 * dv;
        dem.northSpacing = (place.at(0.5, v + dv) - place.at(0.5, v)).length();
        dem.eastSpacings.resize(static_cast<std::size_t>(dem.height()));
        for (int row = 0; row < dem.height(); ++row)
            dem.eastSpacings[static_cast<std::size_t>(row)] =
                (place.at(u + du, row * dv) - place.at(u, row * dv)).length();
    }
    else
    {
        if (!isAlong(east, {1.0, 0.0, 0.0}) || !isAlong(north, {0.0, 1.0, 0.0}))
            return false;
        dem.northSpacing = north.length() * dv;
        dem.eastSpacings = {east.length() * du};
        if (locator.getCoordinateSystemType() == osgTerrain::Locator::GEOGRAPHIC) // radians
        {
            const osg::EllipsoidModel* body = locator.getEllipsoidModel();
            const double a = body ? body->getRadiusEquator() : osg::WGS_84_RADIUS_EQUATOR;
            const double b = body ? body->getRadiusPolar() : osg::WGS_84_RADIUS_POLAR;
            dem.northSpacing *= metresPerRadian(place.at(0.5, 0.5).y(), a, b).north;
            dem.eastSpacings.assign(static_cast<std::size_t>(dem.height()), east.length() * du);
            for (int row = 0; row < dem.height(); ++row)
                dem.eastSpacings[static_cast<std::size_t>(row)] *=
                    metresPerRadian(place.at(0.5, row * dv).y(), a, b).east;
        }
    }
    return std::all_of(dem.eastSpacings.begin(), dem.eastSpacings.end(),
                       [](double spacing) { return spacing > 0.0; });
}

osg::Vec2 tileCoordinate(const osgTerrain::Locator& locator, const osg::Matrixd& toTile,
                         const osg::Vec3d& vertex)
{
    osg::Vec3d local;
    locator.convertModelToLocal(vertex * toTile, local);
    return {static_cast<float>(local.x()), static_cast<float>(local.y())};
}
} // namespace

const DemTile& DemData::tile() const
{
    return _windows ? _windows->tile : _tile;
}

Result<TerrainHeights> readTerrainTile(osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene)
{
    osgTerrain::Layer* layer = tile.getElevationLayer();
    const osgTerrain::Locator* locator = layer ? layer->getLocator() : nullptr;
    if (!locator)
        return Error{ErrorCode::NotSupported, "its elevation layer has no locator"};
    const int width = static_cast<int>(layer->getNumColumns());
    const int height = static_cast<int>(layer->getNumRows());
    if (width < 2 || height < 2)
        return Error{ErrorCode::Invalid, "it has " + std::to_string(width) + " x " +
                                             std::to_string(height) + " posts; needs 2 x 2"};

    const auto* terrain = tile.getTerrain();
    const Placement place(*locator, toScene);
    const bool geocentric = locator->getCoordinateSystemType() == osgTerrain::Locator::GEOCENTRIC;
    const osg::Vec3d up = place.at(0.5, 0.5, 1.0) - place.at(0.5, 0.5);
    const double metresPerHeight =
        up.length() * (terrain ? static_cast<double>(terrain->getVerticalScale()) : 1.0);
    const auto* data = dynamic_cast<const DemData*>(tile.getUserData());
    // Geocentric coordinates are as far from the planet's middle as doubles tell a micrometre.
    if (data && std::abs(metresPerHeight - 1.0) <= (geocentric ? 1.0e-6 : 0.0) &&
        layer->getModifiedCount() == 0)
    {
        TerrainHeights heights{data->tile(), data->windows()};
        if (geocentric)
        {
            const double u = data->middle().x(), v = data->middle().y();
            heights.turn = rotationTo(place.at(u + 0.01, v) - place.at(u - 0.01, v),
                                      place.at(u, v, 1000.0) - place.at(u, v));
        }
        return heights;
    }

    DemTile dem(width, height, 1.0);
    if (!measure(*locator, place, dem) || (!geocentric && !isAlong(up, {0.0, 0.0, 1.0})))
        return Error{ErrorCode::NotSupported,
                     "its locator or a transform above turns it; needs rows to the east, columns "
                     "to the north and heights up"};

    std::vector<double> heights(dem.postCount(), std::numeric_limits<double>::quiet_NaN());
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            float value = 0.0f;
            if (!layer->getValidValue(static_cast<unsigned>(column), static_cast<unsigned>(row),
                                      value) ||
                !std::isfinite(value))
                continue;
            const double metres = static_cast<double>(value) * metresPerHeight;
            heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column)] = metres;
            lowest = std::min(lowest, metres);
            highest = std::max(highest, metres);
        }
    if (!(lowest <= highest))
        return Error{ErrorCode::Invalid, "all of its posts are void"};
    dem.heightOrigin = std::round(0.5 * (lowest + highest));
    std::size_t i = 0;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column, ++i)
            if (!std::isnan(heights[i]))
                dem.setHeight(column, row, static_cast<float>(heights[i] - dem.heightOrigin));
    return TerrainHeights{std::move(dem), nullptr};
}

std::optional<PlacedGround> placeTerrainTile(const osgTerrain::TerrainTile& tile,
                                             const osg::Matrixd& toScene, const DemTile& dem)
{
    const auto* data = dynamic_cast<const DemData*>(tile.getUserData());
    const osgTerrain::Layer* layer = tile.getElevationLayer();
    if (!layer || !layer->getLocator() || (data && data->windows()))
        return std::nullopt;
    const osgTerrain::Locator& locator = *layer->getLocator();
    PlacedGround ground;
    osg::Vec3d corner, opposite;
    if (locator.getCoordinateSystemType() == osgTerrain::Locator::PROJECTED)
    {
        const Placement place(locator, toScene);
        corner = place.at(0.0, 0.0);
        opposite = place.at(1.0, 1.0);
        // A height field of a DemTile is above its heightOrigin already.
        ground.patch.lift = corner.z() - (data ? dem.heightOrigin : 0.0);
    }
    else
    {
        corner = osg::Vec3d(0.0, 0.0, 0.0) * locator.getTransform(); // longitude, latitude
        opposite = osg::Vec3d(1.0, 1.0, 0.0) * locator.getTransform();
        const osg::EllipsoidModel* body = locator.getEllipsoidModel();
        ground.semiMajor = body ? body->getRadiusEquator() : osg::WGS_84_RADIUS_EQUATOR;
        ground.semiMinor = body ? body->getRadiusPolar() : osg::WGS_84_RADIUS_POLAR;
        ground.toScene = toScene;
    }
    TerrainPatch& patch = ground.patch;
    patch.west = corner.x();
    patch.south = corner.y();
    patch.eastStep = (opposite.x() - corner.x()) / std::max(1, dem.width() - 1);
    patch.northStep = (opposite.y() - corner.y()) / std::max(1, dem.height() - 1);
    if (!(patch.eastStep > 0.0 && patch.northStep > 0.0))
        return std::nullopt;
    patch.dem = std::make_shared<const DemTile>(dem);
    return ground;
}

std::optional<osg::Vec3d> cornerOf(const osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene,
                                   const DemTile& dem)
{
    const osgTerrain::Layer* layer = tile.getElevationLayer();
    const osgTerrain::Locator* locator = layer ? layer->getLocator() : nullptr;
    if (!locator || locator->getCoordinateSystemType() != osgTerrain::Locator::PROJECTED)
        return std::nullopt;
    osg::Vec3d corner = Placement(*locator, toScene).at(0.0, 0.0);
    // A height field of a DemTile is above its heightOrigin already.
    if (dynamic_cast<const DemData*>(tile.getUserData()))
        corner.z() -= dem.heightOrigin;
    return corner;
}

osg::Vec2d drawnSpacing(const osgTerrain::TerrainTile& tile, const osg::Matrixd& toScene,
                        const DemTile& dem)
{
    const Placement place(*tile.getElevationLayer()->getLocator(), toScene);
    const osg::Vec3d size = place.at(1.0, 1.0) - place.at(0.0, 0.0);
    return {size.x() / std::max(1, dem.width() - 1), size.y() / std::max(1, dem.height() - 1)};
}

std::optional<ShadingCoordinates> affineCoordinates(const osgTerrain::TerrainTile& tile,
                                                    const std::vector<TilePart>& parts)
{
    const osgTerrain::Locator& locator = *tile.getElevationLayer()->getLocator();
    // One matrix for all of the tile's geometry.
    const osg::Matrixd toTile = parts.empty() ? osg::Matrixd() : parts.front().toTile;
    for (const TilePart& part : parts)
        if (part.toTile != toTile)
            return std::nullopt;

    osg::Vec3d corner, opposite;
    locator.convertLocalToModel(osg::Vec3d(0.0, 0.0, 0.0), corner);
    locator.convertLocalToModel(osg::Vec3d(1.0, 1.0, 0.0), opposite);
    const double reach = (opposite - corner).length();
    const osg::Vec3d centre = (corner + opposite) * 0.5 * osg::Matrixd::inverse(toTile);
    const auto local = [&](const osg::Vec3d& vertex)
    {
        osg::Vec3d result;
        locator.convertModelToLocal(vertex * toTile, result);
        return result;
    };
    const osg::Vec3d middle = local(centre);
    osg::Vec3d step[3];
    const osg::Vec3d axes[3] = {{reach, 0.0, 0.0}, {0.0, reach, 0.0}, {0.0, 0.0, reach}};
    for (int i = 0; i < 3; ++i)
        step[i] = (local(centre + axes[i]) - middle) / reach;
    ShadingCoordinates coordinates;
    coordinates.source = ShadingCoordinates::Source::Vertex;
    coordinates.toTile =
        osg::Matrixd::translate(-centre) *
        osg::Matrixd(step[0].x(), step[0].y(), 0.0, 0.0, step[1].x(), step[1].y(), 0.0, 0.0,
                     step[2].x(), step[2].y(), 1.0, 0.0, middle.x(), middle.y(), 0.0, 1.0);
    // Held to a hundredth of a post at places that the fit has not seen.
    const double posts =
        std::max(tile.getElevationLayer()->getNumColumns(), tile.getElevationLayer()->getNumRows());
    for (const osg::Vec3d& place : {osg::Vec3d(0.0, 0.0, 0.0), osg::Vec3d(1.0, 1.0, 0.0),
                                    osg::Vec3d(0.0, 1.0, 1000.0), osg::Vec3d(1.0, 0.0, 0.0)})
    {
        osg::Vec3d model;
        locator.convertLocalToModel(place, model);
        const osg::Vec3d found = model * osg::Matrixd::inverse(toTile) * coordinates.toTile;
        if (!(std::abs(found.x() - place.x()) * posts < 0.01 &&
              std::abs(found.y() - place.y()) * posts < 0.01))
            return std::nullopt;
    }
    return coordinates;
}

osg::Matrixd tileFrame(const osgTerrain::TerrainTile& tile, const std::vector<TilePart>& parts)
{
    const osgTerrain::Locator& locator = *tile.getElevationLayer()->getLocator();
    const auto place = [&](double u, double v, double height)
    {
        osg::Vec3d model;
        locator.convertLocalToModel(osg::Vec3d(u, v, height), model);
        return model;
    };
    osg::Vec3d east = place(0.51, 0.5, 0.0) - place(0.49, 0.5, 0.0);
    osg::Vec3d up = place(0.5, 0.5, 1.0) - place(0.5, 0.5, 0.0);
    if (!parts.empty())
    {
        const osg::Matrixd fromTile = osg::Matrixd::inverse(parts.front().toTile);
        east = osg::Matrixd::transform3x3(east, fromTile);
        up = osg::Matrixd::transform3x3(up, fromTile);
    }
    return rotationTo(east, up);
}

void addTileCoordinates(const osgTerrain::TerrainTile& tile, const std::vector<TilePart>& parts)
{
    const osgTerrain::Locator& locator = *tile.getElevationLayer()->getLocator();
    for (const TilePart& part : parts)
    {
        const auto* vertices = dynamic_cast<const osg::Vec3Array*>(part.geometry->getVertexArray());
        if (!vertices || part.geometry->getTexCoordArray(ShadingTexture::coordinateSet))
            continue;
        osg::ref_ptr<osg::Vec2Array> coordinates = new osg::Vec2Array;
        coordinates->reserve(vertices->size());
        for (const osg::Vec3& vertex : *vertices)
            coordinates->push_back(tileCoordinate(locator, part.toTile, vertex));
        part.geometry->setTexCoordArray(ShadingTexture::coordinateSet, coordinates,
                                        osg::Array::BIND_PER_VERTEX);
    }
}

const osg::Image* pictureOf(const osgTerrain::TerrainTile& tile, int layer)
{
    const bool exists = layer >= 0 && static_cast<unsigned>(layer) < tile.getNumColorLayers();
    const osgTerrain::Layer* found =
        exists ? tile.getColorLayer(static_cast<unsigned>(layer)) : nullptr;
    // A contour layer's image is a ramp of colours over height, not a picture.
    return found && !dynamic_cast<const osgTerrain::ContourLayer*>(found) ? found->getImage()
                                                                          : nullptr;
}

bool hasColour(const osgTerrain::TerrainTile& tile)
{
    return pictureOf(tile, 0) != nullptr;
}

namespace
{
/// A value per post from the colour, 0 … 1, of the layer's nearest texel; empty where it cannot be
/// read.
template <class T, class F>
Raster<T> readPosts(const osgTerrain::TerrainTile& tile, int layer, int width, int height,
                    F&& valueOf)
{
    const osg::Image* image = pictureOf(tile, layer);
    // osg::Image reads all others as white.
    const GLenum readable[] = {
        GL_RGB, GL_RGBA, GL_BGR, GL_BGRA, GL_LUMINANCE, GL_LUMINANCE_ALPHA, GL_INTENSITY};
    if (!image || !image->data() || image->s() < 1 || image->t() < 1 ||
        std::find(std::begin(readable), std::end(readable), image->getPixelFormat()) ==
            std::end(readable))
        return {};
    const bool bytes = image->getDataType() == GL_UNSIGNED_BYTE;
    Raster<T> posts(width, height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            // Of the image's texels the outermost reach to the tile's edges.
            const auto texel = [](int post, int count, int texels)
            { return std::min(texels - 1, (2 * post + 1) * texels / (2 * count)); };
            osg::Vec4 colour =
                image->getColor(static_cast<unsigned>(texel(column, width, image->s())),
                                static_cast<unsigned>(texel(row, height, image->t())));
            for (unsigned c = 0; c < 3; ++c)
                colour[c] = std::clamp(colour[c], 0.0f, 1.0f);
            posts.at(column, row) = valueOf(colour, bytes);
        }
    return posts;
}
} // namespace

Raster<Rgb> readTerrainAlbedo(const osgTerrain::TerrainTile& tile, int width, int height)
{
    return readPosts<Rgb>(tile, 0, width, height,
                          [](const osg::Vec4& colour, bool encoded)
                          {
                              Rgb albedo{};
                              for (unsigned c = 0; c < 3; ++c)
                                  albedo[c] = encoded ? linearOfSrgb(colour[c]) : colour[c];
                              return albedo;
                          });
}

Raster<std::array<float, 2>> readTerrainGloss(const osgTerrain::TerrainTile& tile, int layer,
                                              int width, int height)
{
    return readPosts<std::array<float, 2>>(
        tile, layer, width, height,
        [](const osg::Vec4& colour, bool) {
            return std::array<float, 2>{colour.r(), std::max(1.0f, 64.0f * colour.g())};
        });
}

} // namespace osgTerrainLight
