#include "scene/TileRegistry.h"

#include <algorithm>
#include <cassert>

namespace osgTerrainLight
{

TileHandle TileRegistry::next()
{
    TileHandle handle;
    handle.number = ++_last;
    return handle;
}

TileHandle TileRegistry::handleOf(osgTerrain::TerrainTile& tile)
{
    if (_known.size() >= _forgetAt)
        forgetGone();
    Known& known = _known[&tile];
    if (known.handle && known.tile.valid())
        return known.handle;
    const osgTerrain::TileID& id = tile.getTileID();
    const TileHandle byId = id.valid() ? TileHandle::at(id.level, id.x, id.y) : TileHandle();
    const bool taken = isPromised(byId) || find(byId);
    known.tile = &tile;
    known.handle = byId && !taken ? byId : next();
    if (known.handle == byId)
        _byId[byId] = &tile;
    return known.handle;
}

bool TileRegistry::isPromised(const TileHandle& handle) const
{
    const auto known = _byId.find(handle);
    return known != _byId.end() && known->second.valid();
}

void TileRegistry::forgetGone()
{
    for (auto i = _known.begin(); i != _known.end();)
        i = i->second.tile.valid() ? std::next(i) : _known.erase(i);
    for (auto i = _byId.begin(); i != _byId.end();)
        i = i->second.valid() ? std::next(i) : _byId.erase(i);
    _forgetAt = 2 * _known.size() + 256;
}

SceneTile* TileRegistry::find(const TileHandle& handle) const
{
    const auto found = _tiles.find(handle);
    return found == _tiles.end() ? nullptr : found->second.get();
}

SceneTile& TileRegistry::add(const TileHandle& handle)
{
    assert(handle && !find(handle));
    auto& tile = _tiles[handle];
    tile = std::make_unique<SceneTile>();
    tile->handle = handle;
    return *tile;
}

void TileRegistry::remove(const TileHandle& handle)
{
    _dynamic.erase(std::remove(_dynamic.begin(), _dynamic.end(), find(handle)), _dynamic.end());
    _tiles.erase(handle);
}

std::vector<TileHandle> TileRegistry::handles() const
{
    std::vector<TileHandle> handles;
    for (const auto& [handle, tile] : _tiles)
        handles.push_back(handle);
    return handles;
}

} // namespace osgTerrainLight
