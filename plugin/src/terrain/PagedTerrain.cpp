#include "terrain/PagedTerrain.h"

#include "lighting/TileWindows.h"
#include "scene/FadingLod.h"
#include "scene/TerrainTileReader.h"
#include "terrain/DrawnTile.h"

#include <osg/Geometry>
#include <osg/NodeVisitor>
#include <osg/Notify>
#include <osg/PagedLOD>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <new>
#include <utility>

namespace osgTerrainLight
{

namespace
{
/// That a cell of a tile may have on the screen.
constexpr double pixelsPerCell = 2.0;
/// A side of a picture over a tile, and over one that has no finer ones.
constexpr int mostPixels = 512, mostFinestPixels = 2048;

/// Geometry in buffer objects: display lists keep each vertex once per triangle.
class BufferObjects : public osg::NodeVisitor
{
public:
    BufferObjects() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
    void apply(osg::Geometry& geometry) override
    {
        geometry.setUseDisplayList(false);
        geometry.setUseVertexBufferObjects(true);
        parts.push_back({&geometry, osg::computeLocalToWorld(getNodePath())});
    }

    std::vector<TilePart> parts;
};

/// Around a tile whose plane touches the planet in the middle of `there`, its posts that are of the
/// terrain.
osg::ref_ptr<DemData> withOwnPlane(const TileWindows& windows, const PostRect& there)
{
    auto own = std::make_shared<TileWindows>(windows);
    own->middleColumn = there.column + 0.5 * (there.width - 1);
    own->middleRow = there.row + 0.5 * (there.height - 1);
    const osg::Vec2d middle((own->middleColumn - own->place.column) / (own->place.width - 1),
                            (own->middleRow - own->place.row) / (own->place.height - 1));
    return new DemData(std::move(own), middle);
}

/// [m]
double widestCell(const DemTile& dem)
{
    return std::max({dem.eastSpacing(0), dem.eastSpacing(dem.height() - 1),
                     dem.eastSpacing(dem.height() / 2), dem.northSpacing});
}

} // namespace

PagedTerrain::PagedTerrain(std::unique_ptr<OverviewSource> source,
                           std::vector<DrapedColour> colours, HorizonQuality quality,
                           std::optional<Globe> globe)
    : _source(std::move(source)), _colours(std::move(colours)), _quality(quality),
      _globe(std::move(globe))
{
}

osg::BoundingBoxd PagedTerrain::extent() const
{
    if (_globe)
        return _globe->extent(_source->lowest(), _source->highest());
    const RasterFrame& frame = _source->frame();
    const double east = 0.5 * (frame.width - 1) * _source->middleEastSpacing();
    const double north = 0.5 * (frame.height - 1) * _source->northSpacing();
    return {-east, -north, _source->lowest(), east, north, _source->highest()};
}

/// Of a tile, in the frame of the nodes.
osg::Vec3d PagedTerrain::middleOf(const Place& place) const
{
    const PostRect terrain = _source->terrain();
    const double half = 0.5 * _source->cells();
    const double step = std::ldexp(1.0, place.level);
    const double column = step * (place.x * 2.0 * half + half);
    const double row = step * (place.y * 2.0 * half + half);
    return {(column - terrain.column - 0.5 * (terrain.width - 1)) * _source->middleEastSpacing(),
            (row - terrain.row - 0.5 * (terrain.height - 1)) * _source->northSpacing(),
            _source->heightOrigin()};
}

std::vector<ColourImage> PagedTerrain::coloursOf(const Place& place)
{
    const DemTile corners = _source->cornersOf(place.level, _source->placeOf(place.x, place.y));
    std::vector<ColourImage> images;
    for (const DrapedColour& colour : _colours)
    {
        Result<ColourImage> image =
            readColour(colour.path, corners, place.level == 0 ? mostFinestPixels : mostPixels);
        if (image)
        {
            for (std::size_t alpha = 3; alpha < image->pixels.size(); alpha += 4)
                image->pixels[alpha] =
                    static_cast<std::uint8_t>(std::lround(colour.opacity * image->pixels[alpha]));
            images.push_back(std::move(*image));
            continue;
        }
        if (image.error().code == ErrorCode::Elsewhere)
            continue;
        const std::lock_guard<std::mutex> lock(_telling);
        if (_told.insert(colour.path).second)
            OSG_WARN << "osgTerrainLight: left out a picture: " << image.error().message
                     << std::endl;
    }
    return images;
}

/// What is drawn of a tile, with its own light, in the frame of the nodes. there: the posts of it
/// that the raster has.
osg::ref_ptr<osg::MatrixTransform>
PagedTerrain::drawn(const Place& place, const std::shared_ptr<const TileWindows>& windows,
                    const PostRect& there)
{
    const DemTile& dem = windows->tile;
    osg::ref_ptr<osgTerrain::Locator> onGlobe;
    if (_globe)
        onGlobe = _globe->locatorOf(*_source, place.level, windows->place);
    osg::ref_ptr<DemData> data = new DemData(windows);
    if (_globe)
        data = withOwnPlane(*windows, there);
    const osg::ref_ptr<osgTerrain::TerrainTile> terrain =
        drawnTile(dem, std::ldexp(_source->middleEastSpacing(), place.level), data,
                  coloursOf(place), onGlobe);
    terrain->setTileID({_source->root() - place.level, place.x, place.y});
    // Geometry is made here, not in the thread that draws.
    terrain->init(osgTerrain::TerrainTile::ALL_DIRTY, false);
    const double widest = widestCell(dem);
    // A coarser tile's edge is a chord beside the finer one's.
    const double sagitta = _globe ? 2.0 * widest * widest / _globe->radius() : 0.0;
    addSkirt(*terrain, dem, skirtOf(dem) + static_cast<float>(sagitta));
    BufferObjects buffers;
    terrain->accept(buffers);
    if (_globe) // else made in the update traversal
        addTileCoordinates(*terrain, buffers.parts);
    const osg::ref_ptr<osg::MatrixTransform> placed = new osg::MatrixTransform(
        _globe ? osg::Matrixd() : osg::Matrixd::translate(middleOf(place)));
    placed->addChild(terrain);
    return placed;
}

/// About what is drawn of a tile on a plane, and the cells along the longer of its axes' diameters.
PagedTerrain::Sphere PagedTerrain::flatSphere(const Place& place, const DemTile& dem,
                                              const PostRect& posts, const PostRect& there) const
{
    double lowest = std::numeric_limits<double>::max(), highest = -lowest;
    for (int row = 0; row < dem.height(); ++row)
        for (int column = 0; column < dem.width(); ++column)
            if (dem.isValid(column, row))
            {
                lowest = std::min(lowest, double(dem.heightAt(column, row)));
                highest = std::max(highest, double(dem.heightAt(column, row)));
            }
    const double east = std::ldexp(_source->middleEastSpacing(), place.level);
    const double north = std::ldexp(_source->northSpacing(), place.level);
    const osg::Vec3d shift(
        east * (there.column - posts.column + 0.5 * (there.width - 1 - _source->cells())),
        north * (there.row - posts.row + 0.5 * (there.height - 1 - _source->cells())),
        0.5 * (lowest + highest));
    const double flat = 0.5 * std::hypot(east * (there.width - 1), north * (there.height - 1));
    return {middleOf(place) + shift, std::hypot(flat, 0.5 * (highest - lowest)),
            2.0 * flat / std::max(east, north)};
}

/// Null where all of it is void.
Result<osg::ref_ptr<osg::Node>> PagedTerrain::tile(const Place& place)
{
    const PostRect posts = _source->placeOf(place.x, place.y);
    Result<std::shared_ptr<const TileWindows>> windows = [&]
    {
        const std::lock_guard<std::mutex> lock(_reading);
        return readWindows(*_source, place.level, posts, _quality);
    }();
    if (!windows)
        return windows.error();
    const DemTile& dem = (*windows)->tile;
    if (dem.validCount() == 0)
        return osg::ref_ptr<osg::Node>();
    const PostRect there = posts.clippedTo(_source->extent(place.level));
    const osg::ref_ptr<osg::MatrixTransform> placed = drawn(place, *windows, there);
    if (place.level == 0)
        return osg::ref_ptr<osg::Node>(placed);

    Sphere sphere;
    if (_globe)
    {
        const osg::BoundingSphere& bound = placed->getBound();
        const double radius = double(bound.radius());
        sphere = {bound.center(), radius, 2.0 * radius / widestCell(dem)};
    }
    else
        sphere = flatSphere(place, dem, posts, there);
    const osg::ref_ptr<osg::PagedLOD> node = new FadingLod;
    node->setCenterMode(osg::LOD::USER_DEFINED_CENTER);
    node->setCenter(sphere.centre);
    node->setRadius(static_cast<osg::LOD::value_type>(sphere.radius));
    // OSG's pixels are those of the diameter.
    node->setRangeMode(osg::LOD::PIXEL_SIZE_ON_SCREEN);
    const float pixels = static_cast<float>(pixelsPerCell * sphere.cells);
    node->addChild(placed, 0.0f, pixels);
    node->setFileName(1, std::to_string(place.level) + "/" + std::to_string(place.x) + "/" +
                             std::to_string(place.y));
    node->setRange(1, pixels, std::numeric_limits<float>::max());
    const osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
    options->setReadFileCallback(this);
    options->setObjectCacheHint(osgDB::Options::CACHE_NONE);
    node->setDatabaseOptions(options);
    return osg::ref_ptr<osg::Node>(node);
}

Result<osg::ref_ptr<osg::Node>> PagedTerrain::root()
{
    return tile({_source->root(), 0, 0});
}

osgDB::ReaderWriter::ReadResult PagedTerrain::readNode(const std::string& name,
                                                       const osgDB::Options*)
{
    using ReadResult = osgDB::ReaderWriter::ReadResult;
    Place parent{};
    if (std::sscanf(name.c_str(), "%d/%d/%d", &parent.level, &parent.x, &parent.y) != 3 ||
        parent.level < 1)
        return ReadResult::FILE_NOT_FOUND;
    try
    {
        const osg::ref_ptr<osg::Group> children = new osg::Group;
        for (const int y : {0, 1})
            for (const int x : {0, 1})
            {
                const Result<osg::ref_ptr<osg::Node>> child =
                    tile({parent.level - 1, 2 * parent.x + x, 2 * parent.y + y});
                if (!child)
                    return ReadResult(child.error().message);
                if (*child)
                    children->addChild(*child);
            }
        return ReadResult(children.get());
    }
    catch (const std::bad_alloc&)
    {
        return ReadResult("not enough memory for terrain tile " + name);
    }
}

} // namespace osgTerrainLight
