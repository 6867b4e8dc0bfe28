#pragma once

#include <osgTerrainLight/Environment.h>

namespace osgTerrainLight
{

/// Looks for the sun of an environment that has none yet, and takes it out of the picture: a source
/// above the horizontal that sends at least 1 % of the light from there from within 2.5° (or one
/// and a half texels), ten times as bright as what is around it. What exceeds the surroundings
/// becomes a disc of the same flux, centroid and second moment. docs/methods/environments.md says
/// why.
void takeSun(Environment& environment);

} // namespace osgTerrainLight
