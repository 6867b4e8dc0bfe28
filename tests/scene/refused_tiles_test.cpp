// What TerrainLighting and DynamicTerrain refuse of tiles and texture units, each with one warning.
#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/TerrainLighting.h>

#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <osgTerrain/TerrainTile>

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
constexpr double reach = 80.0;

DemTile hill()
{
    return analytic::cone(17, 17, 10.0, 8, 8, 60.0, 60.0);
}

void setGloss(TerrainLighting& lighting, double gloss)
{
    LightingSettings settings = lighting.getSettings();
    settings.gloss = gloss;
    lighting.setSettings(settings);
}

osg::StateAttribute* textureIn(const osg::Node& node, unsigned unit)
{
    return const_cast<osg::StateSet*>(node.getStateSet())
        ->getTextureAttribute(unit, osg::StateAttribute::TEXTURE);
}
} // namespace

TEST(RefusedTiles, WithSpacingsThatAreNotLegal)
{
    DemTile noSpacing = hill(), notANumber = hill(), negative = hill(), zero = hill(),
            tooFew = hill();
    noSpacing.eastSpacings = {};
    notANumber.northSpacing = std::nan("");
    negative.northSpacing = -1.0;
    zero.northSpacing = 0.0;
    tooFew.eastSpacings = {10.0, 10.0};
    const std::pair<DemTile, const char*> wrong[] = {
        {noSpacing, "eastSpacings has 0 entries: needs 1, or one per row, 17"},
        {notANumber, "northSpacing = nan m: needs more than 0"},
        {negative, "northSpacing = -1.000000 m: needs more than 0"},
        {zero, "northSpacing = 0.000000 m: needs more than 0"},
        {tooFew, "eastSpacings has 2 entries: needs 1, or one per row, 17"},
        {DemTile(), "tile has 0 x 0 posts: needs at least one"}};
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 4);
    for (const auto& [dem, sentence] : wrong)
    {
        Said said;
        const osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
        EXPECT_FALSE(lighting->addTile(dem, stateSet));
        EXPECT_EQ(said.count(std::string("tile not added: ") + sentence), 1) << said.text();
        EXPECT_TRUE(stateSet->getUniformList().empty());
        const osg::ref_ptr<DynamicTerrain> dynamic = new DynamicTerrain(dem);
        EXPECT_FALSE(lighting->addTile(dynamic));
        EXPECT_EQ(said.count("dynamic terrain not added: "), 1) << said.text();
    }
    EXPECT_TRUE(lighting->getTileHandles().empty());
    EXPECT_TRUE(lighting->addTile(hill(), new osg::StateSet));
}

TEST(RefusedTiles, WithTheStateSetOfAnotherLightingsTile)
{
    Said said;
    const osg::ref_ptr<TerrainLighting> one = lightingWithBudget(0.0, 4),
                                        other = lightingWithBudget(0.0, 4);
    const osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    const TileHandle tile = one->addTile(hill(), stateSet);
    EXPECT_TRUE(tile);
    EXPECT_FALSE(other->addTile(hill(), stateSet));
    EXPECT_EQ(said.count("its StateSet is another tile's"), 1) << said.text();
    EXPECT_TRUE(one->removeTile(tile));
    EXPECT_TRUE(other->addTile(hill(), stateSet));
}

// Expected: what getTileHandle() says: a handle that it has given is that terrain tile's.
TEST(RefusedTiles, WithTheNameOfATerrainTile)
{
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 4);
    const osg::ref_ptr<osg::Node> terrain = createTerrain(hill()), second = createTerrain(hill());
    const auto tileOf = [](osg::Node& node)
    { return dynamic_cast<osgTerrain::TerrainTile*>(node.asGroup()->getChild(0)); };
    osgTerrain::TerrainTile *tile = tileOf(*terrain), *later = tileOf(*second);
    ASSERT_TRUE(tile && later);
    tile->setTileID(osgTerrain::TileID(2, 1, 1));
    later->setTileID(osgTerrain::TileID(3, 1, 1));
    const TileHandle name = lighting->getTileHandle(tile);
    EXPECT_EQ(name, TileHandle::at(2, 1, 1));
    const auto addAs = [&](const TileHandle& handle)
    { return lighting->addTile(hill(), new osg::StateSet, {}, false, handle); };
    EXPECT_FALSE(addAs(name));
    EXPECT_EQ(said.count("tile not added: its name is another tile's"), 1) << said.text();
    EXPECT_TRUE(
        addAs(TileHandle::at(3, 1, 1))); // not asked for yet: the terrain tile gets a number
    lighting->addChild(terrain);
    lighting->addChild(second);
    ScenePicture picture(lighting, reach);
    picture.draw(4);
    EXPECT_EQ(lighting->getTileHandle(tile), name);
    EXPECT_EQ(lighting->getTileState(name).stage, TileState::Stage::Lit);
    EXPECT_EQ(lighting->getTileHandle(later).level, -1);
    EXPECT_EQ(lighting->getTileState(lighting->getTileHandle(later)).stage, TileState::Stage::Lit);
}

TEST(RefusedUnits, BeyondTheRangeOrTwiceTheSame)
{
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 4);
    lighting->setTextureUnit(31);
    lighting->setGlossUnit(30);
    Said said;
    lighting->setTextureUnit(32);
    EXPECT_EQ(said.count("texture unit not set: 32: needs 0 ... 31"), 1) << said.text();
    lighting->setGlossUnit(99);
    EXPECT_EQ(said.count("gloss unit not set: 99: needs 0 ... 31"), 1) << said.text();
    lighting->setGlossUnit(31);
    EXPECT_EQ(said.count("gloss unit not set: gloss needs texture unit 31, which the shading has"),
              1)
        << said.text();
    EXPECT_EQ(lighting->getTextureUnit(), 31u);
    EXPECT_EQ(lighting->getGlossUnit(), 30u);
    lighting->setTimeBudget(HUGE_VAL);
    EXPECT_EQ(lighting->getTimeBudget(), 0.0);
}

// Expected: the heights stay in their unit, in whichever order terrain and gloss come.
TEST(RefusedUnits, GlossInTheUnitOfHeights)
{
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<DynamicTerrain> terrain = new DynamicTerrain(hill());
    terrain->setHeightUnit(ShadingTexture::glossUnit);
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 4);
    lighting->addChild(terrain);
    EXPECT_TRUE(lighting->addTile(terrain));
    setGloss(*lighting, 0.3);
    EXPECT_EQ(lighting->getSettings().gloss, 0.0);
    EXPECT_EQ(said.count("settings not set: gloss needs texture unit 5, which the heights of a "
                         "DynamicTerrain have"),
              1)
        << said.text();
    ScenePicture picture(lighting, reach);
    picture.draw(3);
    EXPECT_EQ(textureIn(*terrain, 5), terrain->getHeightTexture());
    EXPECT_EQ(takeGlErrors(), "");

    const osg::ref_ptr<TerrainLighting> glossy = lightingWithBudget(0.0, 4);
    setGloss(*glossy, 0.3);
    const osg::ref_ptr<DynamicTerrain> second = new DynamicTerrain(hill());
    second->setHeightUnit(ShadingTexture::glossUnit);
    EXPECT_FALSE(glossy->addTile(second));
    EXPECT_EQ(said.count("dynamic terrain not added: its heights are in texture unit 5"), 1);
    second->setHeightUnit(9);
    EXPECT_TRUE(glossy->addTile(second));
    second->setHeightUnit(ShadingTexture::glossUnit);
    EXPECT_EQ(said.count("height unit not set: texture unit 5 has another texture"), 1);
    EXPECT_EQ(second->getHeightUnit(), 9u);

    const osg::ref_ptr<TerrainLighting> late = lightingWithBudget(0.0, 4);
    const osg::ref_ptr<DynamicTerrain> third = new DynamicTerrain(hill());
    EXPECT_TRUE(late->addTile(third));
    setGloss(*late, 0.3);
    third->setHeightUnit(ShadingTexture::glossUnit); // before gloss is bound
    late->addChild(third);
    ScenePicture another(late, reach);
    another.draw(4);
    EXPECT_EQ(textureIn(*third, 5), third->getHeightTexture());
    EXPECT_EQ(said.count("dynamic terrain is drawn without gloss"), 1) << said.text();
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(RefusedUnits, HeightsInTheUnitOfAnotherTexture)
{
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<DynamicTerrain> terrain = new DynamicTerrain(hill());
    const osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 4);
    lighting->addChild(terrain);
    EXPECT_TRUE(lighting->addTile(terrain));
    const osg::StateAttribute* shading = textureIn(*terrain, lighting->getTextureUnit());
    ASSERT_TRUE(shading);
    terrain->setHeightUnit(lighting->getTextureUnit());
    EXPECT_EQ(said.count("height unit not set: texture unit 7 has another texture"), 1);
    EXPECT_EQ(terrain->getHeightUnit(), DynamicTerrain::heightUnit);
    EXPECT_EQ(textureIn(*terrain, lighting->getTextureUnit()), shading);
    ScenePicture picture(lighting, reach);
    picture.draw(2);
    EXPECT_EQ(textureIn(*terrain, DynamicTerrain::heightUnit), terrain->getHeightTexture());
    EXPECT_EQ(lighting->getFailure(), "");
}
