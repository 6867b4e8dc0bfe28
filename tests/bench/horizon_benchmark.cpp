// Time of the stages on generated terrain: horizons by quality and size, sun, sky view and shading;
// of updates in which the sun moves, by the interval between bounces; of irradiance
// maps, and under an environment. Wall
// clock, ended by glFinish. The rate counts posts times azimuths, or maps.
#include "core/SyntheticTerrain.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/EnvironmentHarmonicsPass.h"
#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/HeadlessContext.h>

#include <benchmark/benchmark.h>

#include <cstdio>

using namespace osgTerrainLight;

namespace
{
HeadlessContext* context()
{
    static std::string problem;
    static const auto created = HeadlessContext::create(16, 16, problem);
    if (!created)
        std::fprintf(stderr, "%s\n", problem.c_str());
    return created.get();
}

/// Re-runs all stages after a touch, and counts the time of the one named.
void runStage(benchmark::State& bench, const char* stage, HorizonQuality quality, int size,
              int azimuths)
{
    if (!context())
    {
        bench.SkipWithError("no OpenGL context");
        return;
    }
    osg::State& state = context()->state();
    const DemTile tile = generateTerrain(TerrainKind::Fractal, size, size, 30.0, 1).value();
    LightingSettings settings;
    settings.quality = quality;
    settings.azimuths = azimuths;
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, SkyLight());
    lighting->setTimed(true);
    if (const Status first = lighting->update(state); !first) // compiles the shaders
    {
        bench.SkipWithError(first.error().message.c_str());
        return;
    }
    double work = static_cast<double>(tile.postCount());
    for (auto _ : bench)
    {
        lighting->touch();
        benchmark::DoNotOptimize(lighting->update(state));
        for (const StageCost& cost : lighting->costs())
            if (cost.name == stage)
                bench.SetIterationTime(cost.milliseconds * 1.0e-3);
    }
    if (std::string(stage) == "horizon" || std::string(stage) == "sky")
        work *= azimuths;
    bench.counters["rate"] = benchmark::Counter(work * static_cast<double>(bench.iterations()),
                                                benchmark::Counter::kIsRate);
}

#define OTL_BENCHMARK(stage, quality)                                                              \
    BENCHMARK_CAPTURE(benchmarkStage, stage##_##quality, #stage, HorizonQuality::quality)          \
        ->ArgNames({"size", "azimuths"})                                                           \
        ->Unit(benchmark::kMillisecond)                                                            \
        ->UseManualTime()

void benchmarkStage(benchmark::State& bench, const char* stage, HorizonQuality quality)
{
    runStage(bench, stage, quality, static_cast<int>(bench.range(0)),
             static_cast<int>(bench.range(1)));
}

/// A sun that moves over still heights, two bounces, by bounceInterval: the mean update.
void movingSun(benchmark::State& bench)
{
    if (!context())
    {
        bench.SkipWithError("no OpenGL context");
        return;
    }
    osg::State& state = context()->state();
    const int size = static_cast<int>(bench.range(0));
    LightingSettings settings;
    settings.bounces = 2;
    settings.bounceInterval = static_cast<int>(bench.range(1));
    SkyLight sky;
    const osg::ref_ptr<TileLight> lighting = new TileLight(
        generateTerrain(TerrainKind::Fractal, size, size, 30.0, 1).value(), settings, sky);
    const auto moveAndUpdate = [&]
    {
        sky.sunAzimuth += 1.0;
        lighting->setSky(sky);
        benchmark::DoNotOptimize(lighting->update(state));
        glFinish();
    };
    moveAndUpdate();
    for (auto _ : bench)
        for (int i = 0; i < 8; ++i) // whole rounds of each interval
            moveAndUpdate();
    bench.counters["updates"] = benchmark::Counter(8.0 * static_cast<double>(bench.iterations()),
                                                   benchmark::Counter::kIsRate);
}
BENCHMARK(movingSun)
    ->ArgNames({"size", "interval"})
    ->ArgsProduct({{128, 512}, {1, 2, 4, 8}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// King 2005, section 10.4: a diffuse map of 32² × 6 texels from a cube map of 64² × 6, anew each
/// time.
void irradianceMap(benchmark::State& bench)
{
    if (!context())
    {
        bench.SkipWithError("no OpenGL context");
        return;
    }
    osg::State& state = context()->state();
    const int order = static_cast<int>(bench.range(0));
    const osg::ref_ptr<osg::TextureCubeMap> environment = IrradianceMapPass::createMap(64);
    const osg::ref_ptr<osg::TextureCubeMap> map = IrradianceMapPass::createMap(32);
    const osg::ref_ptr<EnvironmentHarmonicsPass> project = new EnvironmentHarmonicsPass(order);
    const osg::ref_ptr<IrradianceMapPass> evaluate =
        new IrradianceMapPass(project->harmonics(), order);
    const auto compute = [&]
    {
        const bool done = project->dispatch(state, environment).ok() &&
                          evaluate->dispatchDiffuse(state, map, {}).ok();
        glFinish();
        return done;
    };
    if (!compute()) // compiles the shaders
    {
        bench.SkipWithError("the shaders do not compile");
        return;
    }
    for (auto _ : bench)
        benchmark::DoNotOptimize(compute());
    bench.counters["rate"] =
        benchmark::Counter(static_cast<double>(bench.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(irradianceMap)
    ->ArgName("order")
    ->Arg(3)
    ->Arg(6)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// TW10, section 9: a height field of so many posts and azimuths under an environment of 256 angles
/// of elevation (our tables keep 128), heights and environment anew each time; no sun.
void environment(benchmark::State& bench)
{
    if (!context())
    {
        bench.SkipWithError("no OpenGL context");
        return;
    }
    osg::State& state = context()->state();
    const int size = static_cast<int>(bench.range(0));
    LightingSettings settings;
    settings.azimuths = static_cast<int>(bench.range(1));
    std::vector<Rgb> radiance(256 * 512);
    for (std::size_t i = 0; i < radiance.size(); ++i)
        radiance[i].fill(static_cast<float>((i * 7919) % 1000) * 1.0e-3f);
    std::string problem;
    SkyLight sky;
    sky.setEnvironment(createEnvironment(256, 512, std::move(radiance), problem));
    const osg::ref_ptr<TileLight> lighting = new TileLight(
        generateTerrain(TerrainKind::Fractal, size, size, 30.0, 1).value(), settings, sky);
    lighting->setTimed(true);
    const auto compute = [&]
    {
        lighting->recompute();
        return lighting->update(state).ok();
    };
    if (!compute()) // compiles the shaders
    {
        bench.SkipWithError("the light cannot be computed");
        return;
    }
    for (auto _ : bench)
        benchmark::DoNotOptimize(compute());
    for (const StageCost& cost : lighting->costs())
        bench.counters[cost.name + "_ms"] = cost.milliseconds;
    bench.counters["rate"] =
        benchmark::Counter(static_cast<double>(bench.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(environment)
    ->ArgNames({"size", "azimuths"})
    ->Args({1024, 64})
    ->Args({512, 32})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

OTL_BENCHMARK(horizon, Draft)->Args({512, 32})->Args({1024, 32});
OTL_BENCHMARK(horizon, Normal)->Args({256, 32})->Args({512, 32})->Args({1024, 32})->Args({512, 8});
OTL_BENCHMARK(horizon, Best)->Args({512, 32})->Args({1024, 32});
OTL_BENCHMARK(sun, Normal)->Args({512, 4})->Args({1024, 4});
OTL_BENCHMARK(sky, Normal)->Args({512, 32})->Args({1024, 32});
OTL_BENCHMARK(shade, Normal)->Args({512, 4})->Args({1024, 4});
} // namespace

BENCHMARK_MAIN();
