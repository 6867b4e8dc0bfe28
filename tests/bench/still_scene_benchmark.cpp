// CPU time of update and cull per frame of a still scene of 1,000 tiles: below
// TerrainLighting, and below a plain group; and with 200 of them above the
// others, of which they are drawn in place. Times are OSG's own, from the
// viewer's statistics.
#include <osgTerrainLight/TerrainLighting.h>

#include "scene/FadingLod.h"
#include "terrain/TerrainModel.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <osg/MatrixTransform>
#include <osgTerrain/TerrainTile>
#include <osgViewer/Viewer>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int columns = 40, rows = 25;
constexpr int posts = 17;
constexpr double spacing = 10.0; // [m]

DemTile ground(double metres)
{
    DemTile tile(posts, posts, metres);
    for (int row = 0; row < posts; ++row)
        for (int column = 0; column < posts; ++column)
            tile.setHeight(column, row, static_cast<float>(10.0 * std::sin(0.7 * column + row)));
    return tile;
}

/// The tile of a level, x and y about the middle of the scene.
osg::ref_ptr<osg::Node> placed(const DemTile& tile, double side, const osgTerrain::TileID& id)
{
    const osg::ref_ptr<osg::Node> terrain = createTerrain(tile);
    dynamic_cast<osgTerrain::TerrainTile&>(*terrain->asGroup()->getChild(0)).setTileID(id);
    const osg::ref_ptr<osg::MatrixTransform> place = new osg::MatrixTransform(
        osg::Matrix::translate(side * (id.x + 0.5) - 2000.0, side * (id.y + 0.5) - 2000.0, 0.0));
    place->addChild(terrain);
    return place;
}

constexpr double side = (posts - 1) * spacing;

void fill(osg::Group& parent)
{
    for (int i = 0; i < columns * rows; ++i)
        parent.addChild(placed(ground(spacing), side, {6, i % columns, i / columns}));
}

/// 200 tiles with four in the place of each.
void fillLevels(osg::Group& parent)
{
    for (int i = 0; i < columns * rows / 5; ++i)
    {
        const int x = i % (columns / 2), y = i / (columns / 2);
        const osg::ref_ptr<osg::PagedLOD> lod = new FadingLod;
        lod->setRangeMode(osg::LOD::PIXEL_SIZE_ON_SCREEN);
        lod->addChild(placed(ground(2.0 * spacing), 2.0 * side, {5, x, y}), 0.0f, 0.0f);
        const osg::ref_ptr<osg::Group> finer = new osg::Group;
        for (int j = 0; j < 4; ++j)
            finer->addChild(placed(ground(spacing), side, {6, 2 * x + j % 2, 2 * y + j / 2}));
        lod->addChild(finer, 0.0f, 1.0e9f);
        parent.addChild(lod);
    }
}

void stillScene(benchmark::State& state, osg::Group* scene, void (*filled)(osg::Group&))
{
    const osg::ref_ptr<osg::Group> root = scene;
    filled(*root);
    std::string problem;
    const std::unique_ptr<HeadlessContext> context = HeadlessContext::create(64, 64, problem);
    if (!context)
    {
        state.SkipWithError(problem.c_str());
        return;
    }
    const osg::ref_ptr<osgViewer::Viewer> viewer = new osgViewer::Viewer;
    viewer->setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer->setReleaseContextAtEndOfFrameHint(false);
    osg::Camera& camera = *viewer->getCamera();
    camera.setGraphicsContext(context->window());
    camera.setViewport(0, 0, 64, 64);
    camera.setProjectionMatrixAsOrtho(-2000.0, 2000.0, -2000.0, 2000.0, 1.0, 1.0e6);
    camera.setViewMatrixAsLookAt(osg::Vec3d(0.0, 0.0, 5.0e5), osg::Vec3d(),
                                 osg::Vec3d(0.0, 1.0, 0.0));
    viewer->setSceneData(root);
    for (int i = 0; i < 60; ++i) // all tiles are lit, and have faded
        viewer->frame();
    viewer->getViewerStats()->collectStats("update", true);
    camera.getStats()->collectStats("rendering", true);
    std::vector<double> updates, culls;
    for (auto _ : state)
    {
        viewer->frame();
        const unsigned frame = viewer->getFrameStamp()->getFrameNumber();
        double update = 0.0, cull = 0.0; // [s]
        viewer->getViewerStats()->getAttribute(frame, "Update traversal time taken", update);
        camera.getStats()->getAttribute(frame, "Cull traversal time taken", cull);
        updates.push_back(update);
        culls.push_back(cull);
        state.SetIterationTime(update + cull);
    }
    const auto median = [](std::vector<double>& times)
    {
        const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
        std::nth_element(times.begin(), middle, times.end());
        return 1.0e6 * *middle;
    };
    state.counters["median_update_us"] = median(updates);
    state.counters["median_cull_us"] = median(culls);
    context->makeCurrent();
    root->releaseGLObjects(&context->state());
}

osg::ref_ptr<TerrainLighting> lit()
{
    const osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setTimeBudget(0.0);
    lighting->setFadeSeconds(0.01);
    LightingSettings settings;
    settings.azimuths = 4;
    lighting->setSettings(settings);
    return lighting;
}

void StillTilesInAGroup(benchmark::State& state)
{
    stillScene(state, new osg::Group, fill);
}
void StillTilesLit(benchmark::State& state)
{
    stillScene(state, lit(), fill);
}
void StillLevelsInAGroup(benchmark::State& state)
{
    stillScene(state, new osg::Group, fillLevels);
}
void StillLevelsLit(benchmark::State& state)
{
    stillScene(state, lit(), fillLevels);
}
} // namespace

BENCHMARK(StillTilesInAGroup)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200);
BENCHMARK(StillTilesLit)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200);
BENCHMARK(StillLevelsInAGroup)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200);
BENCHMARK(StillLevelsLit)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200);
