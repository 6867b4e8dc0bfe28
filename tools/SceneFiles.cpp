#include "SceneFiles.h"

#include <osg/NodeVisitor>
#include <osg/PagedLOD>
#include <osg/ProxyNode>
#include <osg/StateSet>
#include <osg/Texture>

#include <filesystem>
#include <set>

namespace osgTerrainLight::tool
{
namespace
{

class FileFinder : public osg::NodeVisitor
{
public:
    FileFinder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}

    void apply(osg::Node& node) override
    {
        if (const osg::StateSet* states = node.getStateSet())
            for (const auto& unit : states->getTextureAttributeList())
                for (const auto& [type, attribute] : unit)
                    addTexture(dynamic_cast<const osg::Texture*>(attribute.first.get()));
        if (const auto* proxy = dynamic_cast<const osg::ProxyNode*>(&node))
            for (unsigned i = 0; i < proxy->getNumFileNames(); ++i)
                names.insert(proxy->getFileName(i));
        if (const auto* paged = dynamic_cast<const osg::PagedLOD*>(&node))
            for (unsigned i = 0; i < paged->getNumFileNames(); ++i)
                names.insert(paged->getFileName(i));
        traverse(node);
    }

    std::set<std::string> names;

private:
    void addTexture(const osg::Texture* texture)
    {
        for (unsigned face = 0; texture && face < texture->getNumImages(); ++face)
            if (const osg::Image* image = texture->getImage(face))
                names.insert(image->getFileName());
    }
};

} // namespace

std::vector<std::string> filesOfScene(osg::Node& root, const std::string& scene)
{
    FileFinder finder;
    root.accept(finder);
    std::vector<std::string> files;
    for (const std::string& name : finder.names)
        if (!name.empty())
        {
            files.push_back(name);
            files.push_back((std::filesystem::path(scene).parent_path() / name).string());
        }
    return files;
}

} // namespace osgTerrainLight::tool
