#include "support/Horizons.h"

#include "support/SharedData.h"

#include "core/Raster.h"
#include "io/DemReader.h"
#include "lighting/TileLight.h"
#include "reference/ExhaustiveHorizon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>

namespace osgTerrainLight::testing
{

HorizonMap gpuHorizons(osg::State& state, const DemTile& tile, int azimuths, HorizonQuality quality)
{
    LightingSettings settings;
    settings.azimuths = azimuths;
    settings.quality = quality;
    SkyLight sky;
    sky.sunEnabled = false;
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
    return lighting->readHorizons(state);
}

Raster<float> gpuSunFraction(osg::State& state, const DemTile& tile, double azimuth,
                             double elevation, HorizonQuality quality, double angularRadius)
{
    LightingSettings settings;
    settings.quality = quality;
    SkyLight sky;
    sky.skyEnabled = false;
    sky.sunAzimuth = azimuth;
    sky.sunElevation = elevation;
    sky.sunAngularRadius = angularRadius;
    osg::ref_ptr<TileLight> lighting = new TileLight(tile, settings, sky);
    const Status done = lighting->update(state);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
    const Raster<osg::Vec4f> shading = lighting->readShading(state);
    Raster<float> fraction(tile.width(), tile.height());
    for (std::size_t i = 0; i < fraction.size(); ++i)
        fraction.values()[i] = shading.values()[i].a();
    return fraction;
}

std::optional<DemTile> realDem(const std::string& name)
{
    for (const std::string& folder :
         {std::string(OTL_SOURCE_DIR) + "/samples/data", std::string(OTL_SHARED_DIR) + "/data/dem"})
    {
        const std::string path = folder + "/" + name;
        if (!std::filesystem::exists(path))
            continue;
        Result<DemFile> file = readDem(path);
        EXPECT_TRUE(file) << (file ? "" : file.error().message);
        if (file)
            return file->tile;
    }
    return std::nullopt;
}

std::string HorizonError::text() const
{
    char line[320];
    std::snprintf(
        line, sizeof(line),
        "mean %.4f p99 %.3f bias %+.4f degrees; worst %.2f at post (%d, %d) azimuth %.1f, "
        "reference %.2f degrees by a point %.0f m away",
        mean, p99, bias, worst, worstColumn, worstRow, worstCompass, worstExpected, worstDistance);
    return line;
}

HorizonError compareWithReference(const DemTile& tile, const HorizonMap& map, int posts)
{
    const AzimuthSet azimuths(map.azimuthCount());
    reference::HorizonOptions options;
    options.highest = reference::highestPost(tile);
    std::mt19937 random(20261122);
    std::vector<double> errors;
    HorizonError result;
    result.byIndex.assign(static_cast<std::size_t>(map.azimuthCount()), 0.0);
    while (errors.size() < static_cast<std::size_t>(posts) * result.byIndex.size())
    {
        const int column = static_cast<int>(random() % static_cast<unsigned>(tile.width()));
        const int row = static_cast<int>(random() % static_cast<unsigned>(tile.height()));
        if (!tile.isValid(column, row))
            continue;
        for (int k = 0; k < map.azimuthCount(); ++k)
        {
            const reference::Horizon expected =
                reference::exhaustiveHorizon(tile, column, row, azimuths.direction(k), options);
            const double difference = std::max(map.elevationAt(column, row, k), 0.0) -
                                      std::max(expected.elevationDegrees(), 0.0);
            errors.push_back(std::abs(difference));
            result.bias += difference;
            result.byIndex[static_cast<std::size_t>(k)] += std::abs(difference) / posts;
            if (std::abs(difference) > result.worst)
            {
                result.worst = std::abs(difference);
                result.worstColumn = column;
                result.worstRow = row;
                for (int band = 0; band < map.azimuthCount(); ++band)
                    if (azimuths.indexOfBand(band) == k)
                        result.worstCompass = azimuths.compassDegreesOfBand(band);
                result.worstExpected = expected.elevationDegrees();
                result.worstDistance = expected.distance;
            }
        }
    }
    std::sort(errors.begin(), errors.end());
    for (double error : errors)
        result.mean += error / static_cast<double>(errors.size());
    result.bias /= static_cast<double>(errors.size());
    result.p99 = errors[errors.size() * 99 / 100];
    return result;
}

} // namespace osgTerrainLight::testing
