#pragma once

#include "io/DemReader.h"
#include "lighting/FarLight.h"

#include <map>
#include <string>

/// Light of a raster's coarse levels, for bounces in its windows.
namespace osgTerrainLight::tool
{

/// In files of half floats, one per level, in a folder. A file gets its name once it is complete,
/// so that the next run finds only what is right.
class FileRadiance : public RadianceStore
{
public:
    explicit FileRadiance(std::string folder) : _folder(std::move(folder)) {}
    ~FileRadiance() override;

    bool has(int level) const override;
    Status begin(int level, int bounces, const PostRect& posts) override;
    Status write(int level, int bounce, const PostRect& posts,
                 const Raster<Rgb>& radiance) override;
    Status end(int level) override;
    Result<Raster<Rgb>> read(int level, int bounce, const PostRect& posts) override;

private:
    struct File
    {
        int number = -1;
        PostRect posts;
    };
    std::string path(int level) const;
    Status open(int level);
    Error failed(int level, const char* what) const;

    const std::string _folder;
    std::map<int, File> _files;
};

/// The mean albedo around posts of a level, 0 for the raster's own, of a raster that readAlbedo()
/// takes; `other` beyond it.
Result<Raster<Rgb>> albedoOfLevel(const std::string& path, const DemInfo& info, int level,
                                  const PostRect& posts, const Rgb& other);

} // namespace osgTerrainLight::tool
