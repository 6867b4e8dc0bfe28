#include "core/TileSource.h"

namespace osgTerrainLight
{

Result<Raster<float>> TileSource::readSurface(int level, const PostRect& posts)
{
    if (level == 0)
        return readPosts(posts);
    Result<Raster<float>> east = readLevel(level, CrestAxis::East, posts);
    if (!east)
        return east;
    const Result<Raster<float>> north = readLevel(level, CrestAxis::North, posts);
    if (!north)
        return north;
    for (std::size_t i = 0; i < east->size(); ++i)
        east->values()[i] = 0.5f * (east->values()[i] + north->values()[i]);
    return east;
}

} // namespace osgTerrainLight
