#include "io/EnvironmentFile.h"
#include <osgTerrainLight/Environment.h>

#include <osg/Notify>

#include <exception>
#include <memory>
#include <utility>

namespace osgTerrainLight
{

std::shared_ptr<const Environment> readEnvironment(const std::string& path, std::string& problem)
try
{
    Result<EnvironmentPicture> picture = readEnvironmentFile(path);
    if (!picture)
    {
        problem = picture.error().message;
        return nullptr;
    }
    if (!picture->warning.empty())
        OSG_WARN << "osgTerrainLight: " << picture->warning << std::endl;
    const std::shared_ptr<const Environment> made =
        createEnvironment(picture->columns, picture->rows, std::move(picture->radiance), problem);
    if (!made)
    {
        problem = path + ": " + problem;
        return nullptr;
    }
    // Nobody else has it yet.
    std::const_pointer_cast<Environment>(made)->name = path;
    return made;
}
catch (const std::exception& error) // no memory
{
    problem = path + ": cannot be read: " + error.what();
    return nullptr;
}

} // namespace osgTerrainLight
