#pragma once

#include <osgTerrainLight/SkyLight.h>

#include <osg/StateSet>
#include <osg/Texture2DArray>

namespace osgTerrainLight
{

/// What a TerrainLighting tells the shaders of all below it: exposure, the sun and, where some of
/// the ground may be glossy, a texture for tiles that send no light by gloss.
class SceneUniforms
{
public:
    /// exposure [stops]. The StateSet is a new one each time: threads that draw the frame before
    /// still read the old one.
    void set(const SkyLight& sky, double exposure, unsigned glossUnit, bool glossy);

    osg::StateSet* stateSet() const { return _stateSet.get(); }
    bool isGlossy() const { return _glossy; }

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    osg::ref_ptr<osg::StateSet> _stateSet;
    osg::ref_ptr<osg::Texture2DArray> _noGloss; ///< null until some of the ground may be glossy
    bool _glossy = false;
};

} // namespace osgTerrainLight
