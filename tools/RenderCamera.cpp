#include "RenderCamera.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osgTerrainLight::tool
{
namespace
{

constexpr double radiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr double fieldOfView = 30.0; // vertical [degrees]

std::array<osg::Vec3d, 8> corners(const osg::BoundingBox& box)
{
    std::array<osg::Vec3d, 8> result;
    for (unsigned i = 0; i < 8; ++i)
        result[i] = box.corner(i);
    return result;
}

} // namespace

void addCamera(CLI::App& app, CameraPlace& place)
{
    addLimitedNumbers(
        app, "--camera", "AZ,EL,DISTANCE",
        {{"camera azimuth", -360.0, 720.0, false},
         {"camera elevation", -90.0, 90.0, false},
         {"camera distance", 0.001, 1000.0, false}},
        "Where the camera stands, seen from the middle of the scene: degrees clockwise from "
        "north and above the horizontal; at distance 1 the scene fills the picture; default "
        "180,35,1",
        [&place](const auto& v)
        {
            place.azimuth = v[0];
            place.elevation = v[1];
            place.distance = v[2];
        });
    const auto addPoint =
        [&](const std::string& name, const std::string& help, std::optional<osg::Vec3d>& target)
    {
        const Limits limit = {name.substr(2), -1e9, 1e9, false};
        return addLimitedNumbers(app, name, "X,Y,Z", {limit, limit, limit}, help,
                                 [&target](const auto& v)
                                 { target = osg::Vec3d(v[0], v[1], v[2]); });
    };
    CLI::Option* eye = addPoint("--eye", "Camera's place in scene coordinates", place.eye);
    addPoint("--center", "Place the camera looks at, in scene coordinates", place.center);
    app.add_flag("--top", place.top, "Straight down, north up, without perspective")->excludes(eye);
    app.add_option("--viewpoint", place.viewpoint,
                   "Camera of this viewpoint of the map, by its name; home is the first one")
        ->type_name("NAME")
        ->excludes("--camera")
        ->excludes("--eye")
        ->excludes("--center")
        ->excludes("--top");
}

void placeCamera(osg::Camera& camera, const CameraPlace& place, double aspect,
                 const osg::BoundingBox& box)
{
    const osg::Vec3d middle = box.center();
    if (place.top)
    {
        const double halfEast = 0.5 * static_cast<double>(box.xMax() - box.xMin());
        const double halfNorth = 0.5 * static_cast<double>(box.yMax() - box.yMin());
        const double half = place.distance * std::max(halfNorth, halfEast / aspect);
        const double above = std::max(1.0, double(box.radius()));
        camera.setProjectionMatrixAsOrtho(-half * aspect, half * aspect, -half, half, 0.1 * above,
                                          10.0 * above);
        camera.setViewMatrixAsLookAt(middle + osg::Vec3d(0.0, 0.0, 3.0 * above), middle,
                                     osg::Vec3d(0.0, 1.0, 0.0));
        return;
    }

    const double azimuth = place.azimuth * radiansPerDegree;
    const double elevation = place.elevation * radiansPerDegree;
    const osg::Vec3d towardsEye(std::sin(azimuth) * std::cos(elevation),
                                std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
    // Up in the picture stays defined where the camera looks straight down.
    const osg::Vec3d up(-std::sin(azimuth) * std::sin(elevation),
                        -std::cos(azimuth) * std::sin(elevation), std::cos(elevation));
    const osg::Vec3d right = up ^ towardsEye;
    const double tangent = std::tan(0.5 * fieldOfView * radiansPerDegree);
    double distance = 0.0;
    for (const osg::Vec3d& corner : corners(box))
    {
        const osg::Vec3d offset = corner - middle;
        distance =
            std::max({distance, offset * towardsEye + std::abs(offset * right) / (tangent * aspect),
                      offset * towardsEye + std::abs(offset * up) / tangent});
    }
    distance = std::max(distance, 1e-3) * place.distance;
    camera.setProjectionMatrixAsPerspective(fieldOfView, aspect, 0.01 * distance, 10.0 * distance);
    const osg::Vec3d center = place.center.value_or(middle);
    if (place.eye)
        camera.setViewMatrixAsLookAt(*place.eye, center, place.up);
    else
        camera.setViewMatrixAsLookAt(center + towardsEye * distance, center, up);
}

} // namespace osgTerrainLight::tool
