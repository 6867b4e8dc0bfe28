#pragma once

#include <string>
#include <vector>

namespace osg
{
class Node;
}

namespace osgTerrainLight::tool
{

/// Names of the files that a scene was read from beside its own: pictures of textures, scenes in it
/// that are loaded by name, each as it stands there and as it is found beside `scene`, the scene's
/// own file.
std::vector<std::string> filesOfScene(osg::Node& root, const std::string& scene);

} // namespace osgTerrainLight::tool
