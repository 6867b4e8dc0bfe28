#pragma once

#include <osgTerrainLight/Environment.h>

#include <osg/Texture2D>

#include <memory>

namespace osgTerrainLight
{

/// An environment on the GPU: RGB32F, laid out as Environment::radiance. As long as anyone holds it
/// there is one for all tiles and probes. Safe from any thread.
osg::ref_ptr<osg::Texture2D>
environmentTexture(const std::shared_ptr<const Environment>& environment);

} // namespace osgTerrainLight
