#pragma once

#include "BenchObjectScenes.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// `terrainlight bench --objects`: sky light among objects, by rays and by the library's shaders.
namespace osgTerrainLight::tool::bench
{

/// Irradiance / pi at a place by a uniform sky of radiance 1 above the horizontal, from the path
/// tracer. Standard errors are of one place.
struct PlaceTruth
{
    double light = 0.0, lightError = 0.0;     ///< with the objects
    double terrain = 0.0, terrainError = 0.0; ///< without
    double atProbe = 0.0;                     ///< without, in the place's probe
};
constexpr int objectRays = 4096; ///< per place, each

/// A ring of the elevations of the terrain's horizon, without objects, as the library's maps have
/// it: radians, never below 0, counter-clockwise from east.
struct HorizonElevations
{
    std::vector<float> elevations;
    float slopeTowards(float x, float y) const;
};

/// What one way to find the light gives at the places of a scene.
struct ObjectLight
{
    std::vector<double> light;
    double reads = 0.0;   ///< texture reads per place
    double seconds = 0.0; ///< per place, on one thread: the median of the rounds
};

struct ObjectMethod
{
    std::string name;
    std::string meaning;
};
/// In the order of the table.
const std::vector<ObjectMethod>& objectMethods();

struct MeasuredScene
{
    std::vector<PlaceTruth> truths;
    std::vector<ObjectLight> found; ///< by method
};

/// rounds: of timing.
Result<MeasuredScene> measureObjects(const ObjectScene& scene, std::uint32_t seed, int rounds);

} // namespace osgTerrainLight::tool::bench
