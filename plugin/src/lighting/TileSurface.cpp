#include "lighting/TileSurface.h"

#include "glsl_host.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"
#include "lighting/TileWindows.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr int guard = 2; ///< void texels around posts, so that no read leaves them
const float voidHeight = Glsl<float>::VOID_HEIGHT;
} // namespace

TileSurface::TileSurface(const DemTile& tile, int frame, double bodyRadius, bool changing)
    : _tile(tile), _frame(frame), _bodyRadius(bodyRadius), _isChanging(changing),
      // Those that a pass writes have no image: it would be loaded in their place.
      _heights(own(
          changing ? new Resource("heights", TextureLayout{tile.width() + 2 * frame,
                                                           tile.height() + 2 * frame, 0, GL_R32F})
                   : new Resource("heights",
                                  [this]() -> osg::ref_ptr<osg::Texture>
                                  { return createHeightTexture(_tile, _frame, _bodyRadius); }))),
      _eastSpacings(own(new Resource("east spacings",
                                     [this]() -> osg::ref_ptr<osg::Texture>
                                     { return createSpacingTexture(_tile); })))
{
    _heights->make();
    _eastSpacings->make();
}

TileSurface::TileSurface(std::shared_ptr<const TileWindows> windows, int frame, double bodyRadius)
    : _windows(std::move(windows)), _tile(_windows->tile), _frame(frame), _bodyRadius(bodyRadius),
      _isChanging(false),
      _heights(own(new Resource("heights", [this] { return createHeights(); }))),
      _eastSpacings(own(new Resource("east spacings",
                                     [this]() -> osg::ref_ptr<osg::Texture>
                                     { return createSpacingTexture(_tile); })))
{
    _heights->make();
    _eastSpacings->make();
    layOut();
    _far = own(new Resource("far heights", [this] { return createFar(); }));
    _far->make();
}

int TileSurface::frameOf(const TileWindows& windows, int atLeast)
{
    const PostRect& near = windows.near;
    const PostRect& tile = windows.place;
    return std::max({atLeast, tile.column - near.column + guard, tile.row - near.row + guard,
                     near.endColumn() - tile.endColumn() + guard,
                     near.endRow() - tile.endRow() + guard});
}

/// Each level takes a strip of the texture, east and north side by side.
void TileSurface::layOut()
{
    int top = 0;
    for (const FarLevel& level : _windows->levels)
    {
        const int width = level.posts.width + 2 * guard;
        _places.push_back({guard, top + guard, width + guard, top + guard});
        _farWidth = std::max(_farWidth, 2 * width);
        top += level.posts.height + 2 * guard;
    }
    _farHeight = std::max(1, top);
}

/// How far the ground of the planet lies below the plane that touches it in the middle of the whole
/// terrain [m]. column, row: of it.
double TileSurface::sinkAt(double column, double row, double eastSpacing) const
{
    if (!(_bodyRadius > 0.0))
        return 0.0;
    const double east = (column - _windows->middleColumn) * eastSpacing;
    const double north = (row - _windows->middleRow) * _tile.northSpacing;
    return (east * east + north * north) / (2.0 * _bodyRadius);
}

osg::ref_ptr<osg::Texture> TileSurface::createHeights() const
{
    const PostRect& near = _windows->near;
    Raster<float> texels(width() + 2 * _frame, height() + 2 * _frame, voidHeight);
    for (int row = 0; row < near.height; ++row)
        for (int column = 0; column < near.width; ++column)
        {
            const float height = _windows->heights.at(column, row);
            const double sink = sinkAt(near.column + column, near.row + row,
                                       _windows->eastSpacings[static_cast<std::size_t>(row)]);
            if (std::isfinite(height))
                texels.at(near.column - _windows->place.column + column + _frame,
                          near.row - _windows->place.row + row + _frame) =
                    static_cast<float>(static_cast<double>(height) - sink);
        }
    return createFloatTexture(texels);
}

osg::ref_ptr<osg::Texture> TileSurface::createFar() const
{
    Raster<float> texels(_farWidth, _farHeight, voidHeight);
    for (std::size_t l = 0; l < _places.size(); ++l)
    {
        const FarLevel& level = _windows->levels[l];
        const double step = 1 << level.level;
        for (int row = 0; row < level.posts.height; ++row)
            for (int column = 0; column < level.posts.width; ++column)
            {
                const double sink =
                    sinkAt(step * (level.posts.column + column), step * (level.posts.row + row),
                           level.eastSpacings[static_cast<std::size_t>(row)]);
                const auto sunk = [&](float height)
                {
                    return std::isfinite(height)
                               ? static_cast<float>(static_cast<double>(height) - sink)
                               : voidHeight;
                };
                const Place& place = _places[l];
                texels.at(place.x + column, place.y + row) = sunk(level.heights[0].at(column, row));
                texels.at(place.northX + column, place.northY + row) =
                    sunk(level.heights[1].at(column, row));
            }
    }
    return createFloatTexture(texels);
}

osg::ref_ptr<Resource> TileSurface::createFarLight(std::vector<Raster<Rgb>> levels) const
{
    assert(levels.size() == _places.size());
    const auto shared = std::make_shared<const std::vector<Raster<Rgb>>>(std::move(levels));
    return new Resource("far light",
                        [places = _places, shared, width = _farWidth,
                         height = _farHeight]() -> osg::ref_ptr<osg::Texture>
                        {
                            Raster<Rgb> texels(width / 2 + 1, height);
                            for (std::size_t l = 0; l < places.size(); ++l)
                                for (int row = 0; row < (*shared)[l].height(); ++row)
                                    for (int column = 0; column < (*shared)[l].width(); ++column)
                                        texels.at(places[l].x + column, places[l].y + row) =
                                            (*shared)[l].at(column, row);
                            return createColourTexture(texels);
                        });
}

int TileSurface::reach() const
{
    if (_places.empty())
        return std::max(width(), height());
    const FarLevel& last = _windows->levels.back();
    return std::max(last.posts.width, last.posts.height) << last.level;
}

std::vector<std::string> TileSurface::farDefines() const
{
    return _windows ? std::vector<std::string>{"SURROUNDED"} : std::vector<std::string>{};
}

void TileSurface::bindFar(GpuPass& pass) const
{
    if (!_windows)
        return;
    // Rectangles of posts, the tile's level first; texels.
    constexpr int most = TileWindows::mostLevels + 1; // the size of the arrays in the shaders
    const int count = farLevels() + 1;
    assert(count <= most);
    osg::ref_ptr<osg::Uniform> posts =
        new osg::Uniform(osg::Uniform::INT_VEC4, "windowPosts", most);
    osg::ref_ptr<osg::Uniform> texels =
        new osg::Uniform(osg::Uniform::INT_VEC4, "windowTexels", most);
    const auto set = [&](int level, const PostRect& rect, int step, const Place& place)
    {
        const int column = rect.column * step - _windows->place.column;
        const int row = rect.row * step - _windows->place.row;
        const auto i = static_cast<unsigned>(level);
        const PostRect& extent = _windows->extent;
        posts->setElement(
            i, column, row,
            std::min(column + (rect.width - 1) * step,
                     std::max(extent.endColumn(), _windows->near.endColumn()) - 1 -
                         _windows->place.column),
            std::min(row + (rect.height - 1) * step,
                     std::max(extent.endRow(), _windows->near.endRow()) - 1 - _windows->place.row));
        texels->setElement(i, place.x, place.y, place.northX, place.northY);
    };
    const int x = _windows->near.column - _windows->place.column + _frame;
    const int y = _windows->near.row - _windows->place.row + _frame;
    set(0, _windows->near, 1, {x, y, x, y});
    for (int level = 1; level < count; ++level)
    {
        const auto i = static_cast<std::size_t>(level - 1);
        set(level, _windows->levels[i].posts, 1 << level, _places[i]);
    }
    pass.set(posts);
    pass.set(texels);
    pass.set("farLevels", farLevels());
    pass.reads("farHeights", _far);
}

void TileSurface::bind(GpuPass& pass) const
{
    pass.reads("heights", _heights);
    pass.reads("eastSpacings", _eastSpacings);
    pass.set("size", width(), height());
    pass.set("frame", _frame);
    pass.set("northSpacing", static_cast<float>(_tile.northSpacing));
}

GpuPass::Groups TileSurface::groups(int stride) const
{
    return {GpuPass::groupsFor((width() - 1) / stride + 1, 8),
            GpuPass::groupsFor((height() - 1) / stride + 1, 8), 1};
}

TextureLayout TileSurface::perPost(GLint format, int layers) const
{
    return {width(), height(), layers, format};
}

} // namespace osgTerrainLight
