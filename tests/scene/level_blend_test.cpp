// Paged tiles of several levels side by side: their light along common borders, and while levels
// change in a flight. Light is recorded by terrainShading() from straight above, in floats, by a
// camera of its own; which levels are drawn follows the eye of another one.
#include "core/SyntheticTerrain.h"
#include "scene/TileLevels.h"
#include "support/GlContext.h"
#include "support/MemoryRaster.h"
#include "support/ScenePicture.h"
#include "terrain/PagedTerrain.h"

#include <osg/PagedLOD>
#include <osg/Program>
#include <osgDB/DatabasePager>
#include <osgTerrain/TerrainTile>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr int side = 513;        // posts of the raster
constexpr double spacing = 30.0; // [m]
constexpr int cellsLog2 = 5;     // of a tile
constexpr double half = 0.5 * spacing * (side - 1);
constexpr int pixels = 256; // of a side of the record

osg::ref_ptr<PagedTerrain> generated(TerrainKind kind)
{
    const Result<DemTile> tile = generateTerrain(kind, side, side, spacing, 77);
    EXPECT_TRUE(tile);
    MemoryRaster raster;
    raster.width = raster.height = side;
    raster.transform = {500000.0, spacing, 0.0, 4000000.0, 0.0, -spacing};
    raster.values.clear();
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
            raster.values.push_back(1000.0 + double(tile->heightAt(column, row)));
    const std::string path = raster.write();
    addOverviews(path, {2, 4, 8, 16});
    auto source = OverviewSource::open(path, {}, cellsLog2);
    EXPECT_TRUE(source) << source.error().message;
    return new PagedTerrain(std::move(*source), {}, HorizonQuality::Normal);
}

/// A tile that is drawn, in metres from the middle.
struct Drawn
{
    int level = 0;
    double west = 0.0, south = 0.0, size = 0.0;
    const osgTerrain::TerrainTile* tile = nullptr;

    bool has(double east, double north) const
    {
        return east > west && north > south && east < west + size && north < south + size;
    }
    template <class T>
    T uniform(const char* name) const
    {
        T value{};
        const osg::StateSet* stateSet = tile->getStateSet();
        if (const osg::Uniform* uniform = stateSet ? stateSet->getUniform(name) : nullptr)
            uniform->get(value);
        return value;
    }
};

void addDrawn(const osg::Node& node, std::vector<Drawn>& drawn)
{
    if (const auto* tile = dynamic_cast<const osgTerrain::TerrainTile*>(&node))
    {
        const osgTerrain::TileID& id = tile->getTileID();
        const double size = std::ldexp(2.0 * half, -id.level);
        drawn.push_back({id.level, id.x * size - half, id.y * size - half, size, tile});
    }
    else if (const auto* lod = dynamic_cast<const osg::PagedLOD*>(&node))
        addDrawn(*lod->getChild(TileLevels::isRefined(*lod) ? 1 : 0), drawn);
    else if (const osg::Group* group = node.asGroup())
        for (unsigned i = 0; i < group->getNumChildren(); ++i)
            addDrawn(*group->getChild(i), drawn);
}

/// Of a scene whose levels follow an eye that looks north over the terrain.
class Flight
{
public:
    explicit Flight(TerrainKind kind)
    {
        const Result<osg::ref_ptr<osg::Node>> top = generated(kind)->root();
        EXPECT_TRUE(top);
        lighting->addChild(*top);
        root->addChild(lighting);
        osg::ref_ptr<osg::Program> program = new osg::Program;
        program->addShader(createShadingShader(osg::Shader::VERTEX));
        program->addShader(createShadingShader(osg::Shader::FRAGMENT));
        program->addShader(new osg::Shader(osg::Shader::VERTEX, R"(#version 120
varying vec2 place;
vec2 terrainShadingCoordinate(vec4 source);
void main()
{
    place = terrainShadingCoordinate(gl_Vertex);
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
})"));
        program->addShader(new osg::Shader(osg::Shader::FRAGMENT, R"(#version 120
varying vec2 place;
vec4 terrainShading(vec2 coordinate);
void main()
{
    gl_FragColor = terrainShading(place);
})"));
        root->getOrCreateStateSet()->setAttribute(program);
        picture = std::make_unique<ScenePicture>(root, half);
        // OSG names the buffer of a frame buffer object before it has bound that.
        picture->state().setCheckForGLErrors(osg::State::NEVER_CHECK_GL_ERRORS);
        osg::Camera& eye = *picture->viewer().getCamera();
        eye.setProjectionMatrixAsPerspective(110.0, 1.0, 1.0, 1.0e6);
        look(0.0);

        recorder->setGraphicsContext(eye.getGraphicsContext());
        recorder->setViewport(0, 0, pixels, pixels);
        recorder->setRenderTargetImplementation(osg::Camera::FRAME_BUFFER_OBJECT);
        recorder->setRenderOrder(osg::Camera::PRE_RENDER);
        recorder->setDrawBuffer(GL_COLOR_ATTACHMENT0_EXT);
        recorder->setReadBuffer(GL_COLOR_ATTACHMENT0_EXT);
        recorder->setReferenceFrame(osg::Transform::ABSOLUTE_RF);
        recorder->setClearColor(osg::Vec4());
        recorder->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
        recorder->setInheritanceMask(0);
        recorder->setLODScale(1.0e6f); // shows what the eye is shown
        record->allocateImage(pixels, pixels, 1, GL_RGBA, GL_FLOAT);
        record->setInternalTextureFormat(GL_RGBA32F_ARB);
        recorder->attach(osg::Camera::COLOR_BUFFER, record);
        recorder->setViewMatrixAsLookAt(osg::Vec3d(0.0, 0.0, 5.0e5), osg::Vec3d(),
                                        osg::Vec3d(0.0, 1.0, 0.0));
        recordAt(0.0, 0.0, half);
        picture->viewer().addSlave(recorder);
    }

    ~Flight()
    {
        picture->draw(0); // makes the context current
        recorder->releaseGLObjects(&picture->state());
    }

    /// From a place north of the southern edge [m].
    void look(double north)
    {
        const osg::Vec3d eye(-0.3 * half, north - half, 3000.0);
        picture->viewer().getCamera()->setViewMatrixAsLookAt(eye, eye + osg::Vec3d(0.0, 1.0, -0.5),
                                                             osg::Vec3d(0.0, 0.0, 1.0));
    }
    /// All of the terrain is drawn by tiles of a level.
    void showLevel(int level)
    {
        osg::Camera& eye = *picture->viewer().getCamera();
        eye.setProjectionMatrixAsOrtho(-half, half, -half, half, 1.0, 1.0e6);
        eye.setViewMatrixAsLookAt(osg::Vec3d(0.0, 0.0, 5.0e5), osg::Vec3d(),
                                  osg::Vec3d(0.0, 1.0, 0.0));
        // A tile of level 1 has two pixels per cell in the picture. Half way to the next.
        eye.setLODScale(static_cast<float>(std::sqrt(2.0) * std::ldexp(1.0, 1 - level)));
        settle();
        for (const Drawn& tile : drawn())
            EXPECT_EQ(tile.level, level);
    }
    void recordAt(double east, double north, double halfSide)
    {
        recorder->setProjectionMatrixAsOrtho(east - halfSide, east + halfSide, north - halfSide,
                                             north + halfSide, 1.0, 1.0e6);
    }
    void fly(int frames = 1)
    {
        picture->draw(0); // makes the context current
        for (int i = 0; i < frames; ++i)
            picture->viewer().frame(_time += step);
    }
    bool isLoading() const
    {
        const osgDB::DatabasePager& pager = *picture->viewer().getDatabasePager();
        return pager.getRequestsInProgress() || pager.requiresUpdateSceneGraph();
    }
    /// Until nothing is loaded, lit or faded.
    void settle()
    {
        int still = 0;
        for (int frame = 0; frame < 2000 && still < 40; ++frame)
        {
            fly();
            const LightingStatistics now = lighting->getStatistics();
            still = !isLoading() && now.lit == now.tiles ? still + 1 : 0;
            if (isLoading())
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        EXPECT_EQ(still, 40) << "it does not come to rest";
    }
    /// Green; column from the west, row from the south.
    double at(int column, int row) const
    {
        return double(
            reinterpret_cast<const float*>(record->data(unsigned(column), unsigned(row)))[1]);
    }
    std::vector<Drawn> drawn() const
    {
        std::vector<Drawn> all;
        addDrawn(*lighting, all);
        return all;
    }

    static constexpr double step = 1.0 / 32.0; ///< of time [s]
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 8);
    osg::ref_ptr<osg::Group> root = new osg::Group;
    osg::ref_ptr<osg::Camera> recorder = new osg::Camera;
    osg::ref_ptr<osg::Image> record = new osg::Image;
    std::unique_ptr<ScenePicture> picture;

private:
    double _time = 10.0;
};

/// Northern and southern sides of tiles with a coarser one there: places of their middles.
struct Border
{
    double east, north, size;
    bool isSouth;
};
std::vector<Border> bordersOf(const std::vector<Drawn>& all)
{
    std::vector<Border> found;
    for (const Drawn& tile : all)
        for (const bool isSouth : {true, false})
        {
            const double east = tile.west + 0.5 * tile.size;
            const double north = isSouth ? tile.south : tile.south + tile.size;
            for (const Drawn& other : all)
                if (other.level == tile.level - 1 &&
                    other.has(east, north + (isSouth ? -1.0 : 1.0)))
                    found.push_back({east, north, tile.size, isSouth});
        }
    return found;
}

struct Steps
{
    double mean = 0.0, most = 0.0;
    int count = 0;
    void add(double step)
    {
        mean = (mean * count + step) / (count + 1);
        most = std::max(most, step);
        ++count;
    }
};

/// Of light across the row between `row` − 1 and `row`, each side extended to it: light is linear
/// between two posts, which are 8 pixels apart.
void addSteps(const Flight& flight, int row, Steps& steps)
{
    for (int column = 8; column < pixels - 8; ++column)
    {
        const auto at = [&](int away) { return flight.at(column, row + away); };
        steps.add(std::abs(1.5 * at(0) - 0.5 * at(1) - 1.5 * at(-1) + 0.5 * at(-2)));
    }
}
} // namespace

// Expected: both tiles show the same light on their border, that of the coarser level. What is left
// is filtering of textures in steps of 1/256 between two posts. Before, with the borders switched
// off, the step is the difference of the two levels. Inside a tile the row of posts in the middle
// of the band stands for how much light differs there without any border.
TEST(LevelBlend, NoStepShowsBetweenTwoLevels)
{
    OTL_NEED_GL(context);
    for (const TerrainKind kind : {TerrainKind::Cliffs, TerrainKind::Fractal})
    {
        Flight flight(kind);
        flight.look(2000.0);
        flight.settle();
        const std::vector<Border> borders = bordersOf(flight.drawn());
        ASSERT_GE(borders.size(), 4u);
        const osg::ref_ptr<osg::Uniform> off = new osg::Uniform(ShadingTexture::hasBorders, false);
        Steps before, after, inside;
        for (const Border& border : borders)
        {
            flight.recordAt(border.east, border.north, 0.5 * border.size);
            flight.root->getStateSet()->addUniform(off, osg::StateAttribute::OVERRIDE);
            flight.fly();
            addSteps(flight, pixels / 2, before);
            flight.root->getStateSet()->removeUniform(off);
            flight.fly();
            addSteps(flight, pixels / 2, after);
            addSteps(flight, pixels / 2 + (border.isSouth ? 32 : -32), inside);
        }
        std::printf("%s: %zu borders; step of light across them: before mean %.4f, most %.3f; "
                    "after mean %.5f, most %.4f; four posts inside mean %.5f, most %.4f\n",
                    kind == TerrainKind::Cliffs ? "cliffs" : "fractal", borders.size(), before.mean,
                    before.most, after.mean, after.most, inside.mean, inside.most);
        EXPECT_GT(before.mean, 5.0 * after.mean);
        EXPECT_LT(after.mean, 0.002);
    }
}

namespace
{
/// What a flight shows, frame by frame.
struct Recorded
{
    std::vector<std::vector<float>> light;  ///< of each pixel
    std::vector<std::vector<bool>> mayFade; ///< whether its tile fades there, or blends
    std::vector<std::vector<int>> levels;
    std::size_t tiles = 0; ///< at most
};

/// Whether a tile is drawn with some of another light at a place.
bool fadesAt(const Drawn& tile, double east, double north)
{
    if (tile.uniform<float>(ShadingTexture::formerPart) > 0.0f)
        return true;
    const double band = 8.0 / (1 << cellsLog2) * tile.size;
    const auto sides = tile.uniform<osg::Vec4f>(ShadingTexture::borders);
    const auto corners = tile.uniform<osg::Vec4f>(ShadingTexture::borderCorners);
    const bool isWest = east - tile.west < band, isSouth = north - tile.south < band;
    const bool isEast = tile.west + tile.size - east < band;
    const bool isNorth = tile.south + tile.size - north < band;
    return tile.uniform<bool>(ShadingTexture::hasBorders) &&
           ((isWest && sides[0] > 0.0f) || (isSouth && sides[1] > 0.0f) ||
            (isEast && sides[2] > 0.0f) || (isNorth && sides[3] > 0.0f) ||
            (isSouth && isWest && corners[0] > 0.0f) || (isSouth && isEast && corners[1] > 0.0f) ||
            (isNorth && isWest && corners[2] > 0.0f) || (isNorth && isEast && corners[3] > 0.0f));
}

/// There and back.
Recorded fly(Flight& flight, int frames)
{
    Recorded recorded;
    for (int frame = 0; frame <= frames; ++frame)
    {
        flight.look(9000.0 * (1.0 - std::abs(2.0 * frame / frames - 1.0)));
        flight.fly();
        std::this_thread::sleep_for(std::chrono::milliseconds(2)); // of the pager's threads
        std::vector<float> light(pixels * pixels);
        std::vector<bool> mayFade(pixels * pixels);
        std::vector<int> levels(pixels * pixels);
        const std::vector<Drawn> all = flight.drawn();
        recorded.tiles = std::max(recorded.tiles, all.size());
        for (const Drawn& tile : all)
        {
            const auto pixelOf = [](double place)
            { return static_cast<int>(std::lround((place + half) / (2.0 * half) * pixels)); };
            for (int row = pixelOf(tile.south); row < pixelOf(tile.south + tile.size); ++row)
                for (int column = pixelOf(tile.west); column < pixelOf(tile.west + tile.size);
                     ++column)
                {
                    const auto i = static_cast<std::size_t>(row * pixels + column);
                    const auto placeOf = [](int pixel)
                    { return (pixel + 0.5) / pixels * 2.0 * half - half; };
                    light[i] = static_cast<float>(flight.at(column, row));
                    mayFade[i] = fadesAt(tile, placeOf(column), placeOf(row));
                    levels[i] = tile.level;
                }
        }
        recorded.light.push_back(std::move(light));
        recorded.mayFade.push_back(std::move(mayFade));
        recorded.levels.push_back(std::move(levels));
    }
    return recorded;
}

/// By how much the light of the levels differs in each pixel.
std::vector<float> rangesOf(Flight& flight)
{
    std::vector<float> low(pixels * pixels, 1.0e6f), high(pixels * pixels);
    for (int level = 0; level <= 4; ++level)
    {
        flight.showLevel(level);
        for (int i = 0; i < pixels * pixels; ++i)
        {
            const auto light = static_cast<float>(flight.at(i % pixels, i / pixels));
            low[std::size_t(i)] = std::min(low[std::size_t(i)], light);
            high[std::size_t(i)] = std::max(high[std::size_t(i)], light);
        }
    }
    std::transform(high.begin(), high.end(), low.begin(), low.begin(), std::minus<>());
    return low;
}

/// Changes of pixels from one frame to the next.
struct Changes
{
    long long over = 0;      ///< by more than 2 %
    long long elsewhere = 0; ///< of these where no tile fades or blends, before or after
    long long sudden = 0;    ///< of these beyond a frame's share of the levels' difference
    long long levels = 0;    ///< changes of a pixel's level
    double most = 0.0, mostOfRange = 0.0;
};
Changes changesOf(const Recorded& recorded, const std::vector<float>& ranges, int fade)
{
    Changes changes;
    for (std::size_t i = 0; i < std::size_t(pixels * pixels); ++i)
    {
        for (std::size_t frame = 1; frame < recorded.light.size(); ++frame)
        {
            const float before = recorded.light[frame - 1][i], after = recorded.light[frame][i];
            changes.levels += recorded.levels[frame - 1][i] != recorded.levels[frame][i];
            const double change = std::abs(double(after) - double(before));
            const double part = change / std::max({double(before), double(after), 1.0e-3});
            if (part <= 0.02)
                continue;
            const double ofRange = change / std::max(double(ranges[i]), 1.0e-3);
            ++changes.over;
            changes.most = std::max(changes.most, part);
            changes.mostOfRange = std::max(changes.mostOfRange, ofRange);
            if (!recorded.mayFade[frame - 1][i] && !recorded.mayFade[frame][i])
                ++changes.elsewhere;
            if (ofRange > 1.02 / fade)
                ++changes.sudden;
        }
    }
    return changes;
}
} // namespace

// Expected: while levels come and go below a flight, the light of a pixel changes by more than 2 %
// from one frame to the next only where its tile fades, or blends with a neighbour that does, and
// then by no more than a frame's share of the fade, of what the lights of all levels differ by
// there. 2 % of that share are for textures' filtering and halves.
TEST(LevelBlend, AFlightChangesLightOverTheFadeOnly)
{
    OTL_NEED_GL(context);
    constexpr int frames = 120, fade = 16;
    const std::vector<float> ranges = rangesOf(*std::make_unique<Flight>(TerrainKind::Cliffs));
    Flight flight(TerrainKind::Cliffs);
    flight.lighting->setTimeBudget(20.0);
    flight.lighting->setFadeSeconds(fade * Flight::step);
    flight.settle();
    const Recorded recorded = fly(flight, frames);
    const Changes changes = changesOf(recorded, ranges, fade);
    std::printf("fade of %d frames: %zu tiles drawn at most, %lld changes of level in a pixel; "
                "light changes by more than 2 %% in %lld of %d pixels and frames, at most by "
                "%.0f %%, at most by %.2f %% of the levels' difference; %lld where no tile fades, "
                "%lld beyond the fade\n",
                fade, recorded.tiles, changes.levels, changes.over, frames * pixels * pixels,
                100.0 * changes.most, 100.0 * changes.mostOfRange, changes.elsewhere,
                changes.sudden);
    EXPECT_GT(changes.levels, pixels * pixels / 2);
    EXPECT_GT(changes.over, 1000);
    EXPECT_EQ(changes.elsewhere, 0);
    EXPECT_EQ(changes.sudden, 0);
    EXPECT_GT(changesOf(recorded, ranges, fade + 2).sudden, 1000) << "a shorter fade is seen";
}
