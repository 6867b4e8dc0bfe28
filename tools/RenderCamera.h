#pragma once

#include "Options.h"

#include <osg/BoundingBox>
#include <osg/Camera>

#include <optional>
#include <string>

/// `terrainlight render`: where the picture is taken from.
namespace osgTerrainLight::tool
{

/// Seen from the middle of the scene: from the south, looking north and 35° down.
struct CameraPlace
{
    double azimuth = 180.0,
           elevation = 35.0;               ///< degrees clockwise from north, above the horizontal
    double distance = 1.0;                 ///< at 1 the scene fills the picture
    std::optional<osg::Vec3d> eye, center; ///< scene coordinates, instead
    osg::Vec3d up = {0.0, 0.0, 1.0};       ///< with eye
    std::string viewpoint;                 ///< of the map, by name; empty: none
    bool top = false;                      ///< straight down, north up, without perspective
};

/// --camera, --eye, --center, --top, --viewpoint.
void addCamera(CLI::App& app, CameraPlace& place);

/// Sets a camera from which the box fills the picture.
void placeCamera(osg::Camera& camera, const CameraPlace& place, double aspect,
                 const osg::BoundingBox& box);

} // namespace osgTerrainLight::tool
