#pragma once

#include <osgTerrainLight/LightingSettings.h>

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/SentNode.h"
#include "lighting/sources/LightSource.h"

#include <osg/Vec4f>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// How finely a line keeps what it has passed (shaders/lib/line_history.glsl).
struct SweepScheme
{
    int near;    ///< steps that a post sees on its own ray
    int entries; ///< of a level, even: each doubling of the distance is seen in about as many
    int levels;  ///< 5 to 13: as many as a line of so many steps fills

    static SweepScheme of(HorizonQuality quality, int steps);
    std::vector<std::string> defines() const;
};

/// What all bounces of a tile compute with, one after the other.
struct SweepScratch
{
    explicit SweepScratch(const TileSurface& surface, int azimuths);

    osg::ref_ptr<Resource> stepLengths; ///< R32F, as createStepLengths() makes it
    osg::ref_ptr<Resource> gradients;   ///< RG32F, of posts: rise to the east and north
    osg::ref_ptr<Resource> sums;        ///< RGBA32F, of posts: irradiance
};

/// Passes of a bounce: what posts receive from their own cells (bounce_own.comp), then along the
/// lines of every azimuth (bounce_sweep.comp), and the end (bounce_finish.comp). One for the first
/// bounce, one for all others, so that these share programs.
class BounceSweep : public GpuWork
{
public:
    /// first: of light that the sources send, not of the bounce before.
    BounceSweep(const TileInputs& inputs, const TileSurface& surface, const LightSources& lights,
                Resource* horizon, const SweepScratch& scratch, bool first);

    /// before: direct light, or the light of the bounce before. far: of
    /// TileSurface::createFarLight(); null where nothing beyond the tile sends light.
    Status dispatch(osg::State& state, const SentNode& sent, Resource* before, Resource* far,
                    Resource* light);

private:
    ~BounceSweep() override = default;

    struct Lines
    {
        int count;
        int begin; ///< stepsBefore()
    };

    osg::ref_ptr<const TileSurface> _surface;
    LightSources _lights;            ///< none where not the first
    SweepScheme _scheme, _farScheme; ///< of lines of the tile, and of those from beyond it
    std::vector<Lines> _lines;       ///< of every azimuth
    GpuPass *_own, *_sweep, *_finish;
};

} // namespace osgTerrainLight
