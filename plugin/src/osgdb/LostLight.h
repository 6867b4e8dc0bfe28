#pragma once

namespace osgTerrainLight
{

/// From now on a scene with a TerrainLighting that is written to a format without a place for it
/// (.obj, .stl, .ive …) gives a warning; OSG's writers of such formats leave the light out and
/// report success. Through osgDB's callback of writing: where an application has one of its own, it
/// stays, and nothing is said. A second call does nothing.
void warnOfLostLight();

} // namespace osgTerrainLight
