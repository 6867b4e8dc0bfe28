#include "io/InputFiles.h"

#include "io/EarthFile.h"
#include "io/GdalErrors.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

namespace osgTerrainLight
{

namespace
{
namespace fs = std::filesystem;

bool isFile(const std::string& path)
{
    std::error_code failure;
    return !path.empty() && fs::is_regular_file(path, failure);
}

/// Collects files, each once.
class Collector
{
public:
    void add(const std::string& input)
    {
        if (input.empty() || !_seen.insert(input).second || !complaintOfFile(input).empty())
            return;
        addNamed(input);
        const std::string extension = CPLGetExtension(input.c_str());
        if (EQUAL(extension.c_str(), "earth"))
            addMap(input);
        else if (!isFile(input) || !isPlain(input))
            addSources(input);
    }

    std::vector<std::string> files;

private:
    /// With what GDAL reads beside it, which not every driver lists: place and CRS above all (.tfw,
    /// .tifw, .wld, .prj for a .tif).
    void addFile(const std::string& path)
    {
        const auto addWhereThere = [this](const std::string& file)
        {
            if (isFile(file) && _files.insert(file).second)
                files.push_back(file);
        };
        for (const char* sidecar : {"", ".aux.xml", ".ovr", ".msk"})
            addWhereThere(path + sidecar);
        const std::string extension = fs::path(path).extension().string();
        if (extension.size() < 2)
            return;
        const std::string stem = path.substr(0, path.size() - extension.size());
        for (const std::string& beside : {std::string(".wld"),
                                          std::string(".prj"),
                                          extension + "w",
                                          {'.', extension[1], extension.back(), 'w'}})
            addWhereThere(stem + beside);
    }

    /// The file itself, or the files that stand in a dataset's name. A file's own name may have
    /// what parts others ("a,b.tif"), so all that stands between any two such signs is looked at.
    void addNamed(const std::string& name)
    {
        if (isFile(name))
            return addFile(name);
        const std::string parting = ":\"?&,|{}";
        constexpr std::size_t mostParts = 8; // in one file's name; some datasets' names are long
        std::vector<std::size_t> starts;
        for (std::size_t at = 0; at <= name.size(); ++at)
        {
            if (at == 0 || parting.find(name[at - 1]) != std::string::npos)
                starts.push_back(at);
            if (at == name.size() || parting.find(name[at]) != std::string::npos)
                for (std::size_t i = starts.size() - std::min(starts.size(), mostParts);
                     i < starts.size(); ++i)
                    addPath(name.substr(starts[i], at - starts[i]));
        }
    }

    /// A file, or of a path into an archive the archive.
    void addPath(std::string path)
    {
        if (path.rfind("//", 0) == 0) // vrt://a.tif
            path.erase(0, 2);
        while (path.rfind("/vsi", 0) == 0 && path.find('/', 1) != std::string::npos)
            path.erase(0, path.find('/', 1) + 1);
        for (fs::path at = path; !at.empty() && at != at.parent_path(); at = at.parent_path())
        {
            addFile(at.string());
            addFile("/" + at.string()); // /vsizip//folder/a.zip
        }
    }

    /// Pictures that GDAL does not open, or not as we do.
    static bool isPlain(const std::string& path)
    {
        const std::string extension = CPLGetExtension(path.c_str());
        for (const char* plain : {"exr", "pic", "osgt", "osgb", "osgx", "ive"})
            if (EQUAL(extension.c_str(), plain))
                return true;
        return false;
    }

    void addSources(const std::string& name)
    {
        const GdalErrors quiet;
        const GDALDatasetUniquePtr dataset(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER));
        if (!dataset)
            return;
        const bool isVirtual =
            dataset->GetDriver() && EQUAL(dataset->GetDriver()->GetDescription(), "VRT");
        const CPLStringList list(dataset->GetFileList());
        for (int i = 0; i < list.size(); ++i)
            if (isVirtual)
                add(list[i]);
            else
                addNamed(list[i]);
    }

    void addMap(const std::string& path)
    {
        const Result<EarthMap> map = readEarthFile(path);
        if (!map)
            return;
        const std::string folder = CPLGetPath(path.c_str());
        const auto addFrom = [&](const std::string& url)
        {
            add(url);
            if (!folder.empty())
                add(CPLFormFilename(folder.c_str(), url.c_str(), nullptr));
        };
        for (const auto* layers : {&map->elevations, &map->images})
            for (const EarthLayer& layer : *layers)
                addFrom(layer.url);
        for (const EarthModel& model : map->models)
            addFrom(model.url);
        if (!map->light.skyFile.empty())
            addFrom(map->light.skyFile);
    }

    std::set<std::string> _seen, _files;
};
} // namespace

std::vector<std::string> filesOf(const std::string& input)
{
    Collector collector;
    collector.add(input);
    // OpenSceneGraph's readers are asked for by further extensions, with arguments before them:
    // a.tif.terrainlight, a.osgt.0,0,90.rot.
    std::string name = input;
    for (std::size_t dot = 0; !isFile(name) && (dot = name.rfind('.')) != std::string::npos;)
    {
        name.erase(dot);
        collector.add(name);
    }
    return collector.files;
}

std::string complaintOfFile(const std::string& path)
{
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    return !fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status)
               ? std::string()
               : "is a device or a pipe; needed a file";
}

std::string stateOfFile(const std::string& path)
{
    VSIStatBufL stat;
    if (VSIStatL(path.c_str(), &stat) != 0)
        return "none";
    std::error_code failure;
    const auto time = fs::last_write_time(path, failure);
    return std::to_string(stat.st_size) + " bytes, written at " +
           (failure ? std::to_string(stat.st_mtime)
                    : std::to_string(time.time_since_epoch().count()));
}

std::string sameFile(const std::vector<std::string>& inputs, const std::string& output)
{
    std::error_code failure;
    for (const std::string& input : inputs)
        if (fs::equivalent(input, output, failure))
            return input;
    return {};
}

} // namespace osgTerrainLight
