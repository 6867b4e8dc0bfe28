#include "terrain/PlacedModels.h"

#include "io/InputFiles.h"
#include <osgTerrainLight/PlacedObject.h>

#include <osg/LOD>
#include <osg/Math>
#include <osg/MatrixTransform>
#include <osgDB/FileNameUtils>
#include <osgDB/FileUtils>
#include <osgDB/Registry>

#include <cmath>
#include <exception>
#include <limits>
#include <new>

namespace osgTerrainLight
{
namespace
{
/// A model may be a scene that reads others. One that reads a map again would never end.
thread_local bool isReading = false;

class Reading
{
public:
    Reading() { isReading = true; }
    ~Reading() { isReading = false; }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;
};

/// The file in a name that may end in the extensions of pseudo loaders; empty where there is none.
std::string fileIn(std::string name)
{
    while (!name.empty() && osgDB::fileType(name) != osgDB::REGULAR_FILE)
    {
        const std::string shorter = osgDB::getNameLessExtension(name);
        if (shorter == name)
            return {};
        name = shorter;
    }
    return name;
}

/// Why a file cannot be a model; empty where nothing speaks against it.
std::string complaintOfModel(const std::string& file, const std::string& path)
{
    for (std::string name = path; name.size() >= file.size();)
    {
        const std::string extension = osgDB::getLowerCaseFileExtension(name);
        if (extension == "earth" || extension == "terrainlight")
            return "is a map; needs a model";
        const std::string shorter = osgDB::getNameLessExtension(name);
        if (shorter == name)
            break;
        name = shorter;
    }
    const std::string extension = osgDB::getFileExtension(file);
    if (extension.empty())
        return "has no extension that names its format";
    osgDB::Registry& registry = *osgDB::Registry::instance();
    if (!registry.getReaderWriterForExtension(osgDB::convertToLowerCase(extension)))
        return "needs the plugin " +
               osgDB::getStrippedName(registry.createLibraryNameForExtension(extension)) +
               " of OpenSceneGraph, which is not installed";
    return {};
}

Result<osg::ref_ptr<osg::Node>> readNow(const std::string& path)
{
    if (const std::string wrong = complaintOfFile(path); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    const std::string file = fileIn(path);
    if (file.empty())
        return Error{ErrorCode::NotFound, path + ": no such file"};
    if (isReading)
        return Error{ErrorCode::NotSupported, path + ": belongs to a map within a model"};
    const Reading reading;
    if (const std::string wrong = complaintOfModel(file, path); !wrong.empty())
        return Error{ErrorCode::NotSupported, path + ": " + wrong};
    const osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
    options->getDatabasePathList().push_front(osgDB::getFilePath(file));
    osgDB::ReaderWriter::ReadResult read = osgDB::Registry::instance()->readNode(path, options);
    const osg::ref_ptr<osg::Node> node = read.getNode();
    if (!node)
        return Error{ErrorCode::Invalid,
                     path + ": is no model that OpenSceneGraph reads" +
                         (read.message().empty() ? "" : " (" + read.message() + ")")};
    const osg::BoundingSphere& bound = node->getBound();
    if (!bound.valid() || !std::isfinite(bound.radius()) || !std::isfinite(bound.center().length()))
        return Error{ErrorCode::Invalid, path + ": draws nothing that has a finite size"};
    return node;
}

/// What plugins throw ends here: the rest of the map is drawn.
Result<osg::ref_ptr<osg::Node>> readGuarded(const std::string& path)
{
    try
    {
        return readNow(path);
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed, path + ": not enough memory"};
    }
    catch (const std::exception& error)
    {
        return Error{ErrorCode::Failed, path + ": cannot be read: " + error.what()};
    }
}
} // namespace

Result<osg::ref_ptr<osg::Node>> ModelReader::read(const std::string& path)
{
    const auto found = _read.find(path);
    return found != _read.end() ? found->second
                                : _read.emplace(path, readGuarded(path)).first->second;
}

osg::ref_ptr<osg::Node> placedModel(const EarthModel& model, const ModelPlace& place,
                                    osg::Node& node)
{
    osg::ref_ptr<osg::Node> drawn = &node;
    const auto& [x, y, z] = model.scales;
    if (x != 1.0 || y != 1.0 || z != 1.0)
    {
        const osg::ref_ptr<osg::MatrixTransform> scaled =
            new osg::MatrixTransform(osg::Matrixd::scale(x, y, z));
        scaled->addChild(drawn);
        // Normals keep their length in fixed-function drawing, too.
        scaled->getOrCreateStateSet()->setMode(GL_NORMALIZE, osg::StateAttribute::ON);
        drawn = scaled;
    }
    const bool isAlways = model.minRange <= 0.0 && std::isinf(model.maxRange);
    if (!isAlways) // above the scale, since ranges are metres
    {
        const osg::ref_ptr<osg::LOD> inRange = new osg::LOD;
        const double most = double(std::numeric_limits<float>::max());
        inRange->addChild(drawn, static_cast<float>(model.minRange),
                          static_cast<float>(std::min(model.maxRange, most)));
        drawn = inRange;
    }
    const osg::ref_ptr<PlacedObject> object = new PlacedObject;
    object->setName(model.name.empty() ? model.url : model.name);
    object->addChild(drawn);
    using osg::DegreesToRadians;
    using osg::Matrixd;
    const osg::ref_ptr<osg::MatrixTransform> placed =
        new osg::MatrixTransform(Matrixd::rotate(DegreesToRadians(model.roll), 0.0, 1.0, 0.0) *
                                 Matrixd::rotate(DegreesToRadians(model.pitch), 1.0, 0.0, 0.0) *
                                 Matrixd::rotate(-DegreesToRadians(place.heading), 0.0, 0.0, 1.0) *
                                 Matrixd::translate(place.x, place.y, place.z));
    placed->setName(object->getName());
    placed->addChild(object);
    return placed;
}

} // namespace osgTerrainLight
