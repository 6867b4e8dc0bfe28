// The least that lights an OSG application's terrain: minimal FILE, where FILE is any scene with
// osgTerrain tiles.
#include <osgTerrainLight/TerrainLighting.h>

#include <osgDB/ReadFile>
#include <osgViewer/Viewer>

int main(int argc, char** argv)
{
    osg::ArgumentParser arguments(&argc, argv);
    osg::ref_ptr<osg::Node> terrain = osgDB::readRefNodeFiles(arguments);
    if (!terrain)
        return 1;

    osg::ref_ptr<osgTerrainLight::TerrainLighting> lit = new osgTerrainLight::TerrainLighting;
    lit->addChild(terrain);

    osgTerrainLight::SkyLight sky;
    sky.sunAzimuth = 315.0; // degrees clockwise from north
    sky.sunElevation = 35.0;
    lit->setSkyLight(sky);

    osgViewer::Viewer viewer(arguments);
    viewer.setSceneData(lit);
    return viewer.run();
}
