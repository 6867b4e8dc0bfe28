#include "scene/TileLevels.h"

#include "scene/FadingLod.h"

namespace osgTerrainLight
{

namespace
{
TileHandle aboveOf(const TileHandle& handle)
{
    return TileHandle::at(handle.level - 1, handle.x / 2, handle.y / 2);
}
} // namespace

void TileLevels::place(SceneTile& tile, const osg::NodePath& above)
{
    tile.finer = nullptr;
    tile.coarser = nullptr;
    if (tile.handle.level < 0)
        return;
    const osg::Node* child = tile.terrain;
    for (auto node = above.rbegin(); node != above.rend() && !tile.coarser; child = *node++)
        if (auto* lod = dynamic_cast<osg::PagedLOD*>(*node))
        {
            const bool first = lod->getChildIndex(child) == 0;
            if (!first)
                tile.coarser = lod;
            else if (!tile.finer)
                tile.finer = lod;
        }
}

bool TileLevels::isRefined(const osg::PagedLOD& lod)
{
    return lod.getNumChildren() > 1 && lod.getFrameNumber(1) >= lod.getFrameNumber(0);
}

bool TileLevels::wantsFiner(const osg::PagedLOD& lod)
{
    const auto* fading = dynamic_cast<const FadingLod*>(&lod);
    return fading ? fading->wantsFiner() : isRefined(lod);
}

bool TileLevels::isReached(const SceneTile& tile) const
{
    if (!tile.coarser)
        return true;
    const SceneTile* above = _registry.find(aboveOf(tile.handle));
    return isRefined(*tile.coarser) && (!above || isReached(*above));
}

float TileLevels::coarserPart(const TileHandle& place) const
{
    if (place.x < 0 || place.y < 0)
        return 0.0f;
    for (TileHandle handle = place; handle.level >= 0; handle = aboveOf(handle))
    {
        const SceneTile* tile = _registry.find(handle);
        if (!tile || !isReached(*tile))
            continue;
        if (handle.level < place.level) // where it is refined, nothing is drawn at the place
            return isRefined(*tile) ? 0.0f : 1.0f;
        return tile->former && tile->former->isAbove ? static_cast<float>(tile->former->part)
                                                     : 0.0f;
    }
    return 0.0f;
}

std::array<SceneTile*, 4> TileLevels::below(const SceneTile& tile) const
{
    const TileHandle& handle = tile.handle;
    std::array<SceneTile*, 4> found{};
    for (int i = 0; i < 4; ++i)
        found[std::size_t(i)] = _registry.find(
            TileHandle::at(handle.level + 1, 2 * handle.x + i % 2, 2 * handle.y + i / 2));
    return found;
}

std::array<TileHandle, 8> TileLevels::around(const TileHandle& handle)
{
    constexpr int steps[8][2] = {{-1, 0},  {0, -1}, {1, 0},  {0, 1},
                                 {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    std::array<TileHandle, 8> found;
    for (std::size_t i = 0; i < found.size(); ++i)
        found[i] = TileHandle::at(handle.level, handle.x + steps[i][0], handle.y + steps[i][1]);
    return found;
}

} // namespace osgTerrainLight
