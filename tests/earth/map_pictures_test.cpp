// What maps look like: pictures of the maps in earth_files from above, north up.
#include "io/EarthFile.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
const std::string folder = OTL_SOURCE_DIR "/earth_files";
constexpr int side = ScenePicture::size;
constexpr double halfSide = 16000.0; // the terrain is 30 km by 32 km

using Pixels = std::vector<unsigned char>; // RGBA, row 0 south

Pixels pictureOf(const Result<EarthMap>& map)
{
    EXPECT_TRUE(map) << (map ? "" : map.error().message);
    const Result<TerrainModel> model =
        map ? loadMap(*map, folder, "map") : Result<TerrainModel>(map.error());
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    if (!model)
        return Pixels(4 * side * side);
    model->node->setTimeBudget(0.0);
    LightingSettings settings = model->node->getSettings();
    settings.azimuths = 8; // for the sake of speed
    model->node->setSettings(settings);
    ScenePicture picture(model->node, halfSide);
    picture.draw(4);
    return picture.pixels();
}

/// Whether terrain is drawn there: the background is blue.
bool isDrawn(const Pixels& pixels, std::size_t i)
{
    return pixels[i] != 0 || pixels[i + 1] != 0 || pixels[i + 2] != 255;
}

/// How many pixels differ by more than `tolerance` in a channel.
int differing(const Pixels& one, const Pixels& other, int tolerance)
{
    int count = 0;
    for (std::size_t i = 0; i < one.size(); i += 4)
    {
        int most = 0;
        for (std::size_t channel = 0; channel < 3; ++channel)
            most = std::max(most, std::abs(one[i + channel] - other[i + channel]));
        count += most > tolerance ? 1 : 0;
    }
    return count;
}

const std::string heights = "<elevation driver='gdal' url='../samples/data/jacksboro_90m.tif'/>";
const std::string colours = "<image driver='gdal' url='../samples/data/jacksboro_colour.tif'/>";
const std::string cone = "<elevation driver='gdal' url='data/cone.tif'/>";
} // namespace

// Expected: the picture of a map of plain layers that says the same. Rounding of heights in feet,
// and of heights that are drawn 30 m lower, may move a channel by 2 of 255.
TEST(MapPictures, FeaturesAndTheSameInPlainLayers)
{
    OTL_NEED_GL(context);
    const struct
    {
        const char* map;
        std::string same;
    } pairs[] = {
        {"any_case.earth", heights + "<terrain_light sun_azimuth='300' sun_elevation='25'/>"},
        {"elevation_only.earth", heights},
        {"switches.earth", heights},
        {"levels.earth", heights + colours},
        {"profile.earth", heights},
        {"skipped.earth", heights},
        {"vertical_datum.earth", heights},
        {"windows_paths.earth", heights + colours},
        {"composite.earth", heights + cone + colours},
        {"virtual_raster.earth", heights + cone},
        {"geopackage.earth", heights + cone},
        {"sky.earth", heights + "<terrain_light time='2024-06-20T19:30Z'/>"},
        {"viewpoints.earth", heights},
        {"tms.earth", heights + "<XYZImage url='data/tiles/{z}/{x}/{y}.png'/>"}};
    for (const auto& [map, same] : pairs)
    {
        const Pixels found = pictureOf(readEarthFile(folder + "/" + map));
        const Pixels wanted = pictureOf(parseEarth("<map>" + same + "</map>", "same"));
        EXPECT_EQ(differing(found, wanted, 2), 0) << map;
        int drawn = 0;
        for (std::size_t i = 0; i < found.size(); i += 4)
            drawn += isDrawn(found, i) ? 1 : 0;
        EXPECT_GT(drawn, side * side * 8 / 10) << map; // 30 of 32 km by 32 of 32 km
    }
}

// Expected: where the layer lies the picture is another one than without it, and elsewhere the
// same. The cone has its axis at 746000, 4054000 in UTM, -361 m east and 1134 m north of the middle
// of the terrain, and a foot of 2000 m; its shadow is no longer than 1400 m over the tangent of 35
// degrees, and the terrain around it is drawn of another grid.
TEST(MapPictures, AConeOverHeights)
{
    OTL_NEED_GL(context);
    const Pixels with = pictureOf(readEarthFile(folder + "/virtual_raster.earth"));
    const Pixels without = pictureOf(readEarthFile(folder + "/elevation_only.earth"));
    int onCone = 0, changed = 0, far = 0, changedFar = 0;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
        {
            const double x = ((column + 0.5) / side * 2.0 - 1.0) * halfSide;
            const double y = ((row + 0.5) / side * 2.0 - 1.0) * halfSide;
            const double distance = std::hypot(x + 361.0, y - 1134.0);
            const auto i = static_cast<std::size_t>(4 * (row * side + column));
            const bool differs = std::abs(with[i] - without[i]) > 12;
            (distance < 1800.0 ? onCone : far) += distance < 1800.0 || distance > 5000.0 ? 1 : 0;
            changed += distance < 1800.0 && differs ? 1 : 0;
            changedFar += distance > 5000.0 && differs ? 1 : 0;
        }
    EXPECT_GT(changed, onCone * 7 / 10) << onCone;
    EXPECT_LT(changedFar, far / 10) << far;
}

// Expected: half of the colours over white is paler at every place, and MBTiles, which are coarser
// and in another projection, have the same colours in the mean, within 3 of 255.
TEST(MapPictures, Colours)
{
    OTL_NEED_GL(context);
    const Pixels full = pictureOf(parseEarth("<map>" + heights + colours + "</map>", "full"));
    const Pixels pale = pictureOf(readEarthFile(folder + "/opacity.earth"));
    const Pixels tiles = pictureOf(readEarthFile(folder + "/mbtiles.earth"));
    double ofFull = 0.0, ofTiles = 0.0;
    int paler = 0, drawn = 0;
    for (std::size_t i = 0; i < full.size(); i += 4)
    {
        if (!isDrawn(full, i) || !isDrawn(tiles, i))
            continue;
        ++drawn;
        paler += pale[i + 2] > full[i + 2] ? 1 : 0; // the ramp has the least of blue
        ofFull += full[i];
        ofTiles += tiles[i];
    }
    ASSERT_GT(drawn, side * side * 8 / 10);
    EXPECT_GT(paler, drawn * 98 / 100);
    EXPECT_NEAR(ofTiles / drawn, ofFull / drawn, 3.0);
    EXPECT_GT(differing(full, pictureOf(readEarthFile(folder + "/elevation_only.earth")), 12),
              drawn / 2);
}

// Expected: the three squares in their corners, by the channel that is the greatest in each (red
// north-west, blue south-east, green south-west), and grey where the fourth is missing. Light is
// nearly as white as the sun's, whose channels are 3, 2.85 and 2.6.
TEST(MapPictures, SquaresOfTiles)
{
    OTL_NEED_GL(context);
    for (const char* map : {"tiles.earth", "tms.earth"})
    {
        const Pixels pixels = pictureOf(readEarthFile(folder + "/" + map));
        const auto meanAt = [&](double x, double y, std::size_t channel)
        {
            double sum = 0.0;
            for (int row = -6; row <= 6; ++row)
                for (int column = -6; column <= 6; ++column)
                {
                    const int i = static_cast<int>((0.5 + 0.5 * x) * side) + column;
                    const int j = static_cast<int>((0.5 + 0.5 * y) * side) + row;
                    sum += pixels[static_cast<std::size_t>(4 * (j * side + i)) + channel];
                }
            return sum / 169.0;
        };
        const auto share = [&](double x, double y, std::size_t channel)
        { return meanAt(x, y, channel) / (meanAt(x, y, 0) + meanAt(x, y, 1) + meanAt(x, y, 2)); };
        EXPECT_GT(share(-0.83, 0.5, 0), 0.42) << map;
        EXPECT_GT(share(0.4, -0.5, 2), 0.4) << map;
        EXPECT_GT(share(-0.83, -0.5, 1), 0.42) << map;
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(share(0.4, 0.5, channel), 1.0 / 3.0, 0.03) << map;
    }
}
