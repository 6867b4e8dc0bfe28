#pragma once

#include "BenchTruth.h"

#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight::tool::bench
{

/// What some settings cost and how wrong they are.
struct Row
{
    std::string method;
    LightingSettings settings;
    std::string skipped; ///< not empty: why nothing below was measured
    std::vector<double> stageMilliseconds;
    double gpuMilliseconds = 0.0;
    double wallMilliseconds = 0.0;
    std::size_t bytes = 0;
    std::vector<double> indirect;        ///< found: luminance of all bounces, post by post
    std::vector<ErrorStatistics> errors; ///< by quantity
    std::vector<bool> onFront;           ///< by quantity
};

struct Report
{
    std::string date; ///< UTC, ISO 8601
    GpuCapabilities device;
    std::string terrain;
    int width = 0, height = 0;
    std::size_t validPosts = 0;
    double eastSpacing = 0.0, northSpacing = 0.0; ///< in the middle [m]
    SkyLight sky;
    LightingSettings settings; ///< bounces and albedo
    std::vector<Quantity> quantities;
    std::size_t skyPosts = 0, sunPosts = 0, indirectPosts = 0;
    std::uint64_t paths = 0; ///< per post of indirectPosts
    std::uint32_t seed = 0;
    int repeats = 0;
    std::vector<std::string> stages;
    std::vector<Row> rows;
};

/// Which points are on the front: no other point is at least as good in both numbers and better in
/// one. Lower is better.
struct CostAndError
{
    double cost, error;
};
std::vector<bool> paretoFront(const std::vector<CostAndError>& points);

/// Fills in onFront: of the GPU's time against each quantity's main error, among measured rows.
void markFronts(Report& report);

std::string tableOf(const Report& report);
std::string csvOf(const Report& report);
std::string jsonOf(const Report& report);

/// An error where the program that draws is not there.
Status checkPlotter();
/// A picture: a panel per quantity, time against error.
Result<std::string> svgOf(const Report& report);

} // namespace osgTerrainLight::tool::bench
