#include "io/LevelCache.h"

#include "io/CacheFolder.h"
#include "io/GdalErrors.h"
#include "io/InputFiles.h"
#include "io/PendingFile.h"

#include <cpl_string.h>
#include <cpl_vsi.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>

namespace osgTerrainLight
{
namespace
{
namespace fs = std::filesystem;
constexpr const char* suffix = ".terrainlight-levels";

std::string hashOf(const std::string& text)
{
    return CPLSPrintf("%016llx", static_cast<unsigned long long>(checksumOf(text)));
}

bool endsWith(const std::string& text, const std::string& end)
{
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string absolute(const std::string& path)
{
    std::error_code failure;
    const fs::path result = fs::weakly_canonical(path, failure);
    return failure || path.compare(0, 4, "/vsi") == 0 ? path : result.string();
}

/// Removes what a program that was killed left of this file: one that nobody has written to for an
/// hour.
void removeAbandoned(const std::string& place)
{
    const fs::path file(place);
    std::error_code failure;
    std::vector<fs::path> found;
    for (fs::directory_iterator at(fs::absolute(file).parent_path(), failure), end;
         !failure && at != end; at.increment(failure))
        if (PendingFile::isFolderOfOne(at->path().filename().string()))
            found.push_back(at->path());
    for (const fs::path& folder : found)
    {
        const auto time = fs::last_write_time(folder / file.filename(), failure);
        if (!failure && fs::file_time_type::clock::now() - time > std::chrono::hours(1))
            fs::remove_all(folder, failure);
    }
}

/// Of a file that this place cannot have; nothing where it was made. The error of build() goes to
/// `failed`.
std::optional<std::string> make(const std::string& place, const std::string& stamp,
                                const std::vector<LevelPlane>& planes, const BuildLevels& build,
                                std::optional<Error>& failed)
{
    removeAbandoned(place);
    PendingFile pending(place);
    if (const Status status = pending.create(true); !status)
        return status.error().message;
    GdalErrors errors;
    LevelFileWriter writer;
    const double bytes = LevelFileWriter::bytes(planes);
    const auto cannotWrite = [&]
    {
        return Error{ErrorCode::Failed,
                     place + ": cannot write " + CPLSPrintf("%.0f", bytes / 1.0e6) +
                         " MB of coarse levels: " +
                         pending.reason(errors.hasMessage() ? errors.first() : "", bytes) +
                         "; another folder for them can be given"};
    };
    if (!writer.create(pending.path(), planes))
    {
        failed = cannotWrite();
        return std::nullopt;
    }
    Result<LevelFacts> facts = build(writer);
    if (!facts)
    {
        failed = writer.failed() ? cannotWrite() : facts.error();
        return std::nullopt;
    }
    facts->stamp = stamp;
    if (!writer.finish(*facts))
        failed = cannotWrite();
    else if (const Status status = pending.commit(); !status)
        failed = status.error();
    return std::nullopt;
}
} // namespace

std::string LevelCache::stamp() const
{
    std::string text = absolute(path) + "\n" + contents + "\n" + stateOfFile(path) + "\n";
    for (const std::string& file : filesOf(path))
        if (!endsWith(file, ".ovr") && !endsWith(file, suffix))
            text += absolute(file) + " " + stateOfFile(file) + "\n";
    return hashOf(text);
}

std::vector<std::string> LevelCache::places() const
{
    const std::string name = fs::path(path).filename().string();
    const std::string hidden = name.substr(0, 80) + "-" + hashOf(absolute(path)) + variant + suffix;
    if (!folder.empty())
        return {(fs::path(folder) / hidden).string()};
    std::vector<std::string> result;
    // A name such as NETCDF:"a.nc":height is no path, and nothing is written into an archive.
    const bool hasFolder = path.compare(0, 4, "/vsi") != 0 || path.compare(0, 8, "/vsimem/") == 0;
    VSIStatBufL stat;
    if (hasFolder && VSIStatL(path.c_str(), &stat) == 0)
        result.push_back(path + variant + suffix);
    if (const std::string user = userCacheFolder(); !user.empty())
        result.push_back((fs::path(user) / hidden).string());
    return result;
}

Result<std::unique_ptr<LevelFile>> openLevels(const LevelCache& cache,
                                              const std::vector<LevelPlane>& planes,
                                              std::vector<std::string>& notes,
                                              const BuildLevels& build)
{
    const std::string stamp = cache.stamp();
    const std::vector<std::string> places = cache.places();
    for (const std::string& place : places)
    {
        Result<std::unique_ptr<LevelFile>> kept = LevelFile::open(place);
        if (kept && (*kept)->facts().stamp == stamp)
            return kept;
        if (kept)
            notes.push_back(place + ": was made of another state of the raster, or with other "
                                    "options: coarse levels are made anew");
        else if (kept.error().code != ErrorCode::NotFound)
            notes.push_back(kept.error().message + ": coarse levels are made anew");
    }
    std::string refusals;
    for (const std::string& place : places)
    {
        if (place != places.front() || !cache.folder.empty())
        {
            std::error_code failure; // told of by the attempt to write
            fs::create_directories(fs::path(place).parent_path(), failure);
        }
        std::optional<Error> failed;
        if (const auto refusal = make(place, stamp, planes, build, failed))
        {
            refusals += (refusals.empty() ? "" : "; ") + *refusal;
            continue;
        }
        if (failed)
            return *failed;
        if (!refusals.empty())
            notes.push_back("coarse levels are kept in " + place + " (" + refusals + ")");
        return LevelFile::open(place);
    }
    return Error{ErrorCode::Failed,
                 cache.path +
                     ": there is no place for its coarse levels; needed a folder for them" +
                     (refusals.empty() ? "" : " (" + refusals + ")")};
}

} // namespace osgTerrainLight
