#include "lighting/nodes/BounceRays.h"

#include "lighting/nodes/AzimuthRays.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr std::size_t maxSamples = 128; // as gloss.comp declares it
} // namespace

BounceScheme BounceScheme::of(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return {4.0, 4.0};
    case HorizonQuality::Best:
        return {16.0, 8.0};
    default:
        return {8.0, 5.0};
    }
}

std::vector<BounceSample> bounceSamples(const BounceScheme& scheme, int reach, int levelCount)
{
    const auto levelAt = [&](double distance)
    {
        return std::clamp(static_cast<int>(std::floor(std::log2(distance) - scheme.offset + 0.5)),
                          0, levelCount - 1);
    };
    std::vector<BounceSample> samples;
    const double ratio = std::exp2(1.0 / scheme.samplesPerOctave);
    double last = 0.0;
    for (double distance = 1.0; distance <= reach;)
    {
        const int level = levelAt(distance);
        const double place = level == 0 ? std::round(distance) : distance;
        const double between = 0.5 * (last + place);
        // Samples that read posts come first, and all of them read cells.
        samples.push_back({place, level, between, level == 0 ? 0 : std::max(1, levelAt(between))});
        last = place;
        distance = std::max(distance * ratio, place + 1.0);
    }
    if (samples.size() > maxSamples)
        return bounceSamples({scheme.samplesPerOctave * 0.9, scheme.offset}, reach, levelCount);
    return samples;
}

BounceRays::BounceRays(const PyramidNode& pyramid, const BounceScheme& scheme, int azimuths,
                       Resource* stepLengths)
    : _pyramid(&pyramid),
      _cells(PyramidLayout::ofCells(pyramid.surface().width() - 1, pyramid.surface().height() - 1)),
      _azimuths(azimuths),
      _samples(bounceSamples(
          scheme, std::max(pyramid.surface().width(), pyramid.surface().height()) - 1,
          static_cast<int>(std::min(pyramid.layout().levels.size(), _cells.levels.size())))),
      _stepLengths(own(stepLengths))
{
}

void BounceRays::bind(GpuPass& pass) const
{
    const TileSurface& surface = _pyramid->surface();
    std::vector<osg::Vec4f> rays = azimuthRays(surface, _azimuths); // then samples
    rays.resize(maxAzimuths + maxSamples);
    for (std::size_t i = 0; i < _samples.size(); ++i)
        rays[maxAzimuths + i].set(
            static_cast<float>(_samples[i].distance), static_cast<float>(_samples[i].level),
            static_cast<float>(_samples[i].between), static_cast<float>(_samples[i].radianceLevel));
    surface.bind(pass);
    pass.setBlock(rays);
    pass.set("azimuths", _azimuths);
    pass.set("sampleCount", static_cast<int>(_samples.size()));
    setLevels(pass, "heightLevels", _pyramid->layout());
    setLevels(pass, "radianceLevels", _cells);
    pass.reads("stepLengths", _stepLengths);
    pass.reads("heightPyramid", _pyramid->pyramid());
}

} // namespace osgTerrainLight
