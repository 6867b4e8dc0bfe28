#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "core/Result.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/HorizonScanPass.h"

#include <osg/State>

#include <functional>
#include <map>
#include <vector>

namespace osgTerrainLight
{

/// Chooses settings for one tile and light by measuring them there: error against exhaustive
/// horizons of random posts (scanHorizons), time by timer queries. SettingsChoice says what the
/// error is.
///
/// Each quality is tried once, with few azimuths. That gives its share of the error at each sample
/// post and its time per azimuth; what too few azimuths add follows from the exhaustive horizons
/// alone. So every candidate's error and time are predicted, and only the chosen one is run in
/// full, to be sure: where it misses, the next is.
///
/// All functions need the same current context.
class SettingsTrial
{
public:
    /// What errors are of.
    enum class Product
    {
        Shading,    ///< luminance
        SkyView,    ///< the factor; the light is then a sky alone
        SunFraction ///< the visible fraction of the disc; the light is then a sun alone
    };

    /// progress: called with fractions done, 0 … 1. An error where the tile has no valid post.
    static Result<SettingsTrial> create(
        osg::State& state, const DemTile& tile, const SkyLight& sky,
        Product product = Product::Shading,
        SkyViewDefinition definition = SkyViewDefinition::Surface,
        std::function<void(double)> progress = [](double) {});

    /// As LightingSettings::forMaxError and forFrameTime; what is not chosen is taken from `base`.
    Result<SettingsChoice> forMaxError(osg::State& state, const LightingSettings& base,
                                       double maxError);
    Result<SettingsChoice> forFrameTime(osg::State& state, const LightingSettings& base,
                                        double milliseconds);

    /// Error and time of given settings; `met` is true. Time: median of `repeats` after a warm-up.
    Result<SettingsChoice> measure(osg::State& state, const LightingSettings& settings,
                                   int repeats = 3);

private:
    /// Exhaustive horizons of the sky posts all around, and of the sun posts across the sun's disc.
    Status scanSky(osg::State& state);
    Status scanSun(osg::State& state);
    /// Sky-view factor of each sky post from `azimuths` of the exhaustive horizons.
    std::vector<double> exactSky(int azimuths) const;
    struct Run
    {
        std::vector<double> skyErrors;  ///< luminance, at the sky posts; empty without a sky
        std::vector<double> restErrors; ///< of sun and storage, at the sun posts
        double skyMilliseconds = 0.0;   ///< what grows with the azimuths
        double restMilliseconds = 0.0;
        double meanSquare = 0.0; ///< of the shading's luminance, all valid posts
    };
    Result<Run> run(osg::State& state, const LightingSettings& settings, int repeats) const;
    double errorOf(const std::vector<double>& skyErrors,
                   const std::vector<double>& restErrors) const;
    Status probe(osg::State& state);
    struct Candidate
    {
        LightingSettings settings;
        double error = 0.0;
        double milliseconds = 0.0;
    };
    std::vector<Candidate> candidates(const LightingSettings& base) const;
    /// The first candidate that fulfils, run; else `closest`, run.
    Result<SettingsChoice> firstOf(osg::State& state, const std::vector<Candidate>& candidates,
                                   const std::function<bool(double error, double ms)>& fulfils,
                                   const Candidate& closest, int repeats);

    DemTile _tile;
    SkyLight _sky;
    Product _product = Product::Shading;
    SkyViewDefinition _definition = SkyViewDefinition::Surface;
    std::function<void(double)> _progress;

    std::vector<TilePost> _skyPosts, _sunPosts;
    std::vector<std::array<double, 3>> _skyNormals;
    Raster<double> _elevations;       ///< [rad], sky post × dense azimuth
    std::vector<double> _denseSky;    ///< sky-view factor by all dense azimuths
    std::vector<double> _sunWeights;  ///< luminance where the whole disc is seen
    std::vector<double> _sunFraction; ///< by exhaustive horizons
    std::map<HorizonQuality, Run> _probes;
    std::map<HorizonQuality, std::vector<double>> _qualityErrors; ///< a quality's own, sky posts
    double _meanSquare = 0.0;
};

} // namespace osgTerrainLight
