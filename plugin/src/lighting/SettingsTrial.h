#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "core/Result.h"
#include "lighting/TileLight.h"
#include "lighting/nodes/HorizonScanPass.h"

#include <osg/State>
#include <osg/Vec4f>

#include <array>
#include <functional>
#include <map>
#include <vector>

namespace osgTerrainLight
{

/// Chooses settings for one tile and light by measuring them there: error against exhaustive
/// horizons (scanHorizons) of posts that are drawn where errors are likely, time by timer queries.
/// SettingsChoice says what the error is.
///
/// Each quality is tried once, with few azimuths. That gives its share of the error at each sample
/// post and its time per azimuth; what too few azimuths add follows from the exhaustive horizons
/// alone. So every candidate's error is predicted, and only the chosen one is run in full, to be
/// sure: where it misses, the next is.
///
/// For a maximum error, candidates are ranked by counted work, so the same tile and light give the
/// same choice each time. Where choosing would be more work than lighting with `best` and 128
/// azimuths, these are taken at once, and only measured.
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
        const DemTile& tile, const SkyLight& sky, Product product = Product::Shading,
        SkyViewDefinition definition = SkyViewDefinition::Surface,
        std::function<void(double)> progress = [](double) {});

    /// As LightingSettings::forMaxError and forFrameTime; what is not chosen is taken from `base`.
    Result<SettingsChoice> forMaxError(osg::State& state, const LightingSettings& base,
                                       double maxError);
    Result<SettingsChoice> forFrameTime(osg::State& state, const LightingSettings& base,
                                        double milliseconds);

    /// Error and time of given settings; `met` is true. Time: median of `repeats` after a warm-up;
    /// 0: of the first run.
    Result<SettingsChoice> measure(osg::State& state, const LightingSettings& settings,
                                   int repeats = 3);

    /// The light of the settings that were measured last, without bounces, up to date in the
    /// context; null where none were. It is the caller's from then on.
    osg::ref_ptr<TileLight> takeLight();

private:
    struct Run
    {
        osg::ref_ptr<TileLight> light;
        Raster<float> view; ///< sky-view factor; empty without a sky
        Raster<osg::Vec4f> shading;
        double skyMilliseconds = 0.0; ///< what grows with the azimuths
        double restMilliseconds = 0.0;
        double meanSquare = 0.0; ///< of the product, all valid posts
    };
    Result<Run> run(osg::State& state, const LightingSettings& settings, int repeats) const;
    static void release(osg::State& state, osg::ref_ptr<TileLight>& light);
    /// Draws the sample posts where a rough run and a more exact one differ and where shadows end,
    /// and scans them. rough: null without a sky.
    /// Once for all settings.
    Status sample(osg::State& state, const Run* rough, const Run& exact);
    bool sampled() const { return !_skyPosts.empty() || !_sunPosts.empty(); }
    /// Exhaustive horizons of the sky posts all around, and of the sun posts across the sun's disc.
    Status scanSky(osg::State& state);
    Status scanSun(osg::State& state);
    /// How likely the sun is wrong at each valid post.
    Result<std::vector<double>> sunImportance(osg::State& state, const Run* rough,
                                              const Run& exact) const;
    /// Sky-view factor of each sky post from `azimuths` of the exhaustive horizons.
    std::vector<double> exactSky(int azimuths) const;
    /// At the sky posts, in luminance.
    std::vector<double> skyErrorsOf(const Run& run) const;
    /// Of sun and storage, at the sun posts.
    std::vector<double> restErrorsOf(const Run& run) const;
    /// Bounds of the root mean square.
    double skyBound(const std::vector<double>& errors) const;
    double restBound(const std::vector<double>& errors) const;
    /// Tries each quality, timed where repeats > 0.
    Status probe(osg::State& state, int repeats);
    void keepProbe(HorizonQuality quality, const Run& run);
    double predictedError(const LightingSettings& settings) const;
    double predictedMilliseconds(const LightingSettings& settings) const;
    std::vector<LightingSettings> candidates(const LightingSettings& base) const;
    /// Tangent of the elevation of the lower edge of the sun's disc, at least 0.
    double lowestSun() const;
    /// Counted work, in that of one azimuth of a post in draft quality.
    double workOf(const LightingSettings& settings) const;
    double workOfChoosing() const;
    /// Settings that need no choosing: `best` with 128 azimuths, or 192 where these miss.
    Result<SettingsChoice> measureMostExact(osg::State& state, const LightingSettings& base,
                                            double maxError);
    SettingsChoice choiceOf(const LightingSettings& settings, const Run& run);
    /// The first that promises what it then fulfils, measured; else the one of least distance.
    Result<SettingsChoice> firstOf(osg::State& state, const std::vector<LightingSettings>& settings,
                                   const std::function<bool(const LightingSettings&)>& promises,
                                   const std::function<bool(const SettingsChoice&)>& fulfils,
                                   const std::function<double(const LightingSettings&)>& distance,
                                   int repeats);

    DemTile _tile;
    SkyLight _sky;
    Product _product = Product::Shading;
    SkyViewDefinition _definition = SkyViewDefinition::Surface;
    std::function<void(double)> _progress;

    std::vector<TilePost> _posts; ///< all that are valid
    std::vector<TilePost> _skyPosts, _sunPosts;
    std::vector<double> _skyWeights, _sunWeights; ///< of the samples
    std::vector<std::array<double, 3>> _skyNormals;
    Raster<double> _elevations;       ///< [rad], sky post × dense azimuth
    std::vector<double> _denseSky;    ///< sky-view factor by all dense azimuths
    double _denseSkyError = 0.0;      ///< bound of its root mean square error, luminance
    std::vector<double> _fullSun;     ///< luminance where the whole disc is seen
    std::vector<double> _sunFraction; ///< by exhaustive horizons
    /// A quality's own errors, those of few azimuths left out, and its times.
    struct Probe
    {
        std::vector<double> skyErrors;
        double restBound = 0.0;
        double skyMilliseconds = 0.0;
        double restMilliseconds = 0.0;
    };
    std::map<HorizonQuality, Probe> _probes;
    int _probeRepeats = -1;
    double _meanSquare = 0.0;
    osg::ref_ptr<TileLight> _light;
};

} // namespace osgTerrainLight
