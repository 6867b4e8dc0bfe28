#include "BenchObjects.h"

#include "BenchFiles.h"
#include "BenchObjectReport.h"

#include <iostream>
#include <utility>

namespace osgTerrainLight::tool::bench
{

Status runObjects(const Options& options, const std::string& date)
{
    if (Status writable = checkOutputs(options); !writable)
        return writable;
    ObjectReport report;
    report.date = date;
    report.scenes = options.scenes;
    report.places = options.places;
    report.seed = options.seed;
    report.repeats = options.repeats;
    std::vector<ObjectResult> results;
    {
        Progress progress(options.quiet);
        progress.reach(0.0);
        const double all = double(allGrounds().size()) * options.scenes;
        for (int number = 0; number < options.scenes; ++number)
            for (const Ground ground : allGrounds())
            {
                Result<ObjectScene> scene =
                    makeObjectScene(number, options.seed, ground, options.places);
                if (!scene)
                    return scene.error();
                Result<MeasuredScene> measured = measureObjects(
                    *scene, options.seed + 977u * std::uint32_t(number), options.repeats);
                if (!measured)
                    return measured.error();
                results.push_back({ground, number, std::move(scene->name), std::move(scene->places),
                                   std::move(*measured)});
                progress.reach(double(results.size()) / all);
            }
    }
    fillRows(report, results);
    std::cout << (options.quiet ? "" : "\n") << tableOf(report) << std::flush;
    return writeFiles(options, report);
}

} // namespace osgTerrainLight::tool::bench
