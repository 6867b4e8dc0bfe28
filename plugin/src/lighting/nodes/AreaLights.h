#pragma once

#include <osgTerrainLight/Export.h>

#include "core/KeySlices.h"
#include "gpu/GpuPass.h"

#include <osg/Texture2D>
#include <osg/Texture2DArray>
#include <osg/Uniform>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// skyRadiance of shaders/lights.glsl: what the sky's share of light is multiplied by.
OSGTERRAINLIGHT_EXPORT Rgb skyGain(const SkyLight& sky);

/// `harmonics` of shaders: vec3[16], from 1, 4, 9 or 16 coefficients.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Uniform>
harmonicsUniform(const std::vector<Rgb>& harmonics);

/// What passes read for direct light beyond the uniform sky (shaders/lights.glsl).
struct OSGTERRAINLIGHT_EXPORT AreaLights
{
    /// Of SkyTablePass; null where the sky is uniform or off.
    osg::ref_ptr<osg::Texture2D> skyTable;
    /// Elevation codes, a layer per slice; null where no key light lights anything.
    osg::ref_ptr<osg::Texture2DArray> keyHorizon;
    std::vector<KeySlices> keys;
    /// Elevation codes towards the disc's left, centre and right; null where there is no sun.
    osg::ref_ptr<osg::Texture2DArray> sunHorizon;
    SkyLight sky; ///< its sun is read

    /// Makes the pass the variant that reads these, with `defines` of its own: SKY_TABLE,
    /// KEY_LIGHTS, SUN, those that there are.
    void apply(GpuPass& pass, std::vector<std::string> defines = {}) const;
};

} // namespace osgTerrainLight
