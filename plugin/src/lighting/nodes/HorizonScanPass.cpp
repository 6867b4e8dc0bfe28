#include "lighting/nodes/HorizonScanPass.h"

#include "gpu/GlConstants.h"
#include "gpu/GpuPass.h"
#include "gpu/Textures.h"
#include "lighting/nodes/GridDirection.h"

#include <algorithm>
#include <cassert>

namespace osgTerrainLight
{

Result<Raster<double>> scanHorizons(osg::State& state, const DemTile& tile,
                                    const std::vector<TilePost>& posts,
                                    const std::vector<MapDirection>& directions, double lowest)
{
    // A scan reads up to two posts beyond the tile.
    constexpr int frame = 2;
    // Directions of one dispatch, so that none keeps the GPU for long.
    constexpr int batch = 64;
    assert(posts.size() <= 16384);
    const int postCount = static_cast<int>(posts.size());
    float highest = -std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < tile.postCount(); ++i)
        if (tile.validity()[i])
            highest = std::max(highest, tile.heights()[i]);
    const double narrowest = *std::min_element(tile.eastSpacings.begin(), tile.eastSpacings.end());
    Raster<float> postTable(2, postCount);
    for (int i = 0; i < postCount; ++i)
    {
        const TilePost& post = posts[static_cast<std::size_t>(i)];
        assert(tile.isValid(post.column, post.row));
        postTable.at(0, i) = static_cast<float>(post.column);
        postTable.at(1, i) = static_cast<float>(post.row);
    }
    const osg::ref_ptr<osg::Texture2D> heights = createHeightTexture(tile, frame);
    const osg::ref_ptr<osg::Texture2D> postTexture = createFloatTexture(postTable);
    const osg::ref_ptr<GpuPass> pass = new GpuPass("horizon_scan");
    pass->reads("heights", heights);
    pass->reads("posts", postTexture);
    pass->set("size", tile.width(), tile.height());
    pass->set("frame", frame);
    pass->set("highest", highest);

    Raster<double> tangents(postCount, static_cast<int>(directions.size()));
    for (int first = 0; first < tangents.height(); first += batch)
    {
        const int count = std::min(batch, tangents.height() - first);
        std::vector<GridDirection> grid;
        Raster<float> directionTable(4, count);
        for (int i = 0; i < count; ++i)
        {
            grid.emplace_back(tile, directions[static_cast<std::size_t>(first + i)]);
            directionTable.at(0, i) = static_cast<float>(grid.back().drift);
            directionTable.at(1, i) = static_cast<float>(grid.back().look);
            directionTable.at(2, i) = grid.back().north ? 1.0f : 0.0f;
            directionTable.at(3, i) = static_cast<float>(
                std::max(lowest, 0.0) * grid.back().stepLength(narrowest, tile.northSpacing));
        }
        const osg::ref_ptr<osg::Texture2D> directionTexture = createFloatTexture(directionTable);
        const osg::ref_ptr<osg::Texture2D> slopes = createTarget(postCount, count, GL_R32F);
        pass->reads("directions", directionTexture);
        pass->writes(0, slopes);
        pass->set("count", postCount, count);
        if (Status done = pass->dispatch(
                state, {GpuPass::groupsFor(postCount, 8), GpuPass::groupsFor(count, 8), 1});
            !done)
            return done.error();
        const std::vector<float> perStep = readFloats(state, *slopes, 1);
        for (int i = 0; i < count; ++i)
            for (int p = 0; p < postCount; ++p)
            {
                const int row = posts[static_cast<std::size_t>(p)].row;
                tangents.at(p, first + i) =
                    static_cast<double>(perStep[static_cast<std::size_t>(i * postCount + p)]) /
                    grid[static_cast<std::size_t>(i)].stepLength(tile.eastSpacing(row),
                                                                 tile.northSpacing);
            }
        directionTexture->releaseGLObjects(&state);
        slopes->releaseGLObjects(&state);
    }
    heights->releaseGLObjects(&state);
    postTexture->releaseGLObjects(&state);
    pass->releaseGLObjects(&state);
    return tangents;
}

} // namespace osgTerrainLight
