#pragma once

#include "BenchOptions.h"
#include "BenchReport.h"

/// `terrainlight bench`: what light costs, and how wrong it is.
namespace osgTerrainLight::tool::bench
{
// Where the search for the truth, and, if paths follow, the measuring end on the progress line.
constexpr double truthEnd = 0.3;
constexpr double measureEnd = 0.5;

/// Measures the rows in rounds, all rows in each, so that a machine that is busy for a while slows
/// them all, and not the one whose turn it was.
Status measureAll(const Gpu& gpu, const DemTile& tile, const Truth& truth, Report& report,
                  Progress& progress);

/// Traces paths, as many as options say or until their noise is below a fifth of the smallest
/// error, and finds all rows' errors of indirect light.
Status measureIndirect(const Options& options, const Truth& truth, IndirectTruth& indirect,
                       Report& report, Progress& progress);

} // namespace osgTerrainLight::tool::bench
