#pragma once

#include <osgTerrainLight/Export.h>

#include <osg/Referenced>
#include <osg/Shader>
#include <osg/StateSet>
#include <osg/TextureCubeMap>

#include <memory>

namespace osgTerrainLight
{

/// The light at one place of a lit tile, for an application's objects there. It has the light of
/// the sky above the horizon of the place, and that of the ground below the horizon, as irradiance
/// maps (King 2005, with the occlusion that it lacks). TerrainLighting::addProbe() has it computed
/// whenever the light has changed. Draw the object below that node, with the probe's StateSet and a
/// shader that calls terrain_probe.glsl.
///
/// The colours of the maps leave out the sun, since harmonics would smear it. Alpha has the visible
/// fraction of the sun, and the shader adds the sun sharply. The object itself casts no shadow and
/// sends no light.
///
/// Call all methods where the scene graph may be changed: in the update or event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT LightProbe : public osg::Referenced
{
public:
    LightProbe();

    /// The default texture units of the maps, and the names of their samplerCube uniforms.
    static constexpr unsigned diffuseUnit = 4;
    static constexpr unsigned glossyUnit = 3;
    static constexpr const char* diffuseSampler = "osgTerrainLight_probeDiffuse";
    static constexpr const char* glossySampler = "osgTerrainLight_probeGlossy";
    /// The name of the float uniform with the exponent of the glossy map's lobe.
    static constexpr const char* exponentUniform = "osgTerrainLight_probeExponent";

    /// Sets the place, in metres to the east and north of the tile's south-western post. A place
    /// beyond the tile is moved to its edge. The default is (0, 0). Numbers that are not finite are
    /// refused with a warning.
    void setPlace(double east, double north);
    double getEast() const;
    double getNorth() const;

    /// Sets the height [m] above the ground, ≥ 0, or above the tile's heightOrigin; a place below
    /// the ground is moved up to it. The default is 1 m above the ground. Other heights are refused
    /// with a warning.
    void setHeight(double metres, bool aboveGround = true);
    double getHeight() const;
    bool isAboveGround() const;

    /// Sets the exponent s of the glossy map's lobe, (s + 1) / 2π cosˢ, 1 … 64. The default is 16.
    /// Beyond about 18 the lobe is blunter than s says, since the harmonics are of order 6. Other
    /// exponents are refused with a warning.
    void setExponent(double exponent);
    double getExponent() const;

    /// Sets the texture units of the maps: two different ones, 0 … 31. Others are refused with a
    /// warning.
    void setTextureUnits(unsigned diffuse, unsigned glossy);

    /// The StateSet for the object's node, or for a node above it. It has the textures, their
    /// samplers and the exponent, and has cube maps filtered across their edges. It is the same as
    /// long as the probe lives.
    osg::StateSet* getStateSet() const;

    /// The diffuse map, RGBA16F, 16² texels per face: rgb is the irradiance / π of a surface that
    /// faces each direction (x east, y north, z up), and a is the visible fraction of the sun.
    osg::TextureCubeMap* getDiffuseMap() const;
    /// The glossy map: rgb is the radiance through the lobe about each direction.
    osg::TextureCubeMap* getGlossyMap() const;

    /// A number that grows with every change of the place, the height or the exponent.
    unsigned getRevision() const;

protected:
    ~LightProbe() override;

private:
    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

/// Makes terrain_probe.glsl a shader that an application adds to its own program. It has
/// vec3 terrainProbeDiffuse(vec3 normal) and vec3 terrainProbeGlossy(vec3 normal, vec3 toViewer).
/// version: of GLSL, as in #version, ≥ 120.
OSGTERRAINLIGHT_EXPORT osg::ref_ptr<osg::Shader> createProbeShader(osg::Shader::Type type,
                                                                   int version = 120);

} // namespace osgTerrainLight
