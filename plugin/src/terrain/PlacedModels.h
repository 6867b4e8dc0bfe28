#pragma once

#include "core/Result.h"
#include "io/EarthModel.h"
#include "io/LocalFrame.h"

#include <osg/Node>

#include <map>
#include <string>

namespace osgTerrainLight
{

/// Reads the models of a map, each file once.
class ModelReader
{
public:
    /// The model, by the plugin of OpenSceneGraph for its format. path: with what asks for its
    /// pseudo loaders (house.osgt.45.scale). Errors name the path, and the plugin that is missing.
    Result<osg::ref_ptr<osg::Node>> read(const std::string& path);

private:
    std::map<std::string, Result<osg::ref_ptr<osg::Node>>> _read;
};

/// A PlacedObject of the model, in the frame of the terrain.
osg::ref_ptr<osg::Node> placedModel(const EarthModel& model, const ModelPlace& place,
                                    osg::Node& node);

} // namespace osgTerrainLight
