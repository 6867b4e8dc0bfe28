#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/Referenced>
#include <osg/Shader>
#include <osg/StateSet>
#include <osg/TextureCubeMap>

#include <memory>

namespace osgTerrainLight
{

/// Light at one place of a lit tile, for a host's objects there: what comes from the sky above the
/// horizon that the place has, and from the ground below it, as irradiance maps (King 2005, with
/// the occlusion that it lacks). TerrainLighting::addProbe() has it computed, whenever the light
/// has changed. The object is drawn below that node, with the probe's StateSet and a shader that
/// calls terrain_probe.glsl.
///
/// The sun is not in the maps' colours, as harmonics would smear it: alpha has its visible
/// fraction, and the shader adds it sharply. The object itself casts no shadow and sends no light.
///
/// Methods are called where the scene graph may be changed.
class OSGTERRAINLIGHT_EXPORT LightProbe : public osg::Referenced
{
public:
    LightProbe();

    /// Texture units of the maps where none are asked for, and their samplerCube.
    static constexpr unsigned diffuseUnit = 4;
    static constexpr unsigned glossyUnit = 3;
    static constexpr const char* diffuseSampler = "osgTerrainLight_probeDiffuse";
    static constexpr const char* glossySampler = "osgTerrainLight_probeGlossy";
    /// float: of the glossy map's lobe.
    static constexpr const char* exponentUniform = "osgTerrainLight_probeExponent";

    /// Metres from the tile's south-western post to east and north; beyond the tile its edge
    /// counts. Default (0, 0). What is not finite is refused with a warning.
    void setPlace(double east, double north);
    double getEast() const;
    double getNorth() const;

    /// Metres above the ground, ≥ 0, or above the tile's heightOrigin, where a place below the
    /// ground is moved up to it. Default 1 m above the ground. Others are refused with a warning.
    void setHeight(double metres, bool aboveGround = true);
    double getHeight() const;
    bool isAboveGround() const;

    /// Of the glossy map's lobe, (s + 1) / 2π cosˢ: s, 1 … 64. Default 16. Beyond about 18 the lobe
    /// is blunter than it is asked to be, as harmonics are of order 6. Others are refused with a
    /// warning.
    void setExponent(double exponent);
    double getExponent() const;

    /// Of the maps, 0 … 31 and different. Others are refused with a warning.
    void setTextureUnits(unsigned diffuse, unsigned glossy);

    /// For the object's node, or above it: textures, samplers, exponent, and that cube maps are
    /// filtered across edges. The same as long as the probe lives.
    osg::StateSet* getStateSet() const;

    /// RGBA16F, 16² a face: rgb = irradiance / π of a surface that faces each direction (x east, y
    /// north, z up), a = visible fraction of the sun.
    osg::TextureCubeMap* getDiffuseMap() const;
    /// The same of radiance through the lobe about each direction.
    osg::TextureCubeMap* getGlossyMap() const;

    /// Grows with every change of place, height or exponent.
    unsigned getRevision() const;

protected:
    ~LightProbe() override;

private:
    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

/// terrain_probe.glsl as a shader that a host adds to its program and calls: vec3
/// terrainProbeDiffuse(vec3 normal) and vec3 terrainProbeGlossy(vec3 normal, vec3 toViewer).
/// version: of GLSL, ≥ 120.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createProbeShader(osg::Shader::Type type,
                                                                   int version = 120);

} // namespace osgTerrainLight
