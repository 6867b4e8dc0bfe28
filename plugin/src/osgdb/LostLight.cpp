#include "osgdb/LostLight.h"

#include <osgTerrainLight/TerrainLighting.h>

#include <osg/NodeVisitor>
#include <osg/Notify>
#include <osgDB/Callbacks>
#include <osgDB/FileNameUtils>
#include <osgDB/Registry>

#include <string>

namespace osgTerrainLight
{

namespace
{
class LightFinder : public osg::NodeVisitor
{
public:
    LightFinder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
    void apply(osg::Group& group) override
    {
        found = found || dynamic_cast<TerrainLighting*>(&group);
        if (!found)
            traverse(group);
    }

    bool found = false;
};

/// Formats of osgDB's serializers.
bool keepsLight(const std::string& path)
{
    std::string extension = osgDB::getLowerCaseFileExtension(path);
    if (extension == "gz")
        extension = osgDB::getLowerCaseFileExtension(osgDB::getNameLessExtension(path));
    return extension == "osgt" || extension == "osgb" || extension == "osgx";
}

class Watcher : public osgDB::WriteFileCallback
{
public:
    using Result = osgDB::ReaderWriter::WriteResult;

    Result writeObject(const osg::Object& object, const std::string& path,
                       const osgDB::Options* options) override
    {
        const Result result = osgDB::WriteFileCallback::writeObject(object, path, options);
        if (const auto* node = dynamic_cast<const osg::Node*>(&object))
            say(*node, path, result);
        return result;
    }

    Result writeNode(const osg::Node& node, const std::string& path,
                     const osgDB::Options* options) override
    {
        const Result result = osgDB::WriteFileCallback::writeNode(node, path, options);
        say(node, path, result);
        return result;
    }

private:
    static void say(const osg::Node& node, const std::string& path, const Result& result)
    {
        if (!result.success() || keepsLight(path))
            return;
        LightFinder finder;
        const_cast<osg::Node&>(node).accept(finder); // which changes nothing
        if (finder.found)
            OSG_WARN << "osgTerrainLight: " << path
                     << ": the light is left out: this format does not hold it; .osgt, .osgb and "
                        ".osgx do"
                     << std::endl;
    }
};

/// Holds the callback as long as the library is loaded.
class Watch
{
public:
    Watch() : _watcher(new Watcher)
    {
        if (!osgDB::Registry::instance()->getWriteFileCallback())
            osgDB::Registry::instance()->setWriteFileCallback(_watcher);
    }
    ~Watch()
    {
        osgDB::Registry* registry = osgDB::Registry::instance();
        if (registry && registry->getWriteFileCallback() == _watcher)
            registry->setWriteFileCallback(nullptr);
    }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

private:
    osg::ref_ptr<Watcher> _watcher;
};
} // namespace

void warnOfLostLight()
{
    static const Watch watch;
}

} // namespace osgTerrainLight
