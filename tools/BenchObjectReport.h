#pragma once

#include "BenchObjectLight.h"

#include <map>
#include <string>
#include <vector>

/// `terrainlight bench --objects`: what is said of the errors.
namespace osgTerrainLight::tool::bench
{

/// Of found minus true light, over the light of open level ground.
struct LightErrors
{
    std::size_t count = 0;
    double rms = 0.0, p95 = 0.0, mean = 0.0, worst = 0.0; ///< worst: with its sign
    std::size_t worstAt = 0;                              ///< which of them
};
LightErrors lightErrorsOf(const std::vector<double>& found, const std::vector<double>& truth);

struct ObjectRow
{
    std::string ground; ///< "plain", "valley", "rough" or "all"
    std::string method;
    double reads = 0.0;               ///< per place
    double millisecondsPer1000 = 0.0; ///< places, on one thread
    LightErrors errors;
    std::map<std::string, double> rms; ///< by surface, where shaded, and by kind of scene
    // The worst place.
    int scene = 0;
    std::string kind;
    Surface surface = Surface::Ground;
    glm::dvec3 at{0.0};
    std::string onGround;
    double found = 0.0, truth = 0.0;
};

struct ObjectReport
{
    std::string date; ///< UTC, ISO 8601
    int scenes = 0, places = 0;
    std::uint32_t seed = 0;
    int repeats = 0;
    double noise = 0.0;             ///< RMS of the truth's standard errors
    std::vector<std::string> parts; ///< keys of `rms`, in order
    std::vector<ObjectRow> rows;    ///< by ground, then by method
};

/// A scene as it was measured. places: without what is no longer needed.
struct ObjectResult
{
    Ground ground;
    int number;
    std::string kind;
    std::vector<ObjectPlace> places;
    MeasuredScene measured;
};
void fillRows(ObjectReport& report, const std::vector<ObjectResult>& results);

std::string tableOf(const ObjectReport& report);
std::string csvOf(const ObjectReport& report);
std::string jsonOf(const ObjectReport& report);
/// A panel per ground, reads against RMS error.
Result<std::string> svgOf(const ObjectReport& report);

} // namespace osgTerrainLight::tool::bench
