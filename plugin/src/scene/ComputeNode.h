#pragma once

#include "scene/Scheduler.h"

#include <osg/Camera>

namespace osgTerrainLight
{

/// Runs a scheduler before the scene is drawn.
class ComputeNode : public osg::Camera
{
public:
    explicit ComputeNode(Scheduler* scheduler);

private:
    ~ComputeNode() override = default;
};

} // namespace osgTerrainLight
