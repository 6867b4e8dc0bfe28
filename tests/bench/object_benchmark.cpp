// 64 boxes that move in every frame, on 32 m of ground: composing their volume of 128 x 128 x 128
// voxels, the factor of the ground, and frames that draw ground and boxes; and forms that deform.
#include <osgTerrainLight/HeadlessContext.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "fields/SampledForm.h"
#include "lighting/ObjectLight.h"
#include "lighting/TileLight.h"
#include "support/SampledBodies.h"
#include "terrain/TerrainModel.h"

#include <glm/gtc/matrix_transform.hpp>
#include <osg/Geode>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>
#include <osgViewer/Viewer>

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int aSide = 8;
constexpr double apart = 3.5; // [m]

DemTile ground()
{
    DemTile tile(65, 65, 1.0);
    for (int row = 0; row < 65; ++row)
        for (int column = 0; column < 65; ++column)
            tile.setHeight(column, row, 0.0f);
    return tile;
}

/// Of the middle of a box in a frame, from that of all.
osg::Vec3d placeOf(int box, int frame)
{
    const double turn = 0.1 * frame + box;
    return {apart * (box % aSide - 0.5 * (aSide - 1)) + 0.3 * std::cos(turn),
            apart * (box / aSide - 0.5 * (aSide - 1)) + 0.3 * std::sin(turn), 1.0};
}

std::vector<ObjectShape> boxes(int frame, int moving)
{
    std::vector<ObjectShape> shapes;
    for (int i = 0; i < aSide * aSide; ++i)
    {
        const osg::Vec3d place = placeOf(i, i < moving ? frame : 0);
        ObjectShape shape;
        shape.size = {0.7, 0.5, 1.0};
        // The tile's middle post is the scene's.
        shape.toScene = glm::rotate(
            glm::translate(glm::dmat4(1.0), {place.x() + 32.0, place.y() + 32.0, place.z()}),
            0.7 * i, {0.0, 0.0, 1.0});
        shapes.push_back(shape);
    }
    return shapes;
}

std::unique_ptr<HeadlessContext> contextFor(benchmark::State& state, int size)
{
    std::string problem;
    auto context = HeadlessContext::create(size, size, problem);
    if (!context)
        state.SkipWithError(problem.c_str());
    return context;
}

/// moving: how many of the boxes.
void volumeOfMovingBoxes(benchmark::State& state)
{
    const auto context = contextFor(state, 16);
    if (!context)
        return;
    const osg::ref_ptr<ObjectLight> light = new ObjectLight;
    int frame = 0;
    for (auto _ : state)
    {
        light->set(boxes(frame++, static_cast<int>(state.range(0))));
        if (!light->update(context->state()))
            state.SkipWithError("no volume");
        glFinish();
    }
    const glm::ivec3 voxels = light->placed().at(0).cluster.voxels;
    state.counters["clusters"] = static_cast<double>(light->placed().size());
    state.counters["voxels"] = static_cast<double>(voxels.x * voxels.y * voxels.z);
    state.counters["bytes"] = static_cast<double>(light->bytes());
    light->releaseGLObjects(&context->state());
}

/// A blob 5 m wide, or a rock 8 m wide between two height fields, that deforms in every frame: from
/// its triangles on. range: 0 the blob, 1 the rock.
void volumeOfDeformingForm(benchmark::State& state)
{
    const auto context = contextFor(state, 16);
    if (!context)
        return;
    const osg::ref_ptr<ObjectLight> light = new ObjectLight;
    std::vector<TriangleMesh> meshes;
    for (int i = 0; i < 8; ++i)
        meshes.push_back(state.range(0) == 0 ? bodies::Blob{0.25, 0.2 * i, 2.5}.mesh(32)
                                             : bodies::Mound{2.0, 0.2 * i, 4.0, true}.mesh(32));
    std::size_t frame = 0, bricks = 0;
    for (auto _ : state)
    {
        ObjectShape shape;
        shape.kind = state.range(0) == 0 ? ObjectShape::Kind::Star : ObjectShape::Kind::Heights;
        const TriangleMesh& mesh = meshes[frame++ % meshes.size()];
        shape.form =
            state.range(0) == 0 ? sampleStar(mesh) : sampleHeights(mesh, HeightSurfaces::Both);
        light->set({shape});
        if (!light->update(context->state()))
            state.SkipWithError("no volume");
        glFinish();
        bricks = light->placed().at(0).node->bricks();
    }
    state.counters["bricks"] = static_cast<double>(bricks);
    state.counters["bytes"] = static_cast<double>(light->bytes());
    light->releaseGLObjects(&context->state());
}

void factorOfMovingBoxes(benchmark::State& state)
{
    const auto context = contextFor(state, 16);
    if (!context)
        return;
    const osg::ref_ptr<ObjectLight> light = new ObjectLight;
    LightingSettings settings;
    SkyLight sky;
    const osg::ref_ptr<TileLight> tile = new TileLight(ground(), settings, sky);
    const osg::ref_ptr<TileLight> without = new TileLight(ground(), settings, sky);
    if (!without->update(context->state()))
        state.SkipWithError("no light");
    int frame = 0;
    for (auto _ : state)
    {
        state.PauseTiming();
        light->set(boxes(frame++, aSide * aSide));
        tile->setObjects(
            objectsOn(light->placed(), {0.0, 0.0, 0.0}, ground(), {1.0, 1.0}, shadowReach(sky)));
        if (!light->update(context->state()))
            state.SkipWithError("no volume");
        glFinish();
        state.ResumeTiming();
        if (!tile->update(context->state()))
            state.SkipWithError("no factor");
        glFinish();
    }
    const auto drawn = tile->drawnObjects({context->state().getContextID()});
    if (drawn)
        state.counters["texels"] = static_cast<double>(drawn->factor->getTextureWidth() *
                                                       drawn->factor->getTextureHeight());
    state.counters["bytes"] =
        static_cast<double>(tile->bytes()) - static_cast<double>(without->bytes());
    tile->releaseGLObjects(&context->state());
    without->releaseGLObjects(&context->state());
    light->releaseGLObjects(&context->state());
}

/// A picture of 256 x 256 pixels. range: 0 the boxes are drawn, unlit and no objects; 1 they are
/// placed objects that stand; 2 that move.
void frameOfBoxes(benchmark::State& state)
{
    const auto context = contextFor(state, 256);
    if (!context)
        return;
    const osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setTimeBudget(0.0);
    lighting->addChild(createTerrain(ground()));
    std::vector<osg::ref_ptr<osg::MatrixTransform>> places;
    for (int i = 0; i < aSide * aSide; ++i)
    {
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(new osg::ShapeDrawable(new osg::Box(osg::Vec3(), 1.4f, 1.0f, 2.0f)));
        const osg::ref_ptr<osg::Group> object =
            state.range(0) > 0 ? new PlacedObject : new osg::Group;
        object->addChild(geode);
        places.emplace_back(new osg::MatrixTransform(osg::Matrix::translate(placeOf(i, 0))));
        places.back()->addChild(object);
        lighting->addChild(places.back());
    }
    const osg::ref_ptr<osgViewer::Viewer> viewer = new osgViewer::Viewer;
    viewer->setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer->setReleaseContextAtEndOfFrameHint(false);
    osg::Camera& camera = *viewer->getCamera();
    camera.setGraphicsContext(context->window());
    camera.setViewport(0, 0, 256, 256);
    camera.setProjectionMatrixAsPerspective(35.0, 1.0, 1.0, 200.0);
    camera.setViewMatrixAsLookAt(osg::Vec3d(0.0, -40.0, 25.0), osg::Vec3d(0.0, 0.0, 0.0),
                                 osg::Vec3d(0.0, 0.0, 1.0));
    viewer->setSceneData(lighting);
    for (int i = 0; i < 10; ++i)
        viewer->frame();
    int frame = 0;
    for (auto _ : state)
    {
        if (state.range(0) == 2)
            for (int i = 0; i < aSide * aSide; ++i)
                places[static_cast<std::size_t>(i)]->setMatrix(
                    osg::Matrix::translate(placeOf(i, frame)));
        ++frame;
        viewer->frame();
        glFinish();
    }
}
} // namespace

BENCHMARK(volumeOfMovingBoxes)->Arg(1)->Arg(8)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK(volumeOfDeformingForm)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(factorOfMovingBoxes)->Unit(benchmark::kMillisecond);
BENCHMARK(frameOfBoxes)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);
