#include "lighting/FarLight.h"

#include "lighting/TileLight.h"

#include <algorithm>
#include <cassert>

namespace osgTerrainLight
{

Status MemoryRadiance::begin(int level, int bounces, const PostRect& posts)
{
    Level& made = _levels[level];
    made.posts = posts;
    made.bounces.assign(static_cast<std::size_t>(bounces), Raster<Rgb>(posts.width, posts.height));
    return Nothing{};
}

Status MemoryRadiance::write(int level, int bounce, const PostRect& posts,
                             const Raster<Rgb>& radiance)
{
    Level& kept = _levels.at(level);
    for (int row = 0; row < posts.height; ++row)
        for (int column = 0; column < posts.width; ++column)
            kept.bounces[static_cast<std::size_t>(bounce)].at(
                posts.column - kept.posts.column + column, posts.row - kept.posts.row + row) =
                radiance.at(column, row);
    return Nothing{};
}

Result<Raster<Rgb>> MemoryRadiance::read(int level, int bounce, const PostRect& posts)
{
    const Level& kept = _levels.at(level);
    Raster<Rgb> found(posts.width, posts.height);
    assert(kept.posts.contains(posts)); // what is dark there was never lit
    const PostRect both = posts.clippedTo(kept.posts);
    for (int row = both.row; row < both.endRow(); ++row)
        for (int column = both.column; column < both.endColumn(); ++column)
            found.at(column - posts.column, row - posts.row) =
                kept.bounces[static_cast<std::size_t>(bounce)].at(column - kept.posts.column,
                                                                  row - kept.posts.row);
    return found;
}

namespace
{

/// The light of one level's tiles.
class LevelLighting
{
public:
    LevelLighting(osg::State& state, TileSource& source, const FarLighting& lighting,
                  RadianceStore& store, int level)
        : _state(state), _source(source), _lighting(lighting), _store(store), _level(level),
          _settings(lighting.settings)
    {
        // What is sent to the last bounce has been through one less.
        _settings.bounces = lighting.settings.bounces - 1;
        _settings.shadowEdges = false;
        _settings.gloss = 0.0;
    }

    Status light(const PostRect& tile)
    {
        const PostRect lit = _settings.bounces > 0
                                 ? tile.grownBy(bounceMargin).clippedTo(_source.extent(_level))
                                 : tile;
        const auto windows = readWindows(_source, _level, lit, _settings.quality);
        if (!windows)
            return windows.error();
        Raster<Rgb> albedo(lit.width, lit.height, _settings.albedo);
        if (_lighting.albedo)
        {
            Result<Raster<Rgb>> given = _lighting.albedo(_level, lit);
            if (!given)
                return given.error();
            albedo = std::move(*given);
        }
        const osg::ref_ptr<TileLight> light = new TileLight(*windows, _settings, _lighting.sky);
        if (_lighting.albedo)
            light->setAlbedo(albedo);
        if (_settings.bounces > 0)
        {
            const auto far = readFarLight(_store, _level, _settings.bounces, **windows);
            if (!far)
                return far.error();
            light->setFarLight(*far);
        }
        Status done = light->update(_state);
        for (int bounce = 0; done && bounce <= _settings.bounces; ++bounce)
            done = _store.write(_level, bounce, tile, sent(*light, albedo, bounce, lit, tile));
        light->releaseGLObjects(&_state);
        return done;
    }

private:
    /// Of the part of a lit rectangle that is the tile.
    Raster<Rgb> sent(TileLight& light, const Raster<Rgb>& albedo, int bounce, const PostRect& lit,
                     const PostRect& tile) const
    {
        Raster<Rgb> radiance(tile.width, tile.height);
        // Without what there would be to bounce, bounces do not exist.
        if (bounce > light.bounces())
            return radiance;
        const Raster<osg::Vec4f> received =
            bounce == 0 ? light.readDirect(_state) : light.readBounce(_state, bounce);
        for (int row = 0; row < tile.height; ++row)
            for (int column = 0; column < tile.width; ++column)
            {
                const int x = tile.column - lit.column + column;
                const int y = tile.row - lit.row + row;
                for (unsigned c = 0; c < 3; ++c)
                    radiance.at(column, row)[c] = albedo.at(x, y)[c] * received.at(x, y)[c];
            }
        return radiance;
    }

    osg::State& _state;
    TileSource& _source;
    const FarLighting& _lighting;
    RadianceStore& _store;
    const int _level;
    LightingSettings _settings;
};

/// What tiles of a part of a level, and what is lit with them, see of the next one.
PostRect seenOfNext(const TileSource& source, int level, const PostRect& part,
                    const WindowScheme& scheme)
{
    return part.grownBy(bounceMargin)
        .clippedTo(source.extent(level))
        .grownBy(scheme.ring)
        .coarser(1)
        .grownBy(scheme.farRing)
        .clippedTo(source.extent(level + 1));
}

/// Tiles of `side` posts that cover a rectangle.
std::vector<PostRect> tilesOf(const PostRect& all, int side)
{
    std::vector<PostRect> tiles;
    for (int row = all.row; row < all.endRow(); row += side)
        for (int column = all.column; column < all.endColumn(); column += side)
            tiles.push_back(PostRect{column, row, side, side}.clippedTo(all));
    return tiles;
}

} // namespace

Status lightLevels(osg::State& state, TileSource& source, const FarLighting& lighting,
                   RadianceStore& store)
{
    if (lighting.settings.bounces == 0)
        return Nothing{};
    std::vector<PostRect> parts = {{0, 0, source.width(), source.height()}};
    double all = 0.0;
    for (int level = 0; level < source.lastLevel(); ++level)
    {
        parts.push_back(
            seenOfNext(source, level, parts.back(), WindowScheme::of(lighting.settings.quality)));
        all += static_cast<double>(parts.back().width) * parts.back().height;
    }
    double done = 0.0;
    for (int level = source.lastLevel(); level > 0; --level)
    {
        const PostRect& part = parts[static_cast<std::size_t>(level)];
        if (store.has(level))
        {
            done += static_cast<double>(part.width) * part.height;
            continue;
        }
        if (Status begun = store.begin(level, lighting.settings.bounces, part); !begun)
            return begun;
        LevelLighting lit(state, source, lighting, store, level);
        for (const PostRect& tile : tilesOf(part, lighting.side))
        {
            if (Status status = lit.light(tile); !status)
                return status;
            done += static_cast<double>(tile.width) * tile.height;
            if (lighting.progress)
                lighting.progress(done / all);
        }
        if (Status ended = store.end(level); !ended)
            return ended;
    }
    return Nothing{};
}

Result<std::shared_ptr<const FarLight>> readFarLight(RadianceStore& store, int level, int bounces,
                                                     const TileWindows& windows)
{
    auto light = std::make_shared<FarLight>(static_cast<std::size_t>(bounces));
    for (int bounce = 0; bounce < bounces; ++bounce)
        for (const FarLevel& far : windows.levels)
        {
            Result<Raster<Rgb>> read = store.read(level + far.level, bounce, far.posts);
            if (!read)
                return read.error();
            (*light)[static_cast<std::size_t>(bounce)].push_back(std::move(*read));
        }
    return std::shared_ptr<const FarLight>(std::move(light));
}

} // namespace osgTerrainLight
