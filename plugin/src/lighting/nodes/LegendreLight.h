#pragma once

#include <osgTerrainLight/LightingSettings.h>

#include "core/WedgeMatrices.h"
#include "gpu/GpuPass.h"
#include "lighting/nodes/BounceRays.h"
#include "lighting/nodes/PyramidNode.h"

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// How the scheme of Nowrouzezahrai and Snyder 2009 samples a tile.
struct LegendreScheme
{
    /// Samples at 2^(i/samplesPerOctave) steps, i = 0, 1, …, 1 … 64 per octave.
    BounceScheme rays = {8.0, 4.0};
    /// All around: a multiple of 4, 4 … 256.
    int azimuths = 32;
    AzimuthBlend blend = AzimuthBlend::Linear;
    /// Light is gathered at one post of every stride · stride, 1, 2 or 4, and shaded at all.
    int stride = 1;

    /// Draft has the paper's own numbers. The method must not be Slices.
    static LegendreScheme of(const LightingSettings& settings);
};

/// A variant of legendre_light.comp, with all that does not depend on light or bounce.
osg::ref_ptr<GpuPass> createLegendreLight(std::vector<std::string> defines,
                                          const PyramidNode& pyramid, const LegendreScheme& scheme);
GpuPass::Groups legendreGroups(const TileSurface& surface, int stride);

} // namespace osgTerrainLight
