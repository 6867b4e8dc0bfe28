// Tiles that are drawn with former light until their own is there, and fade: a new tile with that
// of a tile above it, a tile that is lit anew with its own.
#include <osgTerrainLight/TerrainLighting.h>

#include "scene/LitTile.h"
#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "support/TestFolder.h"
#include "terrain/TerrainModel.h"

#include <osg/MatrixTransform>
#include <osg/Switch>
#include <osgDB/ReadFile>
#include <osgDB/WriteFile>
#include <osgTerrain/Layer>
#include <osgTerrain/TerrainTile>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr double reach = 320.0; // [m]
// Steps of a tile's work (horizon, sky, sun, shade), of which a short budget runs one per frame.
constexpr int steps = 4;

/// A tile with a TileID, moved.
osg::ref_ptr<osg::MatrixTransform> placed(const DemTile& dem, const osgTerrain::TileID& id,
                                          double east, double north)
{
    osg::ref_ptr<osg::Node> terrain = createTerrain(dem);
    dynamic_cast<osgTerrain::TerrainTile&>(*terrain->asGroup()->getChild(0)).setTileID(id);
    osg::ref_ptr<osg::MatrixTransform> place =
        new osg::MatrixTransform(osg::Matrix::translate(east, north, 0.0));
    place->addChild(terrain);
    return place;
}

osgTerrain::TerrainTile& tileOf(osg::MatrixTransform& place)
{
    return dynamic_cast<osgTerrain::TerrainTile&>(*place.getChild(0)->asGroup()->getChild(0));
}

/// 640 m of a cone about the origin.
osg::ref_ptr<osg::MatrixTransform> above()
{
    return placed(analytic::cone(33, 33, 20.0, 16, 16, 200.0, 300.0), {1, 0, 0}, 0.0, 0.0);
}

/// Level ground in its north-eastern quarter, or a tile of `across` metres there.
osg::ref_ptr<osg::MatrixTransform> below(const osgTerrain::TileID& id = {2, 1, 1},
                                         double across = reach)
{
    return placed(analytic::plane(33, 33, across / 32.0, 0.0), id, across / 2.0, across / 2.0);
}

double linear(unsigned char value)
{
    const double c = value / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double encoded(double c)
{
    return 255.0 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055);
}

using Pixels = std::vector<unsigned char>;

/// Greatest difference of a picture's red, in the north-eastern quarter without its outermost
/// pixels, from expected(place in the picture).
template <class F>
double farthest(const Pixels& found, F&& expected)
{
    constexpr int size = ScenePicture::size;
    double most = 0.0;
    for (int row = size / 2 + 2; row < size - 2; ++row)
        for (int column = size / 2 + 2; column < size - 2; ++column)
        {
            const auto at = static_cast<std::size_t>(4 * (row * size + column));
            most = std::max(most, std::abs(found[at] - expected(at)));
        }
    return most;
}
double difference(const Pixels& a, const Pixels& b)
{
    return farthest(a, [&](std::size_t at) { return static_cast<double>(b[at]); });
}
/// Of a picture from the mixture of two others.
double fromMixture(const Pixels& found, const Pixels& from, const Pixels& to, double part)
{
    return farthest(found, [&](std::size_t at)
                    { return encoded((1.0 - part) * linear(from[at]) + part * linear(to[at])); });
}

/// A scene drawn with a fixed time per frame.
class Flight
{
public:
    static constexpr double step = 0.125; ///< [s]; four make a fade of 0.5 s

    Flight() : lighting(lightingWithBudget(0.0, 8)), picture(lighting, reach) {}

    void fly(int count = 1)
    {
        picture.draw(0); // makes the context current
        for (int i = 0; i < count; ++i)
        {
            if (_slow >= 0)
                lighting->setTimeBudget(_slow-- > 0 ? 1.0e-6 : 0.0);
            picture.viewer().frame(_time += step);
        }
        picture.draw(0);
    }
    const Pixels& pixels() const { return picture.pixels(); }

    /// Shows one tile above until it is lit; the picture of it.
    Pixels begin()
    {
        _parent = new osg::Switch;
        _parent->addChild(above());
        lighting->addChild(_parent);
        fly(4);
        return pixels();
    }
    /// The tile above stays in the scene, as below a PagedLOD, and is not drawn.
    void replace(osg::Node* child)
    {
        _parent->setAllChildrenOff();
        lighting->addChild(child);
        slowDown();
    }
    /// Light that is computed now is whole after so many frames as it has `steps`.
    void slowDown() { _slow = steps - 1; }
    /// It is whole in the next frame.
    void hurry()
    {
        _slow = -1;
        lighting->setTimeBudget(0.0);
    }
    void forgetParent()
    {
        lighting->removeChild(_parent);
        _parent = nullptr;
    }

    osg::ref_ptr<TerrainLighting> lighting;
    ScenePicture picture;

private:
    osg::ref_ptr<osg::Switch> _parent;
    double _time = 10.0;
    int _slow = -1; ///< frames with a piece of light each, before one with all the rest
};

osg::StateAttribute* textureOf(osg::MatrixTransform& place, unsigned unit)
{
    return tileOf(place).getStateSet()->getTextureAttribute(unit, osg::StateAttribute::TEXTURE);
}

/// The picture of level ground: alone, or lit with the tile above around it, which is never drawn.
Pixels ofItself(const SkyLight& sky = {}, bool isAlone = false)
{
    Flight alone;
    alone.lighting->setSkyLight(sky);
    const osg::ref_ptr<osg::Switch> parent = new osg::Switch;
    parent->addChild(above(), false);
    if (!isAlone)
        alone.lighting->addChild(parent);
    alone.lighting->addChild(below());
    alone.fly(4);
    return alone.pixels();
}
} // namespace

// Expected: from the first frame on, the picture of the tile above: its texture is bilinear, and
// the ground is seen from straight above. 1 of 255 for the rounding of places. Then mixtures, by
// the share of the fade that has passed; 2 for three pictures' rounding. Then the picture of the
// tile itself, to the last bit, since nothing of the former light is read.
TEST(TileFade, ANewTileBeginsWithTheLightAboveAndFades)
{
    OTL_NEED_GL(context);
    const Pixels own = ofItself();
    Flight flight;
    const Pixels from = flight.begin();
    ASSERT_GT(difference(from, own), 40.0) << "there is something to fade";
    const auto child = below();
    flight.replace(child);
    const TileHandle handle = flight.lighting->getTileHandle(&tileOf(*child));
    for (int frame = 1; frame <= steps; ++frame)
    {
        flight.fly();
        EXPECT_LE(difference(flight.pixels(), from), 1.0) << frame;
        EXPECT_EQ(flight.lighting->getTileState(handle).stage,
                  frame < steps ? TileState::Stage::Waiting : TileState::Stage::Lit);
    }
    EXPECT_TRUE(textureOf(*child, ShadingTexture::formerUnit));
    for (const double part : {0.0, 0.25, 0.5, 0.75})
    {
        flight.fly();
        EXPECT_LE(fromMixture(flight.pixels(), from, own, part), 2.0) << part;
    }
    flight.fly();
    EXPECT_EQ(difference(flight.pixels(), own), 0.0);
    EXPECT_FALSE(textureOf(*child, ShadingTexture::formerUnit));
    EXPECT_EQ(tileOf(*child).getStateSet()->getTextureAttributeList().size(),
              ShadingTexture::defaultUnit + 1u);
    EXPECT_EQ(takeGlErrors(), "");
}

namespace
{
/// Mean red about a place, as ScenePicture::redAt().
double redIn(const Pixels& pixels, double x, double y)
{
    constexpr int size = ScenePicture::size;
    const auto pixel = [](double place)
    { return static_cast<int>(std::lround((0.5 + 0.5 * place) * (size - 1))); };
    double sum = 0.0;
    for (int j = -3; j <= 3; ++j)
        for (int i = -3; i <= 3; ++i)
            sum += pixels.at(static_cast<std::size_t>(4 * ((pixel(y) + j) * size + pixel(x) + i)));
    return sum / 49.0;
}

/// In the south-western quarter of the quarter.
double differenceInQuarter(const Pixels& a, const Pixels& b)
{
    double most = 0.0;
    for (const double place : {0.1, 0.25, 0.4})
        most =
            std::max(most, std::abs(redIn(a, place, 0.5 - place) - redIn(b, place, 0.5 - place)));
    return most;
}
} // namespace

// Expected: as above with a tile of a quarter of the side, whose own parent is not there.
TEST(TileFade, TheNearestTileAboveCounts)
{
    OTL_NEED_GL(context);
    Flight flight;
    const Pixels from = flight.begin();
    flight.replace(below({3, 2, 2}, reach / 2.0));
    flight.fly();
    EXPECT_LE(differenceInQuarter(flight.pixels(), from), 1.0);
}

// Expected: below a tile that fades, the light that has the larger part there; 1 as above.
TEST(TileFade, BelowATileThatFadesTheNearerLightCounts)
{
    OTL_NEED_GL(context);
    const Pixels own = ofItself();
    for (const bool early : {true, false})
    {
        Flight flight;
        const Pixels from = flight.begin();
        ASSERT_GT(differenceInQuarter(own, from), 10.0);
        const osg::ref_ptr<osg::Switch> middle = new osg::Switch;
        middle->addChild(below());
        flight.replace(middle);
        flight.fly(steps + (early ? 1 : 3)); // the last drew parts of 0 or 0.5
        middle->setAllChildrenOff();
        flight.lighting->addChild(below({3, 2, 2}, reach / 2.0));
        flight.fly(); // of 0.25 or 0.75, had it been drawn
        EXPECT_LE(differenceInQuarter(flight.pixels(), early ? from : own), 1.0);
    }
}

namespace
{
/// A geocentric tile about 10 degrees east and 60 north, moved to the origin: extents in parts of
/// half of the tile above, −1 … 1.
osg::ref_ptr<osg::MatrixTransform> onGlobe(const DemTile& dem, const osgTerrain::TileID& id,
                                           double west, double south)
{
    const osg::EllipsoidModel body;
    const double longitude = osg::DegreesToRadians(10.0), latitude = osg::DegreesToRadians(60.0);
    osg::Matrixd toWorld;
    body.computeLocalToWorldTransformFromLatLongHeight(latitude, longitude, 0.0, toWorld);
    // Radians per metre: near enough for 320 m, since both tiles have the same error.
    const double north = reach / 6382000.0;
    const double east = reach / (6394000.0 * std::cos(latitude));
    osg::ref_ptr<osgTerrain::Locator> locator = new osgTerrain::Locator;
    locator->setCoordinateSystemType(osgTerrain::Locator::GEOCENTRIC);
    locator->setTransformAsExtents(longitude + west * east, latitude + south * north,
                                   longitude + east, latitude + north);
    const osg::ref_ptr<osg::Node> terrain = createTerrain(dem);
    auto& tile = dynamic_cast<osgTerrain::TerrainTile&>(*terrain->asGroup()->getChild(0));
    tile.setUserData(nullptr); // it knows a flat place
    tile.setTileID(id);
    tile.setLocator(locator);
    tile.getElevationLayer()->setLocator(locator);
    osg::ref_ptr<osg::MatrixTransform> place =
        new osg::MatrixTransform(osg::Matrixd::inverse(toWorld));
    osg::ref_ptr<osg::Group> group = new osg::Group;
    group->addChild(&tile);
    place->addChild(group);
    return place;
}
} // namespace

// Expected: as for projected tiles. The way from tile to tile is affine in longitude and latitude.
TEST(TileFade, ANewTileOfAGlobeBeginsWithTheLightAbove)
{
    OTL_NEED_GL(context);
    Flight flight;
    osg::ref_ptr<osg::Switch> parent = new osg::Switch;
    parent->addChild(
        onGlobe(analytic::cone(33, 33, 20.0, 16, 16, 200.0, 300.0), {1, 0, 0}, -1.0, -1.0));
    flight.lighting->addChild(parent);
    flight.fly(4);
    const Pixels from = flight.pixels();
    const auto child = onGlobe(analytic::plane(33, 33, 10.0, 0.0), {2, 1, 1}, 0.0, 0.0);
    parent->setAllChildrenOff();
    flight.lighting->addChild(child);
    flight.lighting->setTimeBudget(1.0e-6);
    flight.fly();
    EXPECT_TRUE(textureOf(*child, ShadingTexture::formerUnit));
    EXPECT_LE(difference(flight.pixels(), from), 1.0);
    flight.hurry();
    flight.fly(6);
    EXPECT_GT(difference(flight.pixels(), from), 40.0);
}

// Expected: the light above does not go with its tile before the fade is over, and then does: its
// texture is not in OpenGL any more.
TEST(TileFade, LightAboveIsKeptAsLongAsItFades)
{
    OTL_NEED_GL(context);
    Flight flight;
    const Pixels from = flight.begin();
    osg::observer_ptr<osg::Texture2D> light;
    unsigned id = 0;
    {
        const auto* lit = dynamic_cast<osg::Switch*>(flight.lighting->getChild(0));
        auto* place = dynamic_cast<osg::MatrixTransform*>(const_cast<osg::Node*>(lit->getChild(0)));
        light = dynamic_cast<osg::Texture2D*>(textureOf(*place, ShadingTexture::defaultUnit));
        id = light->getTextureObject(flight.picture.state().getContextID())->id();
    }
    const auto child = below();
    flight.replace(child);
    flight.fly();
    // What a host does that frees memory must not touch what is the other tile's.
    tileOf(*child).getStateSet()->releaseGLObjects(&flight.picture.state());
    flight.fly();
    EXPECT_LE(difference(flight.pixels(), from), 1.0);
    flight.forgetParent();
    flight.lighting->setFadeSeconds(2.0);
    flight.fly(8);
    EXPECT_TRUE(light.valid());
    EXPECT_EQ(glIsTexture(id), GL_TRUE);
    flight.fly(30);
    EXPECT_FALSE(light.valid());
    EXPECT_EQ(glIsTexture(id), GL_FALSE);
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: the picture before, until the light of the flattened ground is there; then mixtures.
TEST(TileFade, ATileThatIsLitAnewKeepsItsLightMeanwhile)
{
    OTL_NEED_GL(context);
    const Pixels own = ofItself({}, true);
    Flight flight;
    const auto place = above();
    flight.lighting->addChild(place);
    flight.fly(4);
    const Pixels from = flight.pixels();
    flight.slowDown();
    osgTerrain::Layer* layer = tileOf(*place).getElevationLayer();
    osg::HeightField* heights =
        dynamic_cast<osgTerrain::HeightFieldLayer&>(*layer).getHeightField();
    std::fill(heights->getFloatArray()->begin(), heights->getFloatArray()->end(), 0.0f);
    layer->dirty();
    for (int frame = 1; frame <= steps; ++frame)
    {
        flight.fly();
        EXPECT_EQ(difference(flight.pixels(), from), 0.0) << frame;
    }
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0, 1.0})
    {
        flight.fly();
        EXPECT_LE(fromMixture(flight.pixels(), from, own, part), 2.0) << part;
    }
    EXPECT_FALSE(textureOf(*place, ShadingTexture::formerUnit));
}

// Expected: with no time to fade, the picture before, then that of the tile itself.
TEST(TileFade, OfNoTimeShowsLightAsSoonAsItIsThere)
{
    OTL_NEED_GL(context);
    const Pixels own = ofItself();
    Flight flight;
    const Pixels from = flight.begin();
    flight.lighting->setFadeSeconds(0.0);
    flight.replace(below());
    flight.fly(steps);
    EXPECT_LE(difference(flight.pixels(), from), 1.0);
    flight.fly();
    EXPECT_EQ(difference(flight.pixels(), own), 0.0);
}

// Expected: a host that stops its simulation time does not stop the fade.
TEST(TileFade, GoesOnByTheClockWhereSimulationTimeStandsStill)
{
    OTL_NEED_GL(context);
    Flight flight;
    flight.begin();
    flight.lighting->setFadeSeconds(0.05);
    const auto child = below();
    flight.replace(child);
    flight.fly(steps + 1);
    int frames = 0;
    for (; textureOf(*child, ShadingTexture::formerUnit) && frames < 100000; ++frames)
        flight.picture.viewer().frame(1.0);
    EXPECT_GT(frames, 0);
    EXPECT_LT(frames, 100000);
}

// Expected: half a fade after, the mixture of both tiles' light under the new sun, at once.
TEST(TileFade, TheSunNeitherFadesNorLags)
{
    OTL_NEED_GL(context);
    SkyLight evening;
    evening.sunAzimuth = 300.0;
    evening.sunElevation = 20.0;
    const Pixels own = ofItself(evening);
    Flight flight;
    flight.begin();
    flight.lighting->setSkyLight(evening);
    flight.fly();
    const Pixels from = flight.pixels();
    flight.lighting->setSkyLight({});
    flight.fly();
    EXPECT_GT(difference(flight.pixels(), from), 40.0);
    flight.replace(below());
    flight.hurry();
    flight.fly(3); // lit in the first, then 0 and 0.25
    flight.lighting->setSkyLight(evening);
    flight.fly();
    EXPECT_LE(fromMixture(flight.pixels(), from, own, 0.5), 2.0);
}

// Expected: a tile whose ID is below another's, but that lies elsewhere, and one whose host has a
// texture in the unit, are lit as if nothing were above.
TEST(TileFade, NotWhereTheTileLiesElsewhereNorInAUnitThatIsTaken)
{
    OTL_NEED_GL(context);
    const osg::ref_ptr<osg::Texture2D> theirs = new osg::Texture2D;
    for (const bool elsewhere : {true, false})
    {
        SCOPED_TRACE(elsewhere);
        Flight flight;
        flight.begin();
        const auto child = below();
        if (elsewhere)
            child->setMatrix(osg::Matrix::translate(320.0, 160.0, 0.0));
        else
            tileOf(*child).getOrCreateStateSet()->setTextureAttribute(ShadingTexture::formerUnit,
                                                                      theirs);
        flight.replace(child);
        flight.fly();
        EXPECT_EQ(textureOf(*child, ShadingTexture::formerUnit),
                  elsewhere ? nullptr : theirs.get());
        flight.hurry();
        flight.fly(4); // a tile with a StateSet of its own may have been drawn: it waits
        const TileHandle handle = flight.lighting->getTileHandle(&tileOf(*child));
        EXPECT_EQ(flight.lighting->getTileState(handle).stage, TileState::Stage::Lit);
        float part = 1.0f;
        tileOf(*child).getStateSet()->getUniform(ShadingTexture::formerPart)->get(part);
        EXPECT_EQ(part, 0.0f);
    }
}

// Expected: a scene that is saved in the middle of a fade is read as one that does not fade: the
// picture of the tile alone, and no former light to read it by.
TEST(TileFade, IsNotSaved)
{
    OTL_NEED_GL(context);
    useOwnPlugins();
    const Pixels own = ofItself({}, true);
    const std::string path = (testFolder() / "fading.osgt").string();
    {
        Flight flight;
        flight.begin();
        const auto child = below();
        flight.replace(child);
        flight.fly(steps + 2);
        EXPECT_TRUE(textureOf(*child, ShadingTexture::formerUnit));
        const osg::ref_ptr<TerrainLighting> saved =
            osg::clone(flight.lighting.get(), osg::CopyOp::SHALLOW_COPY);
        saved->removeChild(0u, 1u);
        EXPECT_TRUE(osgDB::writeNodeFile(*saved, path));
    }
    const osg::ref_ptr<osg::Node> read = osgDB::readRefNodeFile(path);
    ASSERT_TRUE(read);
    ScenePicture picture(read, reach);
    picture.draw(4);
    EXPECT_EQ(difference(picture.pixels(), own), 0.0);
}

// Expected: what LitTile.h says, context by context.
TEST(TileFade, ContextsThatHaveNoFormerLightWaitForTheTilesOwn)
{
    using Stage = LitTile::Stage;
    const osg::ref_ptr<LitTile> tile =
        new LitTile("tile", analytic::plane(3, 3, 10.0, 0.0), std::make_shared<SceneLight>());
    EXPECT_FALSE(tile->isDrawable(0));
    EXPECT_FALSE(tile->isFormerEverywhere()) << "there is none";
    tile->setFormer(std::set<unsigned>{0, 1});
    EXPECT_TRUE(tile->isDrawable(0) && tile->isDrawable(1));
    EXPECT_FALSE(tile->isDrawable(2));
    tile->meet(0);
    tile->meet(1);
    EXPECT_TRUE(tile->isFormerEverywhere());
    tile->setStage(0, Stage::Lit);
    EXPECT_EQ(tile->state().stage, TileState::Stage::Waiting) << "a fade would be seen in 1";
    tile->setFormer(std::set<unsigned>{0, 1}, true);
    EXPECT_TRUE(tile->isDrawable(0));
    EXPECT_FALSE(tile->isDrawable(1)) << "its own light is not there";
    tile->setStage(1, Stage::Lit);
    EXPECT_EQ(tile->state().stage, TileState::Stage::Lit);
    EXPECT_EQ(tile->litContexts(), (std::set<unsigned>{0, 1}));
    tile->meet(2);
    EXPECT_FALSE(tile->isFormerEverywhere());
    tile->setStage(2, Stage::Lit);
    EXPECT_FALSE(tile->isDrawable(2)) << "former light that it has not would be mixed in";
    tile->setFormer(std::nullopt);
    EXPECT_TRUE(tile->isDrawable(0) && tile->isDrawable(1) && tile->isDrawable(2));
    tile->setFormer(std::set<unsigned>{0, 1});
    tile->fail(0, "reason");
    EXPECT_FALSE(tile->isDrawable(0));
    tile->forgetFormer(1);
    EXPECT_FALSE(tile->isDrawable(1));
}
