#pragma once

#include "core/AzimuthSet.h"

#include <osgTerrainLight/SkyLight.h>

#include <vector>

namespace osgTerrainLight
{

/// A key light as slices of azimuth of equal width, each with one horizon per post, at its middle.
struct KeySlices
{
    double first = 0.0; ///< middle of the first [degrees clockwise from north], the others follow
    double width = 0.0; ///< of each [degrees]
    int count = 0;
    double lowest = 0.0, highest = 0.0; ///< [degrees above the horizontal], 0 ≤ lowest < highest
    Rgb radiance = {};
};

/// Most key lights of a SkyLight.
constexpr std::size_t maxKeyLights = 8;

/// The key lights that light anything: above the horizontal, and not black. Three slices each
/// (Nowrouzezahrai and Snyder 2009, section 6, have three azimuths), more where those would be
/// wider than the horizon map's, of which there are `azimuths`; never more than 256 in all, which
/// is what a pass computes horizons for.
std::vector<KeySlices> keySlices(const SkyLight& sky, int azimuths);

/// Of the middles of all slices, light after light.
std::vector<MapDirection> directionsOf(const std::vector<KeySlices>& lights);

} // namespace osgTerrainLight
