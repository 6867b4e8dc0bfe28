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

struct LightProbe::Implementation
{
    double east = 0.0, north = 0.0;
    double height = 1.0;
    bool aboveGround = true;
    double exponent = 16.0;
    unsigned revision = 0;
    unsigned diffuseUnit = LightProbe::diffuseUnit, glossyUnit = LightProbe::glossyUnit;
    osg::ref_ptr<osg::TextureCubeMap> diffuse = IrradianceMapPass::createMap(ProbeNode::mapSize);
    osg::ref_ptr<osg::TextureCubeMap> glossy = IrradianceMapPass::createMap(ProbeNode::mapSize);
    osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
};

LightProbe::LightProbe() : _implementation(new Implementation)
{
    _implementation->stateSet->setDataVariance(osg::Object::DYNAMIC); // the exponent may change
    _implementation->stateSet->setTextureAttribute(diffuseUnit, _implementation->diffuse);
    _implementation->stateSet->setTextureAttribute(glossyUnit, _implementation->glossy);
    _implementation->stateSet->setMode(GL_TEXTURE_CUBE_MAP_SEAMLESS, osg::StateAttribute::ON);
    _implementation->stateSet->addUniform(
        new osg::Uniform(diffuseSampler, static_cast<int>(diffuseUnit)));
    _implementation->stateSet->addUniform(
        new osg::Uniform(glossySampler, static_cast<int>(glossyUnit)));
    _implementation->stateSet->addUniform(
        new osg::Uniform(exponentUniform, static_cast<float>(_implementation->exponent)));
}

LightProbe::~LightProbe() = default;

void LightProbe::setPlace(double east, double north)
{
    if (refused(!std::isfinite(east) || !std::isfinite(north),
                "place of probe not set: needs finite metres"))
        return;
    _implementation->east = east;
    _implementation->north = north;
    ++_implementation->revision;
}

void LightProbe::setHeight(double metres, bool aboveGround)
{
    if (refused(!std::isfinite(metres) || (aboveGround && metres < 0.0),
                "height of probe not set: needs finite metres, above the ground 0 or more"))
        return;
    _implementation->height = metres;
    _implementation->aboveGround = aboveGround;
    ++_implementation->revision;
}

void LightProbe::setExponent(double exponent)
{
    if (refused(!(exponent >= 1.0 && exponent <= 64.0),
                "exponent of probe not set: needs 1 ... 64"))
        return;
    _implementation->exponent = exponent;
    _implementation->stateSet->getUniform(exponentUniform)->set(static_cast<float>(exponent));
    ++_implementation->revision;
}

double LightProbe::getEast() const
{
    return _implementation->east;
}

double LightProbe::getNorth() const
{
    return _implementation->north;
}

double LightProbe::getHeight() const
{
    return _implementation->height;
}

bool LightProbe::isAboveGround() const
{
    return _implementation->aboveGround;
}

double LightProbe::getExponent() const
{
    return _implementation->exponent;
}

osg::StateSet* LightProbe::getStateSet() const
{
    return _implementation->stateSet;
}

osg::TextureCubeMap* LightProbe::getDiffuseMap() const
{
    return _implementation->diffuse;
}

osg::TextureCubeMap* LightProbe::getGlossyMap() const
{
    return _implementation->glossy;
}

unsigned LightProbe::getRevision() const
{
    return _implementation->revision;
}

void LightProbe::setTextureUnits(unsigned diffuse, unsigned glossy)
{
    if (refused(diffuse > 31 || glossy > 31 || diffuse == glossy,
                "texture units of probe not set: needs two different ones, 0 ... 31"))
        return;
    Implementation& here = *_implementation;
    for (const unsigned unit : {here.diffuseUnit, here.glossyUnit})
        here.stateSet->removeTextureAttribute(unit, osg::StateAttribute::TEXTURE);
    here.diffuseUnit = diffuse;
    here.glossyUnit = glossy;
    here.stateSet->setTextureAttribute(diffuse, here.diffuse);
    here.stateSet->setTextureAttribute(glossy, here.glossy);
    here.stateSet->getUniform(diffuseSampler)->set(static_cast<int>(diffuse));
    here.stateSet->getUniform(glossySampler)->set(static_cast<int>(glossy));
}

} // namespace osgTerrainLight
