#include "lighting/SettingsTrial.h"

#include "core/AzimuthSet.h"
#include "core/Luminance.h"
#include "core/SkyRadiance.h"
#include "core/WeightedSample.h"
#include "glsl_host.h"
#include "gpu/GlConstants.h"
#include "gpu/GpuCapabilities.h"
#include <osgTerrainLight/HeadlessContext.h>

#include <osg/GLObjects>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

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
/// Of the rough run that says where few azimuths matter.
constexpr int roughAzimuths = 8;
constexpr std::size_t skyPostCount = 384;
/// Wrong shadows are rare and big, so the sun needs many posts; it has few directions.
constexpr std::size_t sunPostCount = 4096;
/// Strips across the sun's disc, each with a horizon of its own.
constexpr int sunStrips = 33;
/// Posts of one scan.
constexpr std::size_t scanBatch = 16384;
/// What is taken without choosing.
constexpr int plainAzimuths = 128;

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

/// Work of a post, in that of one azimuth of the sky in draft quality. Measured with software
/// OpenGL (llvmpipe of Mesa 22.3.6, 2 cores, fractal of 512 × 512 posts, `bench --posts 0`).
struct Work
{
    double azimuth; ///< of the sky
    double rest;    ///< the sun, and putting light together
};
Work workPerPost(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return {1.0, 3.5};
    case HorizonQuality::Best:
        return {2.2, 11.0};
    default:
        return {1.15, 7.0};
    }
}
/// The same of one step of a ray in an exhaustive scan.
constexpr double workPerStep = 0.2;

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}
} // namespace

Result<SettingsTrial> SettingsTrial::create(const DemTile& tile, const SkyLight& sky,
                                            Product product, SkyViewDefinition definition,
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
    for (int row = 0; row < tile.height(); ++row)
        for (int column = 0; column < tile.width(); ++column)
            if (tile.isValid(column, row))
                trial._posts.push_back({column, row});
    if (trial._posts.empty())
        return Error{ErrorCode::Invalid, "no valid post: needed at least one to measure settings"};
    return trial;
}

double SettingsTrial::lowestSun() const
{
    return std::tan(std::max(_sky.sunElevation - _sky.sunAngularRadius, 0.0) * radiansPerDegree);
}

double SettingsTrial::workOf(const LightingSettings& settings) const
{
    const Work work = workPerPost(settings.quality);
    return static_cast<double>(_posts.size()) *
           (work.rest + (_sky.skyEnabled ? work.azimuth * settings.azimuths : 0.0));
}

double SettingsTrial::workOfChoosing() const
{
    // A ray from a random post is about half as long as the tile.
    const double steps = 0.5 * std::max(_tile.width(), _tile.height());
    // Towards the sun, none is followed farther than any post could hide the disc.
    double sum = 0.0;
    float highest = 0.0f;
    for (const TilePost& post : _posts)
    {
        const float height = _tile.heightAt(post.column, post.row);
        sum += static_cast<double>(height);
        highest = &post == &_posts.front() ? height : std::max(highest, height);
    }
    const double rise = static_cast<double>(highest) - sum / static_cast<double>(_posts.size());
    const double perStep = lowestSun() * std::min(_tile.nominalEastSpacing(), _tile.northSpacing);
    const double sunSteps = rise < steps * perStep ? rise / perStep : steps;
    double work = 0.0;
    LightingSettings settings;
    if (_sky.skyEnabled)
    {
        work += workPerStep * steps * static_cast<double>(skyPostCount) * denseAzimuths;
        settings.quality = HorizonQuality::Draft;
        settings.azimuths = roughAzimuths;
        work += workOf(settings);
    }
    if (TileLight::needsSun(_sky))
        work +=
            workPerStep * sunSteps * static_cast<double>(_posts.size() + sunPostCount * sunStrips);
    settings.azimuths = probeAzimuths;
    for (const HorizonQuality quality : qualities)
    {
        settings.quality = quality;
        work += workOf(settings);
    }
    return work;
}

Status SettingsTrial::sample(osg::State& state, const Run* rough, const Run& exact)
{
    if (sampled())
        return Nothing{};
    const auto draw = [this](const std::vector<double>& importance, std::size_t count,
                             std::uint32_t seed, std::vector<TilePost>& posts,
                             std::vector<double>& weights)
    {
        const WeightedSample drawn = drawByImportance(importance, count, seed);
        for (const std::size_t index : drawn.indices)
            posts.push_back(_posts[index]);
        weights = drawn.weights;
    };
    if (_sky.skyEnabled)
    {
        assert(rough);
        std::vector<double> importance;
        for (const TilePost& post : _posts)
        {
            const double difference = static_cast<double>(rough->view.at(post.column, post.row)) -
                                      static_cast<double>(exact.view.at(post.column, post.row));
            importance.push_back(difference * difference);
        }
        draw(importance, skyPostCount, 20261122, _skyPosts, _skyWeights);
        if (Status scanned = scanSky(state); !scanned)
            return scanned;
    }
    if (_product == Product::SkyView)
        return Nothing{};
    const Result<std::vector<double>> importance = sunImportance(state, rough, exact);
    if (!importance)
        return importance.error();
    draw(*importance, sunPostCount, 20261123, _sunPosts, _sunWeights);
    _sunFraction.assign(sunPostCount, 0.0);
    _fullSun.assign(sunPostCount, 0.0);
    return TileLight::needsSun(_sky) ? scanSun(state) : Status(Nothing{});
}

Result<std::vector<double>> SettingsTrial::sunImportance(osg::State& state, const Run* rough,
                                                         const Run& exact) const
{
    std::vector<double> importance(_posts.size(), 0.0);
    if (!TileLight::needsSun(_sky))
        return importance;
    // One exhaustive horizon of every post, towards the middle of the disc: a wrong shadow of a
    // single post cannot escape.
    const double radius = _sky.sunAngularRadius * radiansPerDegree;
    const double elevation = _sky.sunElevation * radiansPerDegree;
    const double lowest = lowestSun();
    const auto fractionAt = [](const Run& run, int column, int row)
    { return static_cast<double>(run.shading.at(column, row).a()); };
    for (std::size_t first = 0; first < _posts.size(); first += scanBatch)
    {
        const std::size_t end = std::min(first + scanBatch, _posts.size());
        const std::vector<TilePost> batch(_posts.begin() + static_cast<std::ptrdiff_t>(first),
                                          _posts.begin() + static_cast<std::ptrdiff_t>(end));
        const Result<Raster<double>> slopes =
            scanHorizons(state, _tile, batch, {directionOfCompass(_sky.sunAzimuth)}, lowest);
        if (!slopes)
            return slopes.error();
        for (std::size_t i = first; i < end; ++i)
        {
            const auto [column, row] = _posts[i];
            const double edge =
                std::atan(std::max(slopes->at(static_cast<int>(i - first), 0), 0.0));
            const double scanned =
                std::clamp((elevation - edge + radius) / (2.0 * radius), 0.0, 1.0);
            const double found = fractionAt(exact, column, row);
            double doubt = std::abs(found - scanned);
            if (rough)
                doubt += std::abs(found - fractionAt(*rough, column, row));
            // Where the shadow ends between two posts, a little.
            for (const auto& [x, y] :
                 {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0), std::pair(0, -1)})
                if (column + x >= 0 && row + y >= 0 && column + x < _tile.width() &&
                    row + y < _tile.height() && _tile.isValid(column + x, row + y))
                    doubt += 0.02 * std::abs(found - fractionAt(exact, column + x, row + y));
            importance[i] = doubt * doubt;
        }
    }
    return importance;
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
    // Half as many azimuths at least double the error, so what they change is more than the error
    // that is left.
    std::vector<double> change = exactSky(denseAzimuths / 2);
    double sum = 0.0;
    for (std::size_t p = 0; p < change.size(); ++p)
        sum += _skyWeights[p] * (change[p] - _denseSky[p]) * (change[p] - _denseSky[p]);
    _denseSkyError =
        luminance(_sky.skyRadiance) * std::sqrt(sum / static_cast<double>(change.size()));
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
    const double lowest = lowestSun();
    const Result<Raster<double>> slopes = scanHorizons(state, _tile, _sunPosts, directions, lowest);
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
        _fullSun[p] = luminance(_sky.sunIrradiance) * std::max(facing, 0.0) / pi;
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
    Run result;
    result.light = new TileLight(_tile, direct, _sky, _definition);
    result.light->setTimed(true);
    std::vector<double> sky, rest;
    for (int i = 0; i <= repeats; ++i) // the first one compiles
    {
        result.light->touch();
        if (Status done = result.light->update(state); !done)
            return done.error();
        double skySum = 0.0;
        double restSum = 0.0;
        for (const StageCost& cost : result.light->costs())
            if (cost.bytes > 0)
                (cost.name == "horizon" || cost.name == "sky" ? skySum : restSum) +=
                    cost.gpuMilliseconds;
        if (i > 0 || repeats == 0)
        {
            sky.push_back(skySum);
            rest.push_back(restSum);
        }
    }
    result.light->setTimed(false);
    result.skyMilliseconds = median(sky);
    result.restMilliseconds = median(rest);
    result.shading = result.light->readShading(state);
    if (_sky.skyEnabled)
        result.view = result.light->readSkyView(state);
    const double valid = static_cast<double>(_posts.size());
    for (const TilePost& post : _posts)
    {
        const osg::Vec4f& c = result.shading.at(post.column, post.row);
        const double y =
            _product == Product::SunFraction ? static_cast<double>(c.a()) : luminance(rgbOf(c));
        result.meanSquare += y * y / valid;
    }
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
        return Error{ErrorCode::Failed, error == GL_OUT_OF_MEMORY
                                            ? "not enough graphics memory to measure settings"
                                            : "OpenGL error while settings were measured"};
    return result;
}

void SettingsTrial::release(osg::State& state, osg::ref_ptr<TileLight>& light)
{
    if (light)
        light->releaseGLObjects(&state);
    light = nullptr;
    osg::flushAllDeletedGLObjects(state.getContextID());
}

std::vector<double> SettingsTrial::skyErrorsOf(const Run& run) const
{
    std::vector<double> errors;
    for (std::size_t p = 0; p < _skyPosts.size(); ++p)
        errors.push_back(luminance(_sky.skyRadiance) *
                         (static_cast<double>(run.view.at(_skyPosts[p].column, _skyPosts[p].row)) -
                          _denseSky[p]));
    return errors;
}

std::vector<double> SettingsTrial::restErrorsOf(const Run& run) const
{
    std::vector<double> errors;
    for (std::size_t p = 0; p < _sunPosts.size(); ++p)
    {
        const auto [column, row] = _sunPosts[p];
        const osg::Vec4f& found = run.shading.at(column, row);
        if (_product == Product::SunFraction)
        {
            errors.push_back(static_cast<double>(found.a()) - _sunFraction[p]);
            continue;
        }
        double light = luminance(rgbOf(found)) - _fullSun[p] * _sunFraction[p];
        if (_sky.skyEnabled)
            light -= luminance(_sky.skyRadiance) * static_cast<double>(run.view.at(column, row));
        errors.push_back(light);
    }
    return errors;
}

double SettingsTrial::skyBound(const std::vector<double>& errors) const
{
    if (errors.empty())
        return 0.0;
    const double most = luminance(_sky.skyRadiance);
    return std::sqrt(meanSquareBound(errors, _skyWeights, 2.0 * most * most)) + _denseSkyError;
}

double SettingsTrial::restBound(const std::vector<double>& errors) const
{
    if (errors.empty())
        return 0.0;
    const double most = _product == Product::SunFraction ? 1.0 : luminance(_sky.sunIrradiance) / pi;
    return std::sqrt(meanSquareBound(errors, _sunWeights, 2.0 * most * most));
}

Status SettingsTrial::probe(osg::State& state, int repeats)
{
    if (_probeRepeats >= repeats)
        return Nothing{};
    LightingSettings settings;
    if (!sampled())
    {
        Run rough;
        if (_sky.skyEnabled)
        {
            settings.quality = HorizonQuality::Draft;
            settings.azimuths = roughAzimuths;
            Result<Run> done = run(state, settings, 0);
            if (!done)
                return done.error();
            rough = std::move(*done);
            release(state, rough.light);
        }
        settings.quality = HorizonQuality::Best;
        settings.azimuths = probeAzimuths;
        Result<Run> exact = run(state, settings, 0);
        if (!exact)
            return exact.error();
        release(state, exact->light);
        if (Status drawn = sample(state, _sky.skyEnabled ? &rough : nullptr, *exact); !drawn)
            return drawn;
        keepProbe(HorizonQuality::Best, *exact);
        _progress(0.3);
    }
    settings.azimuths = probeAzimuths;
    for (const HorizonQuality quality : qualities)
    {
        if (repeats == 0 && _probes.count(quality) > 0)
            continue;
        settings.quality = quality;
        Result<Run> probed = run(state, settings, repeats);
        if (!probed)
            return probed.error();
        release(state, probed->light);
        keepProbe(quality, *probed);
        _progress(0.3 + 0.1 * static_cast<double>(_probes.size()));
    }
    _probeRepeats = repeats;
    return Nothing{};
}

void SettingsTrial::keepProbe(HorizonQuality quality, const Run& run)
{
    Probe& probe = _probes[quality];
    probe.skyErrors = skyErrorsOf(run);
    if (_sky.skyEnabled)
    {
        const std::vector<double> exact = exactSky(probeAzimuths);
        for (std::size_t p = 0; p < exact.size(); ++p)
            probe.skyErrors[p] -= luminance(_sky.skyRadiance) * (exact[p] - _denseSky[p]);
    }
    probe.restBound = restBound(restErrorsOf(run));
    probe.skyMilliseconds = run.skyMilliseconds;
    probe.restMilliseconds = run.restMilliseconds;
    if (quality == HorizonQuality::Best)
        _meanSquare = run.meanSquare;
}

double SettingsTrial::predictedError(const LightingSettings& settings) const
{
    const Probe& probe = _probes.at(settings.quality);
    std::vector<double> errors = probe.skyErrors;
    if (_sky.skyEnabled)
    {
        const std::vector<double> exact = exactSky(settings.azimuths);
        for (std::size_t p = 0; p < errors.size(); ++p)
            errors[p] += luminance(_sky.skyRadiance) * (exact[p] - _denseSky[p]);
    }
    return _meanSquare > 0.0 ? (skyBound(errors) + probe.restBound) / std::sqrt(_meanSquare) : 0.0;
}

double SettingsTrial::predictedMilliseconds(const LightingSettings& settings) const
{
    const Probe& probe = _probes.at(settings.quality);
    return probe.skyMilliseconds * settings.azimuths / probeAzimuths + probe.restMilliseconds;
}

std::vector<LightingSettings> SettingsTrial::candidates(const LightingSettings& base) const
{
    std::vector<LightingSettings> all;
    for (const int azimuths : azimuthCounts)
    {
        if (!_sky.skyEnabled && azimuths != azimuthCounts.front())
            break; // nothing depends on them
        for (const HorizonQuality quality : qualities)
        {
            all.push_back(base);
            all.back().quality = quality;
            if (_sky.skyEnabled)
                all.back().azimuths = azimuths;
        }
    }
    return all;
}

Result<SettingsChoice> SettingsTrial::measure(osg::State& state, const LightingSettings& settings,
                                              int repeats)
{
    if (!sampled())
        if (Status probed = probe(state, 0); !probed)
            return probed.error();
    release(state, _light);
    Result<Run> measured = run(state, settings, repeats);
    if (!measured)
        return measured.error();
    return choiceOf(settings, *measured);
}

SettingsChoice SettingsTrial::choiceOf(const LightingSettings& settings, const Run& run)
{
    _light = run.light;
    SettingsChoice choice;
    choice.settings = settings;
    const double bound = skyBound(skyErrorsOf(run)) + restBound(restErrorsOf(run));
    // Sky and rest are measured at posts of their own; the sum of the roots bounds the root of the
    // sum.
    choice.error = run.meanSquare > 0.0 ? bound / std::sqrt(run.meanSquare) : 0.0;
    choice.milliseconds = run.skyMilliseconds + run.restMilliseconds;
    choice.met = true;
    return choice;
}

osg::ref_ptr<TileLight> SettingsTrial::takeLight()
{
    osg::ref_ptr<TileLight> light = _light;
    _light = nullptr;
    return light;
}

Result<SettingsChoice>
SettingsTrial::firstOf(osg::State& state, const std::vector<LightingSettings>& settings,
                       const std::function<bool(const LightingSettings&)>& promises,
                       const std::function<bool(const SettingsChoice&)>& fulfils,
                       const std::function<double(const LightingSettings&)>& distance, int repeats)
{
    double left = 0.4;
    for (const LightingSettings& candidate : settings)
    {
        if (!promises(candidate))
            continue;
        Result<SettingsChoice> choice = measure(state, candidate, repeats);
        if (!choice || fulfils(*choice))
        {
            _progress(1.0);
            return choice;
        }
        left *= 0.6;
        _progress(1.0 - left);
    }
    const LightingSettings closest = *std::min_element(settings.begin(), settings.end(),
                                                       [&distance](const auto& a, const auto& b)
                                                       { return distance(a) < distance(b); });
    Result<SettingsChoice> choice = measure(state, closest, repeats);
    if (choice)
        choice->met = fulfils(*choice);
    _progress(1.0);
    return choice;
}

Result<SettingsChoice>
SettingsTrial::measureMostExact(osg::State& state, const LightingSettings& base, double maxError)
{
    LightingSettings settings = base;
    settings.quality = HorizonQuality::Best;
    Run rough;
    if (_sky.skyEnabled)
    {
        settings.azimuths = plainAzimuths;
        LightingSettings cheap;
        cheap.quality = HorizonQuality::Draft;
        cheap.azimuths = roughAzimuths;
        Result<Run> done = run(state, cheap, 0);
        if (!done)
            return done.error();
        rough = std::move(*done);
        release(state, rough.light);
    }
    Result<Run> plain = run(state, settings, 0);
    if (!plain)
        return plain.error();
    _progress(0.5);
    if (Status drawn = sample(state, _sky.skyEnabled ? &rough : nullptr, *plain); !drawn)
        return drawn.error();
    SettingsChoice choice = choiceOf(settings, *plain);
    if (choice.error > maxError && _sky.skyEnabled)
    {
        settings.azimuths = azimuthCounts.back();
        Result<SettingsChoice> finest = measure(state, settings, 0);
        if (!finest)
            return finest;
        choice = *finest;
    }
    choice.met = choice.error <= maxError;
    _progress(1.0);
    return choice;
}

Result<SettingsChoice> SettingsTrial::forMaxError(osg::State& state, const LightingSettings& base,
                                                  double maxError)
{
    std::vector<LightingSettings> all = candidates(base);
    std::stable_sort(all.begin(), all.end(),
                     [this](const auto& a, const auto& b) { return workOf(a) < workOf(b); });
    LightingSettings plain = base;
    plain.quality = HorizonQuality::Best;
    plain.azimuths = plainAzimuths;
    if (_probes.empty() && workOfChoosing() + workOf(all.front()) > workOf(plain))
        return measureMostExact(state, base, maxError);
    if (Status probed = probe(state, 0); !probed)
        return probed.error();
    const auto predicted = [this](const LightingSettings& settings)
    { return predictedError(settings); };
    return firstOf(
        state, all,
        [&](const LightingSettings& settings) { return predicted(settings) <= maxError; },
        [&](const SettingsChoice& choice) { return choice.error <= maxError; }, predicted, 0);
}

Result<SettingsChoice> SettingsTrial::forFrameTime(osg::State& state, const LightingSettings& base,
                                                   double milliseconds)
{
    if (Status probed = probe(state, 1); !probed)
        return probed.error();
    std::vector<std::pair<double, LightingSettings>> ranked;
    for (const LightingSettings& settings : candidates(base))
        ranked.emplace_back(predictedError(settings), settings);
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<LightingSettings> all;
    for (const auto& [error, settings] : ranked)
        all.push_back(settings);
    const auto predicted = [this](const LightingSettings& settings)
    { return predictedMilliseconds(settings); };
    return firstOf(
        state, all,
        [&](const LightingSettings& settings) { return predicted(settings) <= milliseconds; },
        [&](const SettingsChoice& choice) { return choice.milliseconds <= milliseconds; },
        predicted, 3);
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
    Result<SettingsTrial> trial = SettingsTrial::create(tile, sky);
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
