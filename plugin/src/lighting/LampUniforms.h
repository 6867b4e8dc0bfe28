#pragma once

#include "fields/ObjectLamps.h"

#include <osg/Uniform>
#include <osg/ref_ptr>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// lampCount, lamps and lampRadiances, as shaders have them, behind a prefix. lamps: in the frame
/// of the shader's volume.
std::vector<osg::ref_ptr<osg::Uniform>> lampUniforms(const std::vector<ObjectLamp>& lamps,
                                                     const std::string& prefix = {});

} // namespace osgTerrainLight
