#include "lighting/nodes/BounceRays.h"

#include "core/AzimuthSet.h"
#include "gpu/Textures.h"
#include "lighting/nodes/GridDirection.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr std::size_t maxAzimuths = 256; // the sizes of what bounce.comp declares
constexpr std::size_t maxSamples = 128;
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

BounceRays::BounceRays(const PyramidNode& pyramid, const BounceScheme& scheme, int azimuths)
    : _pyramid(&pyramid),
      _cells(PyramidLayout::ofCells(pyramid.surface().width() - 1, pyramid.surface().height() - 1)),
      _azimuths(azimuths),
      _samples(bounceSamples(
          scheme, std::max(pyramid.surface().width(), pyramid.surface().height()) - 1,
          static_cast<int>(std::min(pyramid.layout().levels.size(), _cells.levels.size())))),
      _stepLengths(own(new Resource("step lengths", [this] { return createStepLengths(); })))
{
}

osg::ref_ptr<osg::Texture> BounceRays::createStepLengths() const
{
    const DemTile& tile = _pyramid->surface().tile();
    const AzimuthSet set(_azimuths);
    Raster<float> lengths(_azimuths, tile.height());
    for (int k = 0; k < _azimuths; ++k)
    {
        const GridDirection grid(tile, set.direction(k));
        for (int row = 0; row < tile.height(); ++row)
            lengths.at(k, row) =
                static_cast<float>(grid.stepLength(tile.eastSpacing(row), tile.northSpacing));
    }
    return createFloatTexture(lengths);
}

void BounceRays::bind(GpuPass& pass) const
{
    const TileSurface& surface = _pyramid->surface();
    const AzimuthSet set(_azimuths);
    std::vector<osg::Vec4f> rays(maxAzimuths + maxSamples); // directions, then samples
    for (int k = 0; k < _azimuths; ++k)
    {
        const GridDirection grid(surface.tile(), set.direction(k));
        rays[static_cast<std::size_t>(k)].set(static_cast<float>(grid.drift),
                                              static_cast<float>(grid.look),
                                              grid.north ? 1.0f : 0.0f, 0.0f);
    }
    for (std::size_t i = 0; i < _samples.size(); ++i)
        rays[maxAzimuths + i].set(
            static_cast<float>(_samples[i].distance), static_cast<float>(_samples[i].level),
            static_cast<float>(_samples[i].between), static_cast<float>(_samples[i].radianceLevel));
    const auto count = [this](const auto& which)
    { return static_cast<int>(std::count_if(_samples.begin(), _samples.end(), which)); };
    surface.bind(pass);
    pass.setBlock(rays);
    pass.set("azimuths", _azimuths);
    pass.set("sampleCount", static_cast<int>(_samples.size()));
    pass.set("nearCount", count([](const BounceSample& sample) { return sample.level == 0; }));
    pass.set("exact", count([](const BounceSample& sample)
                            { return sample.level == 0 && sample.distance <= 2.0; }));
    setLevels(pass, "heightLevels", _pyramid->layout());
    setLevels(pass, "radianceLevels", _cells);
    pass.reads("stepLengths", _stepLengths);
    pass.reads("heightPyramid", _pyramid->pyramid());
}

} // namespace osgTerrainLight
