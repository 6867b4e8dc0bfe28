// CPU time of update and cull per frame of a still scene of 400 tiles: below
// TerrainLighting, and below a plain group. Times are OSG's own, from the
// viewer's statistics.
#include <osgTerrainLight/TerrainLighting.h>

#include "terrain/TerrainModel.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <osg/MatrixTransform>
#include <osgViewer/Viewer>

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

using namespace osgTerrainLight;

namespace
{
constexpr int tilesASide = 20;
constexpr int posts = 17;
constexpr double spacing = 10.0; // [m]

void fill(osg::Group& parent)
{
    DemTile tile(posts, posts, spacing);
    for (int row = 0; row < posts; ++row)
        for (int column = 0; column < posts; ++column)
            tile.setHeight(column, row, static_cast<float>(10.0 * std::sin(0.7 * column + row)));
    for (int i = 0; i < tilesASide * tilesASide; ++i)
    {
        const double side = (posts - 1) * spacing;
        const osg::ref_ptr<osg::MatrixTransform> place = new osg::MatrixTransform(
            osg::Matrix::translate(side * (i % tilesASide - tilesASide / 2),
                                   side * (i / tilesASide - tilesASide / 2), 0.0));
        place->addChild(createTerrain(tile));
        parent.addChild(place);
    }
}

void stillScene(benchmark::State& state, osg::Group* scene)
{
    const osg::ref_ptr<osg::Group> root = scene;
    fill(*root);
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
    for (int i = 0; i < 10; ++i) // all tiles are lit
        viewer->frame();
    viewer->getViewerStats()->collectStats("update", true);
    camera.getStats()->collectStats("rendering", true);
    double updates = 0.0, culls = 0.0;
    for (auto _ : state)
    {
        viewer->frame();
        const unsigned frame = viewer->getFrameStamp()->getFrameNumber();
        double update = 0.0, cull = 0.0; // [s]
        viewer->getViewerStats()->getAttribute(frame, "Update traversal time taken", update);
        camera.getStats()->getAttribute(frame, "Cull traversal time taken", cull);
        updates += update;
        culls += cull;
        state.SetIterationTime(update + cull);
    }
    state.counters["update_us"] =
        benchmark::Counter(1.0e6 * updates, benchmark::Counter::kAvgIterations);
    state.counters["cull_us"] =
        benchmark::Counter(1.0e6 * culls, benchmark::Counter::kAvgIterations);
    context->makeCurrent();
    root->releaseGLObjects(&context->state());
}

void StillTilesInAGroup(benchmark::State& state)
{
    stillScene(state, new osg::Group);
}

void StillTilesLit(benchmark::State& state)
{
    const osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setTimeBudget(0.0);
    LightingSettings settings;
    settings.azimuths = 4;
    lighting->setSettings(settings);
    stillScene(state, lighting);
}
} // namespace

BENCHMARK(StillTilesInAGroup)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200);
BENCHMARK(StillTilesLit)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200);
