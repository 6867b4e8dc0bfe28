#pragma once

#include <osgTerrainLight/SkyLight.h>

#include <osg/Geode>
#include <osg/Texture2D>
#include <osg/ref_ptr>

namespace osgTerrainLight
{

class TerrainLighting;

/// The sky that lights a terrain, drawn behind it all, with the sun's disc: one cube about the
/// viewer, without depth. It has no extent, hides nothing, and is not drawn by cameras without
/// perspective.
class SkyDome : public osg::Geode
{
public:
    SkyDome();

    /// Takes up the light of a lighting where it has changed. Where the sky is off there is none,
    /// and where the lighting is off nothing is drawn. Call where the scene graph may be changed.
    void follow(const TerrainLighting& lighting);

private:
    ~SkyDome() override = default;

    void show();

    osg::ref_ptr<osg::Texture2D>
        _picture; ///< of skies without environment; null until there is one
    // What is drawn.
    SkyLight _sky;
    Rgb _albedo = {};
    double _exposure = 0.0;
    bool _isNew = true;
};

/// Draws a dome with the lighting, in the views of viewers, and lets it follow its light. The dome
/// is no child of the lighting: no intersection, bound or saved scene has it.
void addSkyDome(TerrainLighting& lighting);

} // namespace osgTerrainLight
