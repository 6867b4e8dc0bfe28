#pragma once

#include "core/Result.h"
#include "io/LevelFile.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Where the levels of a raster are kept, and what they depend on.
struct LevelCache
{
    std::string path;     ///< of the raster
    std::string folder;   ///< to keep them in; empty: beside the raster
    std::string variant;  ///< part of the file's name, so that one raster can have several
    std::string contents; ///< options and place that levels depend on, as text

    /// Of the contents and of every file that the raster is made of: path, size, time of change.
    /// Overviews do not count, since they are not used.
    std::string stamp() const;
    /// Where the file may be, best first: in the folder, under a name by the raster's path; else
    /// beside the raster, then in the user's cache folder, since the raster's may be read-only.
    std::vector<std::string> places() const;
};

/// Writes the rows of a file that was created, and gives what else is known of the raster.
using BuildLevels = std::function<Result<LevelFacts>(LevelFileWriter& writer)>;

/// The file whose stamp matches, or one that is made: under a hidden temporary name, and moved to
/// its place when it is whole. Notes say where an old one was of no use, and where the new one is
/// not beside its raster. build: is called once at most; where it fails, nothing is left behind.
Result<std::unique_ptr<LevelFile>> openLevels(const LevelCache& cache,
                                              const std::vector<LevelPlane>& planes,
                                              std::vector<std::string>& notes,
                                              const BuildLevels& build);

} // namespace osgTerrainLight
