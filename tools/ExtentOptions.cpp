#include "Options.h"

#include "Windows.h"

#include <algorithm>
#include <charconv>

namespace osgTerrainLight::tool
{
namespace
{

/// I/N, or nothing where it is not that.
std::optional<Job> readJob(const std::string& text)
{
    Job job;
    const char* end = text.data() + text.size();
    const auto [slash, wrong] = std::from_chars(text.data(), end, job.index);
    if (wrong != std::errc() || slash == end || *slash != '/')
        return std::nullopt;
    const auto [last, alsoWrong] = std::from_chars(slash + 1, end, job.count);
    if (alsoWrong != std::errc() || last != end || job.index < 1 || job.index > job.count)
        return std::nullopt;
    return job;
}

} // namespace

void addExtentOptions(CLI::App& app, ExtentOptions& extent, bool jobs)
{
    app.add_option("--surroundings", extent.surroundings,
                   "DEM of the terrain around INPUT, of any CRS and resolution; may be repeated: "
                   "the first that has a height counts")
        ->type_name("FILE")
        ->allow_extra_args(false);
    app.add_flag("--isolated", extent.isolated,
                 "Terrain outside of -srcwin casts no shadow and sends no light");
    extent.memory = defaultMemory();
    addLimitedNumbers(app, "--memory", "MIB", {{"memory", 256.0, 1e7, false}},
                      "Memory that the run may take. A raster that needs more is lit in windows; "
                      "256 MiB or more; default a quarter of the machine's, at most 1536",
                      [&extent](const auto& v) { extent.memory = v[0] * 1024.0 * 1024.0; });
    addLimitedNumbers(
        app, "--window-size", "POSTS",
        {{"window size", WindowGrid::unit, WindowGrid::mostPosts, true}},
        "For tests: side of the windows, rounded down to a multiple of 64; default by --memory",
        [&extent](const auto& v) { extent.windowSize = static_cast<int>(v[0]); });
    app.add_option("--cache", extent.cache,
                   "Folder for coarse levels of terrain; default $OSGTERRAINLIGHT_CACHE, else "
                   "beside each raster")
        ->envname("OSGTERRAINLIGHT_CACHE")
        ->type_name("DIR");
    if (!jobs)
        return;
    app.add_option_function<std::string>(
           "--job",
           [&extent](const std::string& given)
           {
               extent.job = readJob(given);
               if (!extent.job)
                   throw CLI::ValidationError(
                       "--job", "'" + given + "': needs I/N, a share and the number of shares");
           },
           "Computes one of N shares of the windows only. The same command without --job then "
           "joins them")
        ->type_name("I/N");
}

} // namespace osgTerrainLight::tool
