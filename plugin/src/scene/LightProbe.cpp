#include <osgTerrainLight/LightProbe.h>

#include "lighting/nodes/ProbeNode.h"

#include <osg/GL>
#include <osg/Notify>
#include <osg/Uniform>

#include <cmath>

#ifndef GL_TEXTURE_CUBE_MAP_SEAMLESS
#define GL_TEXTURE_CUBE_MAP_SEAMLESS 0x884F
#endif

namespace osgTerrainLight
{

namespace
{
bool refused(bool wrong, const char* sentence)
{
    if (wrong)
        OSG_WARN << "osgTerrainLight: " << sentence << std::endl;
    return wrong;
}
} // namespace

LightProbe::LightProbe()
    : _diffuse(IrradianceMapPass::createMap(ProbeNode::mapSize)),
      _glossy(IrradianceMapPass::createMap(ProbeNode::mapSize)), _stateSet(new osg::StateSet)
{
    _stateSet->setDataVariance(osg::Object::DYNAMIC); // the exponent may change
    _stateSet->setTextureAttribute(diffuseUnit, _diffuse);
    _stateSet->setTextureAttribute(glossyUnit, _glossy);
    _stateSet->setMode(GL_TEXTURE_CUBE_MAP_SEAMLESS, osg::StateAttribute::ON);
    _stateSet->addUniform(new osg::Uniform(diffuseSampler, static_cast<int>(diffuseUnit)));
    _stateSet->addUniform(new osg::Uniform(glossySampler, static_cast<int>(glossyUnit)));
    _stateSet->addUniform(new osg::Uniform(exponentUniform, static_cast<float>(_exponent)));
}

LightProbe::~LightProbe() = default;

void LightProbe::setPlace(double east, double north)
{
    if (refused(!std::isfinite(east) || !std::isfinite(north),
                "place of probe not set: needs finite metres"))
        return;
    _east = east;
    _north = north;
    ++_revision;
}

void LightProbe::setHeight(double metres, bool aboveGround)
{
    if (refused(!std::isfinite(metres) || (aboveGround && metres < 0.0),
                "height of probe not set: needs finite metres, above the ground 0 or more"))
        return;
    _height = metres;
    _aboveGround = aboveGround;
    ++_revision;
}

void LightProbe::setExponent(double exponent)
{
    if (refused(!(exponent >= 1.0 && exponent <= 64.0),
                "exponent of probe not set: needs 1 ... 64"))
        return;
    _exponent = exponent;
    _stateSet->getUniform(exponentUniform)->set(static_cast<float>(exponent));
    ++_revision;
}

} // namespace osgTerrainLight
