#include "fields/FieldCache.h"

#include "fields/FieldFile.h"

#include <cstdio>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>

namespace osgTerrainLight
{

namespace
{
std::string pathIn(const std::string& folder, const FieldKey& key)
{
    char name[48];
    std::snprintf(name, sizeof name, "%016llx%016llx.field",
                  static_cast<unsigned long long>(key[0]), static_cast<unsigned long long>(key[1]));
    return (std::filesystem::path(folder) / name).string();
}
} // namespace

FieldCache::FieldCache(std::string folder) : _folder(std::move(folder)) {}

std::string FieldCache::pathOf(const TriangleMesh& mesh, const BakeOptions& options) const
{
    return pathIn(_folder, fieldKey(mesh, options));
}

Result<CachedField> FieldCache::bake(const TriangleMesh& mesh, const BakeOptions& options) const
{
    const FieldKey key = fieldKey(mesh, options);
    const std::string path = pathIn(_folder, key);
    try
    {
        if (!_folder.empty())
            if (std::optional<BakedField> kept = readField(path, key))
                return CachedField{std::move(*kept), true, {}};
        Result<BakedField> made = bakeMesh(mesh, options);
        if (!made)
            return made.error();
        roundToFile(made->grid);
        CachedField result{std::move(*made), false, {}};
        if (!_folder.empty())
        {
            std::error_code failure; // writing says what is wrong with the folder
            std::filesystem::create_directories(_folder, failure);
            if (const Status written = writeField(path, key, result.field); !written)
                result.problem = written.error().message;
        }
        return result;
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed, "distance field: not enough memory"};
    }
}

} // namespace osgTerrainLight
