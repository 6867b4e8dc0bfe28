#include "reference/PathTracer.h"

#include "core/AzimuthSet.h"
#include "reference/LatinSupercube.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace osgTerrainLight::reference
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;

using Place = std::array<double, 2>; // of the unit square

double dot(const Vector3& a, const Vector3& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 cross(const Vector3& a, const Vector3& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// axis · alongAxis + (two unit vectors at right angles to it) · (across, at the angle).
Vector3 around(const Vector3& axis, double alongAxis, double across, double angle)
{
    // Any vector but the axis itself; the coordinate axis furthest from it.
    Vector3 other = {};
    const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
    other[static_cast<std::size_t>(std::min_element(axis.begin(), axis.end(), size) -
                                   axis.begin())] = 1.0;
    Vector3 first = cross(axis, other);
    const double length = std::sqrt(dot(first, first));
    for (double& x : first)
        x /= length;
    const Vector3 second = cross(axis, first);
    Vector3 result = {};
    for (std::size_t k = 0; k < 3; ++k)
        result[k] = axis[k] * alongAxis +
                    across * (first[k] * std::cos(angle) + second[k] * std::sin(angle));
    return result;
}

/// The Phong lobe, or its lowest bands.
class Lobe
{
public:
    explicit Lobe(const SceneDescription& scene) : _exponent(scene.glossExponent)
    {
        const double s = _exponent;
        for (int l = 0; l < scene.glossBands; ++l)
        {
            // What a convolution with the lobe multiplies band l by: 2π ∫ lobe P_l.
            const double factor = l == 0   ? 1.0
                                  : l == 1 ? (s + 1.0) / (s + 2.0)
                                           : _factors[static_cast<std::size_t>(l - 2)] *
                                                 (s - l + 2.0) / (s + l + 1.0);
            _factors.push_back(factor);
        }
    }

    bool isExact() const { return _factors.empty(); }

    /// What is sent; below 0 for some cosines where it is not exact.
    double value(double cosine) const
    {
        double sum = 0.0;
        for (std::size_t l = 0; l < _factors.size(); ++l)
            sum += _factors[l] * (2.0 * double(l) + 1.0) / (4.0 * pi) *
                   std::legendre(static_cast<unsigned>(l), std::clamp(cosine, -1.0, 1.0));
        return isExact() ? density(cosine) : sum;
    }

    /// What directions are drawn with: the exact lobe.
    double density(double cosine) const
    {
        return cosine > 0.0 ? (_exponent + 1.0) / (2.0 * pi) * std::pow(cosine, _exponent) : 0.0;
    }
    Vector3 direction(const Vector3& axis, const Place& place) const
    {
        const double cosine = std::pow(1.0 - place[0], 1.0 / (_exponent + 1.0));
        return around(axis, cosine, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)),
                      2.0 * pi * place[1]);
    }

private:
    double _exponent;
    std::vector<double> _factors;
};

/// How a place on a path sends on what it receives: albedo · cosine / π + gloss · lobe.
class Reflection
{
public:
    /// towards: where the light goes; of no meaning where gloss is 0.
    Reflection(const Lobe& lobe, const Vector3& normal, const Vector3& towards,
               const LinearRgb& albedo, double gloss)
        : _lobe(&lobe), _normal(normal), _albedo(albedo), _gloss(gloss)
    {
        const double along = dot(normal, towards);
        for (std::size_t k = 0; k < 3; ++k)
            _mirror[k] = 2.0 * along * normal[k] - towards[k];
        const double diffuse = *std::max_element(albedo.begin(), albedo.end());
        // Bands that are left out leave some lobe everywhere: uniform directions find it.
        const double even = lobe.isExact() ? 0.0 : gloss;
        const double sum = diffuse + gloss + even;
        _lobeShare = gloss > 0.0 ? gloss / sum : 0.0;
        _evenShare = gloss > 0.0 ? even / sum : 0.0;
    }

    double cosine(const Vector3& direction) const { return dot(_normal, direction); }

    LinearRgb value(const Vector3& direction) const
    {
        const double received = cosine(direction);
        LinearRgb result = {};
        if (received <= 0.0)
            return result;
        const double mirrored = _gloss > 0.0 ? _gloss * _lobe->value(dot(_mirror, direction)) : 0.0;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = _albedo[k] * received / pi + mirrored;
        return result;
    }

    double density(const Vector3& direction) const
    {
        const double received = std::max(0.0, cosine(direction));
        double result = (1.0 - _lobeShare - _evenShare) * received / pi;
        if (_lobeShare > 0.0)
            result += _lobeShare * _lobe->density(dot(_mirror, direction));
        if (_evenShare > 0.0 && received > 0.0)
            result += _evenShare / (2.0 * pi);
        return result;
    }

    /// May lie below the surface, where nothing comes from.
    Vector3 direction(Place place) const
    {
        if (place[0] < _lobeShare)
            return _lobe->direction(_mirror, {place[0] / _lobeShare, place[1]});
        place[0] -= _lobeShare;
        if (place[0] < _evenShare)
        {
            const double up = place[0] / _evenShare;
            return around(_normal, up, std::sqrt(1.0 - up * up), 2.0 * pi * place[1]);
        }
        const double u = (place[0] - _evenShare) / (1.0 - _lobeShare - _evenShare);
        return around(_normal, std::sqrt(std::max(0.0, 1.0 - u)), std::sqrt(u),
                      2.0 * pi * place[1]);
    }

private:
    const Lobe* _lobe;
    Vector3 _normal, _mirror = {};
    LinearRgb _albedo;
    double _gloss, _lobeShare = 0.0, _evenShare = 0.0;
};

/// The sun's disc, uniform in radiance.
class SunDisc
{
public:
    explicit SunDisc(const SkyLight& light)
    {
        const MapDirection map = directionOfCompass(light.sunAzimuth);
        const double elevation = light.sunElevation * degree;
        _centre = {map.east * std::cos(elevation), map.north * std::cos(elevation),
                   std::sin(elevation)};
        const double radius = light.sunAngularRadius * degree;
        const double sine = std::sin(0.5 * radius);
        _depth = 2.0 * sine * sine;
        // Over the disc cos θ integrates to π sin²(radius), on a surface that faces its centre.
        const double facing = pi * std::sin(radius) * std::sin(radius);
        for (std::size_t k = 0; k < 3; ++k)
            _radiance[k] = double(light.sunIrradiance[k]) / facing;
    }

    Vector3 direction(const Place& place) const
    {
        const double below = place[0] * _depth; // 1 − cos
        return around(_centre, 1.0 - below, std::sqrt(below * (2.0 - below)), 2.0 * pi * place[1]);
    }

    double solidAngle() const { return 2.0 * pi * _depth; }
    const LinearRgb& radiance() const { return _radiance; }

private:
    Vector3 _centre = {};
    double _depth = 0.0; ///< 1 − cos(radius)
    LinearRgb _radiance = {};
};

/// Directions with a density that is constant over each texel of a table.
class ImportanceTable
{
public:
    /// Weights by the solid angle above `lowestSine`, the sine of an elevation.
    ImportanceTable(const Raster<double>& values, double lowestSine)
        : _values(values), _lowestSine(lowestSine)
    {
        double sum = 0.0;
        for (int row = 0; row < values.height(); ++row)
            for (int column = 0; column < values.width(); ++column)
                _sums.push_back(sum += values.at(column, row) * (sine(row + 1) - sine(row)));
        _perValue = sum > 0.0 ? values.width() / (2.0 * pi * sum) : 0.0;
    }

    bool isBlack() const { return _perValue == 0.0; }

    /// Per steradian, of a direction above the lowest.
    double density(const Vector3& direction) const
    {
        const double turn = std::atan2(direction[1], direction[0]) / (2.0 * pi);
        const double up = std::asin(std::clamp(direction[2], -1.0, 1.0)) / pi + 0.5;
        const int column = static_cast<int>((turn < 0.0 ? turn + 1.0 : turn) * _values.width());
        const int row = static_cast<int>(up * _values.height());
        return _perValue * _values.at(std::min(column, _values.width() - 1),
                                      std::min(row, _values.height() - 1));
    }

    Vector3 direction(const Place& place) const
    {
        const double at = place[0] * _sums.back();
        const auto above = std::upper_bound(_sums.begin(), _sums.end() - 1, at);
        const double below = above == _sums.begin() ? 0.0 : *(above - 1);
        const int texel = static_cast<int>(above - _sums.begin());
        const double inColumn = std::min((at - below) / (*above - below), 1.0);
        const double azimuth = 2.0 * pi * (texel % _values.width() + inColumn) / _values.width();
        const int row = texel / _values.width();
        const double up = sine(row) + place[1] * (sine(row + 1) - sine(row));
        const double along = std::sqrt(std::max(0.0, 1.0 - up * up));
        return {along * std::cos(azimuth), along * std::sin(azimuth), up};
    }

private:
    /// Of the elevation of a row's lower edge.
    double sine(int row) const
    {
        return std::max(std::sin(pi * (double(row) / _values.height() - 0.5)), _lowestSine);
    }

    const Raster<double>& _values;
    double _lowestSine;
    std::vector<double> _sums;
    double _perValue = 0.0;
};

/// Weight of a sample drawn with density `own` that `other` may draw too (Veach and Guibas). By
/// squares, so that the cosine's few hits on a bright texel count next to nothing.
double powerWeight(double own, double other)
{
    return own * own / (own * own + other * other);
}

LinearRgb product(const LinearRgb& a, const LinearRgb& b)
{
    return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}

/// Sums over the paths of a batch, and from the batches' means the estimates.
class Statistics
{
public:
    enum Quantity : std::size_t
    {
        Sky,
        Sun,
        Emitters,
        Total,
        SunVisible,
        FirstBounce
    };

    explicit Statistics(int bounces)
        : _batch(FirstBounce + static_cast<std::size_t>(bounces)), _mean(_batch.size()),
          _squares(_batch.size())
    {
    }

    void add(std::size_t quantity, double factor, const LinearRgb& throughput,
             const LinearRgb& radiance)
    {
        for (std::size_t k = 0; k < 3; ++k)
        {
            const double value = factor * throughput[k] * radiance[k];
            _batch[quantity][k] += value;
            if (quantity != SunVisible)
                _batch[Total][k] += value;
        }
    }

    /// Welford's update with the mean of the batch.
    void endBatch(int samples)
    {
        ++_batches;
        for (std::size_t q = 0; q < _batch.size(); ++q)
            for (std::size_t k = 0; k < 3; ++k)
            {
                const double mean = _batch[q][k] / samples;
                const double difference = mean - _mean[q][k];
                _mean[q][k] += difference / _batches;
                _squares[q][k] += difference * (mean - _mean[q][k]);
                _batch[q][k] = 0.0;
            }
    }

    Estimate estimate(std::size_t quantity) const
    {
        Estimate result;
        result.mean = _mean[quantity];
        for (std::size_t k = 0; k < 3; ++k)
            result.standardError[k] =
                std::sqrt(_squares[quantity][k] / (double(_batches) * (_batches - 1)));
        return result;
    }

    bool isFinite() const
    {
        for (const LinearRgb& square : _squares)
            for (double x : square)
                if (!std::isfinite(x))
                    return false;
        return true;
    }

private:
    std::vector<LinearRgb> _batch;
    std::vector<LinearRgb> _mean;
    std::vector<LinearRgb> _squares; ///< sum of squared deviations
    int _batches = 0;
};

/// Paths from one receiver after the other; one per thread.
class Worker
{
public:
    Worker(const RayScene& scene, const Illumination& illumination, const ImportanceTable* table,
           const PathTracerOptions& options, int samplesPerBatch)
        : _scene(scene), _illumination(illumination), _table(table), _options(options),
          _sun(illumination.light), _lobe(scene.description()), _random(samplesPerBatch),
          _lowestSine(illumination.extent == SkyExtent::AboveHorizontal ? 0.0 : -1.0)
    {
        for (std::size_t k = 0; k < 3; ++k)
            _uniform[k] =
                illumination.light.skyEnabled ? double(illumination.light.skyRadiance[k]) : 0.0;
    }

    /// Nothing where a radiance was not finite.
    /// towards: as Receiver's.
    std::optional<ReceivedLight> receive(const SurfacePoint& receiver,
                                         const std::optional<Vector3>& towards, std::size_t index)
    {
        const Reflection response =
            towards ? Reflection(_lobe, receiver.normal, *towards, {0.0, 0.0, 0.0}, 1.0)
                    : Reflection(_lobe, receiver.normal, {}, {1.0, 1.0, 1.0}, 0.0);
        Statistics statistics(_options.bounces);
        _rays = 0;
        const std::uint64_t stream = mixed(mixed(_options.seed) + index);
        for (int batch = 0; batch < _options.batches; ++batch)
        {
            _random.start(mixed(stream + static_cast<std::uint64_t>(batch)));
            for (int i = 0; i < _random.count(); ++i)
                followPath(receiver, response, i, statistics);
            statistics.endBatch(_random.count());
        }
        if (!statistics.isFinite())
            return std::nullopt;
        ReceivedLight light;
        light.sky = statistics.estimate(Statistics::Sky);
        light.sun = statistics.estimate(Statistics::Sun);
        light.emitters = statistics.estimate(Statistics::Emitters);
        light.total = statistics.estimate(Statistics::Total);
        light.sunVisible = statistics.estimate(Statistics::SunVisible);
        for (std::size_t k = 0; k < static_cast<std::size_t>(_options.bounces); ++k)
            light.bounces.push_back(statistics.estimate(Statistics::FirstBounce + k));
        light.samples = static_cast<std::uint64_t>(_options.batches) *
                        static_cast<std::uint64_t>(_random.count());
        light.rays = _rays;
        return light;
    }

private:
    LinearRgb skyRadiance(const Vector3& direction) const
    {
        if (direction[2] < _lowestSine)
            return {};
        return _illumination.environment ? _illumination.environment(direction) : _uniform;
    }

    void followPath(const SurfacePoint& receiver, const Reflection& response, int sample,
                    Statistics& statistics)
    {
        SurfacePoint place = receiver;
        Reflection reflection = response;
        LinearRgb throughput = {1.0, 1.0, 1.0};
        for (int order = 0; order <= _options.bounces; ++order)
        {
            const auto quantity = [order](Statistics::Quantity direct) {
                return order == 0 ? direct
                                  : Statistics::FirstBounce + static_cast<std::size_t>(order - 1);
            };
            const auto random = [&](int use) { return _random.point(3 * order + use, sample); };

            if (_illumination.light.sunEnabled)
                addSun(place, reflection, random(1), order, throughput, quantity(Statistics::Sun),
                       statistics);
            if (_table)
            {
                const Vector3 direction = _table->direction(random(2));
                if (reflection.cosine(direction) > 0.0 && !isOccluded(place, direction))
                {
                    const double density = _table->density(direction);
                    statistics.add(quantity(Statistics::Sky),
                                   powerWeight(density, reflection.density(direction)) / density,
                                   product(throughput, reflection.value(direction)),
                                   skyRadiance(direction));
                }
            }

            const Vector3 direction = reflection.direction(random(0));
            const double density = reflection.density(direction);
            if (!(reflection.cosine(direction) > 0.0 && density > 0.0))
                return;
            const LinearRgb value = reflection.value(direction);
            for (std::size_t k = 0; k < 3; ++k)
                throughput[k] *= value[k] / density;
            const bool last = order == _options.bounces;
            std::optional<SurfacePoint> hit;
            bool occluded = false;
            if (last && !_scene.hasEmission())
                occluded = isOccluded(place, direction);
            else
            {
                ++_rays;
                hit = _scene.firstHit(place, direction);
                occluded = hit.has_value();
            }
            if (!occluded)
            {
                const double weight =
                    _table ? powerWeight(density, _table->density(direction)) : 1.0;
                statistics.add(quantity(Statistics::Sky), weight, throughput,
                               skyRadiance(direction));
                return;
            }
            if (last && !hit)
                return;
            statistics.add(quantity(Statistics::Emitters), 1.0, throughput, hit->emission);
            const double gloss = hit->triangle < 0 ? _scene.description().gloss : 0.0;
            if (!hit->above || (hit->albedo == LinearRgb{} && gloss == 0.0))
                return;
            place = *hit;
            reflection =
                Reflection(_lobe, place.normal, {-direction[0], -direction[1], -direction[2]},
                           place.albedo, gloss);
        }
    }

    void addSun(const SurfacePoint& place, const Reflection& reflection, const Place& random,
                int order, const LinearRgb& throughput, std::size_t quantity,
                Statistics& statistics)
    {
        const Vector3 direction = _sun.direction(random);
        const double cosine = reflection.cosine(direction);
        // The receiver's visible fraction counts the disc whatever way the surface faces.
        if (direction[2] < _lowestSine || (cosine <= 0.0 && order > 0) ||
            isOccluded(place, direction))
            return;
        if (order == 0)
            statistics.add(Statistics::SunVisible, 1.0, throughput, {1.0, 1.0, 1.0});
        if (cosine > 0.0)
            statistics.add(quantity, _sun.solidAngle(),
                           product(throughput, reflection.value(direction)), _sun.radiance());
    }

    bool isOccluded(const SurfacePoint& place, const Vector3& direction)
    {
        ++_rays;
        return _scene.isOccluded(place, direction);
    }

    const RayScene& _scene;
    const Illumination& _illumination;
    const ImportanceTable* _table;
    const PathTracerOptions& _options;
    SunDisc _sun;
    Lobe _lobe;
    LatinSupercube _random;
    double _lowestSine;
    LinearRgb _uniform = {};
    std::uint64_t _rays = 0;
};

Error invalid(const std::string& what)
{
    return {ErrorCode::Invalid, "path tracer: " + what};
}

/// The sentence of the first value out of range; empty where all are within.
std::string faultOf(const Illumination& illumination, const PathTracerOptions& options)
{
    const SkyLight& light = illumination.light;
    const auto isRadiance = [](const Rgb& rgb)
    {
        return std::all_of(rgb.begin(), rgb.end(),
                           [](float c) { return c >= 0.0f && std::isfinite(c); });
    };
    if (light.skyEnabled && !illumination.environment && !isRadiance(light.skyRadiance))
        return "the sky's radiance is not finite and ≥ 0";
    if (light.sunEnabled)
    {
        if (!isRadiance(light.sunIrradiance))
            return "the sun's irradiance is not finite and ≥ 0";
        if (!std::isfinite(light.sunAzimuth))
            return "the sun's azimuth is not finite";
        if (!(std::abs(light.sunElevation) <= 90.0))
            return "the sun's elevation is not within -90 … 90 degrees";
        if (!(light.sunAngularRadius >= 0.01 && light.sunAngularRadius <= 10.0))
            return "the sun's angular radius is not within 0.01 … 10 degrees";
    }
    for (double value : illumination.importance.values())
        if (!(value >= 0.0) || !std::isfinite(value))
            return "the importance table holds a value that is not finite and ≥ 0";
    if (options.samples < 1 || options.samples > 1 << 26)
        return "samples are not within 1 … 2^26";
    if (options.batches < 2 || options.batches > 4096)
        return "batches are not within 2 … 4096";
    if (options.bounces < 0 || options.bounces > 1000)
        return "bounces are not within 0 … 1000";
    if (options.threads < 0 || options.threads > 1024)
        return "threads are not within 0 … 1024";
    return {};
}

/// Where receivers lie, in their order.
Result<std::vector<SurfacePoint>> pointsOf(const RayScene& scene,
                                           const std::vector<Receiver>& receivers)
{
    const DemTile& tile = scene.description().tile;
    const std::size_t triangles = scene.description().triangles.size();
    std::vector<SurfacePoint> points;
    for (const Receiver& r : receivers)
    {
        const std::string name = "receiver " + std::to_string(points.size());
        if (r.towards && !(std::abs(dot(*r.towards, *r.towards) - 1.0) < 1e-9))
            return invalid(name + " sends light towards a direction that is not of length 1");
        if (r.place)
        {
            const auto& [at, normal] = *r.place;
            if (!std::isfinite(dot(at, at)) || !(std::abs(dot(normal, normal) - 1.0) < 1e-9))
                return invalid(name + " has no finite place or no normal of length 1");
            points.push_back(scene.pointAt(at, normal));
            continue;
        }
        if (r.triangle >= 0)
        {
            if (static_cast<std::size_t>(r.triangle) >= triangles)
                return invalid(name + " is on triangle " + std::to_string(r.triangle) + " of " +
                               std::to_string(triangles));
            if (!(r.s >= 0.0 && r.t >= 0.0 && r.s + r.t <= 1.0))
                return invalid(name + " lies outside its triangle");
            points.push_back(scene.pointOfTriangle(r.triangle, r.s, r.t));
            continue;
        }
        if (r.column < 0 || r.row < 0 || r.column >= tile.width() || r.row >= tile.height())
            return invalid(name + " lies outside the tile");
        if (!tile.isValid(r.column, r.row))
            return invalid(name + " is the void post (" + std::to_string(r.column) + ", " +
                           std::to_string(r.row) + ")");
        points.push_back(scene.post(r.column, r.row));
    }
    return points;
}
} // namespace

Raster<double> importanceOf(const std::function<LinearRgb(const Vector3&)>& environment, int width,
                            int height)
{
    Raster<double> table(width, height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            const double elevation = pi * ((row + 0.5) / height - 0.5);
            const double azimuth = 2.0 * pi * (column + 0.5) / width;
            const LinearRgb radiance =
                environment({std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation)});
            table.at(column, row) = std::max({radiance[0], radiance[1], radiance[2]});
        }
    return table;
}

PathTracer::PathTracer(std::unique_ptr<RayScene> scene) : _scene(std::move(scene)) {}

Result<PathTracer> PathTracer::build(SceneDescription description)
{
    auto scene = RayScene::build(std::move(description));
    if (!scene)
        return scene.error();
    return PathTracer(std::move(*scene));
}

Result<std::vector<ReceivedLight>> PathTracer::trace(const Illumination& illumination,
                                                     const std::vector<Receiver>& receivers,
                                                     const PathTracerOptions& options) const
{
    const std::string fault = faultOf(illumination, options);
    if (!fault.empty())
        return invalid(fault);
    const Result<std::vector<SurfacePoint>> points = pointsOf(*_scene, receivers);
    if (!points)
        return points.error();

    std::optional<ImportanceTable> table;
    if (!illumination.importance.empty())
    {
        table.emplace(illumination.importance,
                      illumination.extent == SkyExtent::AboveHorizontal ? 0.0 : -1.0);
        if (table->isBlack())
            return invalid("the importance table is 0 all over the sky");
    }

    int samplesPerBatch = 1;
    while (samplesPerBatch * options.batches < options.samples)
        samplesPerBatch *= 2;
    std::vector<ReceivedLight> received(receivers.size());
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> finite = true;
    std::mutex mutex;
    std::size_t done = 0;
    const auto work = [&]
    {
        Worker worker(*_scene, illumination, table ? &*table : nullptr, options, samplesPerBatch);
        for (std::size_t i = next++; i < points->size(); i = next++)
        {
            if (auto light = worker.receive((*points)[i], receivers[i].towards, i))
                received[i] = std::move(*light);
            else
                finite = false;
            const std::lock_guard<std::mutex> lock(mutex);
            ++done;
            if (options.progress)
                options.progress(done, points->size());
        }
    };
    const int asked = options.threads > 0 ? options.threads
                                          : static_cast<int>(std::thread::hardware_concurrency());
    const int useful = static_cast<int>(std::min<std::size_t>(points->size(), 1024));
    std::vector<std::thread> threads;
    for (int i = 1; i < std::min(asked, useful); ++i)
        threads.emplace_back(work);
    work();
    for (std::thread& thread : threads)
        thread.join();
    if (!finite)
        return invalid("a radiance came out not finite");
    return received;
}

} // namespace osgTerrainLight::reference
