#include "lighting/SettingsTrial.h"

#include "core/AzimuthSet.h"
#include "core/Luminance.h"
#include "core/SkyRadiance.h"
#include "glsl_host.h"
#include "gpu/GlConstants.h"
#include "gpu/GpuCapabilities.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <osg/GLObjects>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <random>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double radiansPerDegree = pi / 180.0;

/// Exhaustive horizons per sky post. Candidates' azimuth counts divide it, so theirs are among
/// them.
constexpr int denseAzimuths = 384;
const std::vector<int> azimuthCounts = {8, 12, 16, 24, 32, 48, 64, 96, 128, 192};
constexpr int probeAzimuths = 16;
constexpr std::size_t skyPostCount = 384;
/// Wrong shadows are rare and big, so the sun needs many posts; it has few directions.
constexpr std::size_t sunPostCount = 16384;
/// Strips across the sun's disc, each with a horizon of its own.
constexpr int sunStrips = 9;
/// One-sided 95 % of the normal distribution.
constexpr double confidence = 1.645;

const std::vector<HorizonQuality> qualities = {HorizonQuality::Draft, HorizonQuality::Normal,
                                               HorizonQuality::Best};

Rgb rgbOf(const osg::Vec4f& c)
{
    return {c.r(), c.g(), c.b()};
}

std::array<double, 3> normalAt(const DemTile& tile, const TilePost& post)
{
    Raster<double> around(3, 3, Glsl<double>::VOID_HEIGHT);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x)
        {
            const int column = post.column + x - 1;
            const int row = post.row + y - 1;
            if (column >= 0 && row >= 0 && column < tile.width() && row < tile.height() &&
                tile.isValid(column, row))
                around.at(x, y) = static_cast<double>(tile.heightAt(column, row));
        }
    const auto normal =
        Glsl<double>().postNormal(around, {1, 1}, tile.eastSpacing(post.row), tile.northSpacing);
    return {normal.x, normal.y, normal.z};
}

/// Upper end of the one-sided 95 % confidence interval of the mean of squares.
double meanSquareBound(const std::vector<double>& errors)
{
    if (errors.empty())
        return 0.0;
    const double count = static_cast<double>(errors.size());
    double mean = 0.0;
    for (double error : errors)
        mean += error * error / count;
    double variance = 0.0;
    for (double error : errors)
        variance += (error * error - mean) * (error * error - mean) / count;
    return mean + confidence * std::sqrt(variance / count);
}

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}
} // namespace

Result<SettingsTrial> SettingsTrial::create(osg::State& state, const DemTile& tile,
                                            const SkyLight& sky, Product product,
                                            SkyViewDefinition definition,
                                            std::function<void(double)> progress)
{
    if (!sky.keyLights.empty() || skyHasTable(sky))
        return Error{ErrorCode::NotSupported,
                     "settings are chosen for a uniform sky and a sun: needs "
                     "neither key lights nor another sky"};
    SettingsTrial trial;
    trial._tile = tile;
    trial._sky = sky;
    trial._product = product;
    trial._definition = definition;
    assert(product != Product::SkyView || (sky.skyEnabled && !sky.sunEnabled));
    assert(product != Product::SunFraction || (!sky.skyEnabled && sky.sunEnabled));
    trial._progress = std::move(progress);
    std::vector<TilePost> valid;
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
                valid.push_back({column, row});
    if (valid.empty())
        return Error{ErrorCode::Invalid, "no valid post: needed at least one to measure settings"};
    std::mt19937 random(20261122);
    const auto draw = [&](std::size_t count)
    {
        std::vector<TilePost> posts;
        for (std::size_t i = 0; i < count; ++i)
            posts.push_back(valid[random() % valid.size()]);
        return posts;
    };

    if (sky.skyEnabled)
    {
        trial._skyPosts = draw(skyPostCount);
        if (Status scanned = trial.scanSky(state); !scanned)
            return scanned.error();
    }
    trial._progress(0.15);
    if (product != Product::SkyView)
    {
        trial._sunPosts = draw(sunPostCount);
        trial._sunFraction.assign(sunPostCount, 0.0);
        trial._sunWeights.assign(sunPostCount, 0.0);
    }
    if (TileLight::needsSun(sky))
        if (Status scanned = trial.scanSun(state); !scanned)
            return scanned.error();
    trial._progress(0.2);
    return trial;
}

Status SettingsTrial::scanSky(osg::State& state)
{
    std::vector<MapDirection> directions;
    for (int k = 0; k < denseAzimuths; ++k)
        directions.push_back(directionOfCompass(90.0 - 360.0 * k / denseAzimuths));
    Result<Raster<double>> slopes = scanHorizons(state, _tile, _skyPosts, directions);
    if (!slopes)
        return slopes.error();
    _elevations = std::move(*slopes);
    for (double& value : _elevations.values())
        value = std::atan(value);
    for (const TilePost& post : _skyPosts)
        _skyNormals.push_back(normalAt(_tile, post));
    _denseSky = exactSky(denseAzimuths);
    return Nothing{};
}

Status SettingsTrial::scanSun(osg::State& state)
{
    // The disc as strips of equal angle on its edge: offset r·cos a, half length r·sin a.
    std::vector<MapDirection> directions;
    std::vector<double> halves, weights;
    const double cosine = std::cos(_sky.sunElevation * radiansPerDegree);
    for (int i = 0; i < sunStrips; ++i)
    {
        const double a = pi * (i + 0.5) / sunStrips;
        const double offset =
            _sky.sunAngularRadius * std::cos(a) / std::max(cosine, radiansPerDegree);
        directions.push_back(directionOfCompass(_sky.sunAzimuth + std::clamp(offset, -90.0, 90.0)));
        halves.push_back(_sky.sunAngularRadius * radiansPerDegree * std::sin(a));
        weights.push_back(std::sin(a) * std::sin(a) * 2.0 / sunStrips);
    }
    const Result<Raster<double>> slopes = scanHorizons(state, _tile, _sunPosts, directions);
    if (!slopes)
        return slopes.error();
    const std::array<double, 3> towards = _sky.sunDirection();
    for (std::size_t p = 0; p < _sunPosts.size(); ++p)
    {
        double visible = 0.0;
        for (int i = 0; i < sunStrips; ++i)
        {
            const std::size_t s = static_cast<std::size_t>(i);
            const double edge = std::max(std::atan(slopes->at(static_cast<int>(p), i)), 0.0);
            const double above =
                (_sky.sunElevation * radiansPerDegree - edge + halves[s]) / (2.0 * halves[s]);
            visible += weights[s] * std::clamp(above, 0.0, 1.0);
        }
        const std::array<double, 3> normal = normalAt(_tile, _sunPosts[p]);
        const double facing =
            normal[0] * towards[0] + normal[1] * towards[1] + normal[2] * towards[2];
        _sunFraction[p] = visible;
        _sunWeights[p] = luminance(_sky.sunIrradiance) * std::max(facing, 0.0) / pi;
    }
    return Nothing{};
}

std::vector<double> SettingsTrial::exactSky(int azimuths) const
{
    assert(denseAzimuths % azimuths == 0);
    const double width = 2.0 * pi / azimuths;
    std::vector<double> view;
    for (std::size_t p = 0; p < _skyPosts.size(); ++p)
    {
        const auto& n = _skyNormals[p];
        double sum = 0.0;
        for (int k = 0; k < azimuths; ++k)
            sum += Glsl<double>().skySlice(
                _elevations.at(static_cast<int>(p), k * (denseAzimuths / azimuths)),
                {n[0], n[1], n[2]}, std::cos(width * k), std::sin(width * k), width,
                static_cast<int>(_definition));
        view.push_back(sum);
    }
    return view;
}

Result<SettingsTrial::Run> SettingsTrial::run(osg::State& state, const LightingSettings& settings,
                                              int repeats) const
{
    LightingSettings direct = settings; // the exhaustive scan knows no bounces
    direct.bounces = 0;
    direct.bounceMethod = BounceMethod::Slices;
    const osg::ref_ptr<TileLight> lighting = new TileLight(_tile, direct, _sky, _definition);
    lighting->setTimed(true);
    Run result;
    std::vector<double> sky, rest;
    for (int i = 0; i <= repeats; ++i) // the first one compiles
    {
        lighting->touch();
        if (Status done = lighting->update(state); !done)
            return done.error();
        double skySum = 0.0;
        double restSum = 0.0;
        for (const StageCost& cost : lighting->costs())
            if (cost.bytes > 0)
                (cost.name == "horizon" || cost.name == "sky" ? skySum : restSum) +=
                    cost.gpuMilliseconds;
        if (i > 0)
        {
            sky.push_back(skySum);
            rest.push_back(restSum);
        }
    }
    result.skyMilliseconds = median(sky);
    result.restMilliseconds = median(rest);

    const Raster<osg::Vec4f> shading = lighting->readShading(state);
    const double skyLuminance = luminance(_sky.skyRadiance);
    Raster<float> view(_tile.width(), _tile.height());
    if (_sky.skyEnabled)
        view = lighting->readSkyView(state);
    const auto skyLight = [&](const TilePost& post)
    { return skyLuminance * static_cast<double>(view.at(post.column, post.row)); };
    for (std::size_t p = 0; p < _skyPosts.size(); ++p)
        result.skyErrors.push_back(skyLight(_skyPosts[p]) - skyLuminance * _denseSky[p]);
    const auto fraction = [&](const TilePost& post)
    { return static_cast<double>(shading.at(post.column, post.row).a()); };
    for (std::size_t p = 0; _product == Product::SunFraction && p < _sunPosts.size(); ++p)
        result.restErrors.push_back(fraction(_sunPosts[p]) - _sunFraction[p]);
    for (std::size_t p = 0; _product == Product::Shading && p < _sunPosts.size(); ++p)
        result.restErrors.push_back(
            luminance(rgbOf(shading.at(_sunPosts[p].column, _sunPosts[p].row))) -
            skyLight(_sunPosts[p]) - _sunWeights[p] * _sunFraction[p]);
    const double valid = static_cast<double>(_tile.validCount());
    for (const osg::Vec4f& c : shading.values())
    {
        const double y =
            _product == Product::SunFraction ? static_cast<double>(c.a()) : luminance(rgbOf(c));
        result.meanSquare += y * y / valid;
    }
    lighting->releaseGLObjects(&state);
    osg::flushAllDeletedGLObjects(state.getContextID());
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
        return Error{ErrorCode::Failed, error == GL_OUT_OF_MEMORY
                                            ? "not enough graphics memory to measure settings"
                                            : "OpenGL error while settings were measured"};
    return result;
}

double SettingsTrial::errorOf(const std::vector<double>& skyErrors,
                              const std::vector<double>& restErrors) const
{
    // The two are measured at posts of their own; the sum of the roots bounds the root of the sum.
    const double sum =
        std::sqrt(meanSquareBound(skyErrors)) + std::sqrt(meanSquareBound(restErrors));
    return _meanSquare > 0.0 ? sum / std::sqrt(_meanSquare) : 0.0;
}

Status SettingsTrial::probe(osg::State& state)
{
    if (!_probes.empty())
        return Nothing{};
    const std::vector<double> exact = _sky.skyEnabled ? exactSky(probeAzimuths) : _denseSky;
    for (const HorizonQuality quality : qualities)
    {
        LightingSettings settings;
        settings.azimuths = probeAzimuths;
        settings.quality = quality;
        Result<Run> probed = run(state, settings, 1);
        if (!probed)
            return probed.error();
        std::vector<double> own = probed->skyErrors;
        for (std::size_t p = 0; p < own.size(); ++p)
            own[p] -= luminance(_sky.skyRadiance) * (exact[p] - _denseSky[p]);
        _meanSquare = probed->meanSquare; // the last, most exact one's stays
        _qualityErrors[quality] = std::move(own);
        _probes[quality] = std::move(*probed);
        _progress(0.2 + 0.13 * static_cast<double>(_probes.size()));
    }
    return Nothing{};
}

std::vector<SettingsTrial::Candidate> SettingsTrial::candidates(const LightingSettings& base) const
{
    std::vector<Candidate> all;
    for (const int azimuths : azimuthCounts)
    {
        if (!_sky.skyEnabled && azimuths != azimuthCounts.front())
            break; // nothing depends on them
        const std::vector<double> exact = _sky.skyEnabled ? exactSky(azimuths) : _denseSky;
        for (const HorizonQuality quality : qualities)
        {
            std::vector<double> errors = _qualityErrors.at(quality);
            for (std::size_t p = 0; p < errors.size(); ++p)
                errors[p] += luminance(_sky.skyRadiance) * (exact[p] - _denseSky[p]);
            const Run& probed = _probes.at(quality);
            Candidate candidate;
            candidate.settings = base;
            candidate.settings.quality = quality;
            if (_sky.skyEnabled)
                candidate.settings.azimuths = azimuths;
            candidate.error = errorOf(errors, probed.restErrors);
            candidate.milliseconds =
                probed.skyMilliseconds * azimuths / probeAzimuths + probed.restMilliseconds;
            all.push_back(candidate);
        }
    }
    return all;
}

Result<SettingsChoice> SettingsTrial::measure(osg::State& state, const LightingSettings& settings,
                                              int repeats)
{
    if (Status probed = probe(state); !probed)
        return probed.error();
    const Result<Run> measured = run(state, settings, repeats);
    if (!measured)
        return measured.error();
    SettingsChoice choice;
    choice.settings = settings;
    choice.error = errorOf(measured->skyErrors, measured->restErrors);
    choice.milliseconds = measured->skyMilliseconds + measured->restMilliseconds;
    choice.met = true;
    return choice;
}

Result<SettingsChoice>
SettingsTrial::firstOf(osg::State& state, const std::vector<Candidate>& candidates,
                       const std::function<bool(double error, double ms)>& fulfils,
                       const Candidate& closest, int repeats)
{
    double left = 0.4;
    for (const Candidate& candidate : candidates)
    {
        if (!fulfils(candidate.error, candidate.milliseconds))
            continue;
        Result<SettingsChoice> choice = measure(state, candidate.settings, repeats);
        if (!choice || fulfils(choice->error, choice->milliseconds))
        {
            _progress(1.0);
            return choice;
        }
        left *= 0.6;
        _progress(1.0 - left);
    }
    Result<SettingsChoice> choice = measure(state, closest.settings, repeats);
    if (choice)
        choice->met = fulfils(choice->error, choice->milliseconds);
    _progress(1.0);
    return choice;
}

Result<SettingsChoice> SettingsTrial::forMaxError(osg::State& state, const LightingSettings& base,
                                                  double maxError)
{
    if (Status probed = probe(state); !probed)
        return probed.error();
    std::vector<Candidate> all = candidates(base);
    const auto closest = *std::min_element(
        all.begin(), all.end(), [](const auto& a, const auto& b) { return a.error < b.error; });
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.milliseconds < b.milliseconds; });
    return firstOf(
        state, all, [maxError](double error, double) { return error <= maxError; }, closest, 1);
}

Result<SettingsChoice> SettingsTrial::forFrameTime(osg::State& state, const LightingSettings& base,
                                                   double milliseconds)
{
    if (Status probed = probe(state); !probed)
        return probed.error();
    std::vector<Candidate> all = candidates(base);
    const auto closest = *std::min_element(all.begin(), all.end(),
                                           [](const auto& a, const auto& b)
                                           { return a.milliseconds < b.milliseconds; });
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.error < b.error; });
    return firstOf(
        state, all, [milliseconds](double, double ms) { return ms <= milliseconds; }, closest, 3);
}

namespace
{
/// The public form: a context of its own, errors as text.
SettingsChoice
chooseInOwnContext(const DemTile& tile, const SkyLight& sky, const std::string& parameter,
                   double value,
                   const std::function<Result<SettingsChoice>(SettingsTrial&, osg::State&)>& choose)
{
    SettingsChoice failed;
    failed.failure = ParameterRange::find(parameter)->complaint(value);
    if (failed.failure.empty())
        failed.failure = tile.complaint();
    if (!failed.failure.empty())
        return failed;
    const std::unique_ptr<HeadlessContext> context =
        HeadlessContext::create(16, 16, failed.failure);
    if (!context)
        return failed;
    osg::State& state = context->state();
    if (const Result<GpuCapabilities> capabilities = GpuCapabilities::query(state); !capabilities)
    {
        failed.failure = capabilities.error().message;
        return failed;
    }
    Result<SettingsTrial> trial = SettingsTrial::create(state, tile, sky);
    const Result<SettingsChoice> choice =
        trial ? choose(*trial, state) : Result<SettingsChoice>(trial.error());
    if (choice)
        return *choice;
    failed.failure = choice.error().message;
    return failed;
}
} // namespace

SettingsChoice LightingSettings::forMaxError(double maxError, const DemTile& tile,
                                             const SkyLight& sky)
{
    return chooseInOwnContext(tile, sky, "max-error", maxError,
                              [maxError](SettingsTrial& trial, osg::State& state)
                              { return trial.forMaxError(state, {}, maxError); });
}

SettingsChoice LightingSettings::forFrameTime(double milliseconds, const DemTile& tile,
                                              const SkyLight& sky)
{
    return chooseInOwnContext(tile, sky, "max-ms", milliseconds,
                              [milliseconds](SettingsTrial& trial, osg::State& state)
                              { return trial.forFrameTime(state, {}, milliseconds); });
}

} // namespace osgTerrainLight
