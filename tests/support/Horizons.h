#pragma once

#include "core/AzimuthSet.h"

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/HorizonMap.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include <osg/State>
#include <osg/Vec4f>

#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{
template <class T>
class Raster;
}

/// What the GPU path gives for a tile, read back, and how far it is from the exhaustive reference.
namespace osgTerrainLight::testing
{

HorizonMap gpuHorizons(osg::State& state, const DemTile& tile, int azimuths,
                       HorizonQuality quality);

/// Visible fraction of the sun, row 0 south.
Raster<float> gpuSunFraction(osg::State& state, const DemTile& tile, double azimuth,
                             double elevation, HorizonQuality quality,
                             double angularRadius = 0.2666);

/// A real DEM of ../shared/data/dem or samples/data; nothing where the file is absent.
std::optional<DemTile> realDem(const std::string& name);

/// Differences of horizon elevations [degrees], both sides clamped at 0.
struct HorizonError
{
    double mean = 0.0; ///< of absolute values
    double p99 = 0.0;
    double bias = 0.0; ///< GPU − reference
    double worst = 0.0;
    int worstColumn = 0, worstRow = 0;
    double worstCompass = 0.0;   ///< degrees clockwise from north
    double worstExpected = 0.0;  ///< elevation of the reference
    double worstDistance = 0.0;  ///< of the point that makes the reference's horizon [m]
    std::vector<double> byIndex; ///< mean absolute error per azimuth index

    std::string text() const;
};

/// Compares `posts` random valid posts, fixed seed, in every azimuth of the map.
HorizonError compareWithReference(const DemTile& tile, const HorizonMap& map, int posts);

} // namespace osgTerrainLight::testing
