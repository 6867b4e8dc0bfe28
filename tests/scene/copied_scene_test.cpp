// Copies of a lit scene, drawn beside and without the original.
#include <osgTerrainLight/TerrainLighting.h>

#include "support/AnalyticTerrain.h"
#include "support/GlContext.h"
#include "support/ScenePicture.h"
#include "terrain/TerrainModel.h"

#include <osg/MatrixTransform>

#include <gtest/gtest.h>

using namespace osgTerrainLight;

namespace
{
constexpr double reach = 160.0;

SkyLight uniform(float radiance)
{
    SkyLight sky;
    sky.sunEnabled = false;
    sky.skyRadiance = {radiance, radiance, radiance};
    return sky;
}

// Of level ground under a uniform sky: shading is the sky's radiance, which the picture has in
// sRGB. 1 of 8 bits, and the half-float's 0.05 %.
constexpr float dim = 0.25f, bright = 0.5f;
constexpr double dimRed = 137.0, brightRed = 188.0, rounding = 1.5;

osg::ref_ptr<TerrainLighting> levelGround()
{
    osg::ref_ptr<TerrainLighting> lighting = lightingWithBudget(0.0, 4);
    lighting->setSkyLight(uniform(dim));
    lighting->addChild(createTerrain(analytic::plane(33, 33, 20.0, 0.0)));
    return lighting;
}

/// The original in the west of the picture, the copy in the east.
osg::ref_ptr<osg::Group> sideBySide(osg::Node* original, osg::Node* copy)
{
    osg::ref_ptr<osg::Group> both = new osg::Group;
    const osg::ref_ptr<osg::MatrixTransform> west =
        new osg::MatrixTransform(osg::Matrix::translate(-320.0, 0.0, 0.0));
    const osg::ref_ptr<osg::MatrixTransform> east =
        new osg::MatrixTransform(osg::Matrix::translate(320.0, 0.0, 0.0));
    west->addChild(original);
    east->addChild(copy);
    both->addChild(west);
    both->addChild(east);
    return both;
}

void expectOwnLight(osg::CopyOp::CopyFlags flags)
{
    Said said;
    osg::ref_ptr<TerrainLighting> original = levelGround();
    {
        ScenePicture before(original, reach);
        before.draw(3);
        EXPECT_NEAR(before.redAt(0, 0), dimRed, rounding);
    }
    osg::ref_ptr<TerrainLighting> copy = osg::clone(original.get(), osg::CopyOp(flags));
    copy->setSkyLight(uniform(bright));
    ScenePicture picture(sideBySide(original, copy), 2.0 * reach);
    picture.draw(5);
    EXPECT_NEAR(picture.redAt(-0.5, 0), dimRed, rounding);
    EXPECT_NEAR(picture.redAt(0.5, 0), brightRed, rounding);
    EXPECT_EQ(copy->getTileCount(), 1u);
    original->setSkyLight(uniform(bright));
    copy->setSkyLight(uniform(dim));
    picture.draw(2);
    EXPECT_NEAR(picture.redAt(-0.5, 0), brightRed, rounding);
    EXPECT_NEAR(picture.redAt(0.5, 0), dimRed, rounding);
    original->removeChildren(0, 1);
    picture.draw(6);
    EXPECT_NEAR(picture.redAt(0.5, 0), dimRed, rounding) << "after the original let go";
    EXPECT_EQ(said.count("unlit"), 0) << said.text();
    EXPECT_EQ(takeGlErrors(), "");
}
} // namespace

TEST(CopiedScene, WithCopiesOfTheNodesHasLightOfItsOwn)
{
    OTL_NEED_GL(context);
    expectOwnLight(osg::CopyOp::DEEP_COPY_NODES);
}

TEST(CopiedScene, WithCopiesOfNodesAndStateSetsHasLightOfItsOwn)
{
    OTL_NEED_GL(context);
    expectOwnLight(osg::CopyOp::DEEP_COPY_NODES | osg::CopyOp::DEEP_COPY_STATESETS);
}

TEST(CopiedScene, WithCopiesOfAllButTexturesHasLightOfItsOwn)
{
    OTL_NEED_GL(context);
    expectOwnLight(osg::CopyOp::DEEP_COPY_ALL & ~osg::CopyOp::DEEP_COPY_TEXTURES);
}

// Expected: what the copy constructor says of nodes that both have.
TEST(CopiedScene, WithTheSameNodesLeavesThemToTheOriginalUntilItLetsGo)
{
    OTL_NEED_GL(context);
    Said said;
    osg::ref_ptr<TerrainLighting> original = levelGround();
    osg::ref_ptr<TerrainLighting> copy;
    {
        ScenePicture before(original, reach);
        before.draw(3);
        copy = osg::clone(original.get(), osg::CopyOp(osg::CopyOp::SHALLOW_COPY));
    }
    copy->setSkyLight(uniform(bright));
    ScenePicture picture(sideBySide(original, copy), 2.0 * reach);
    picture.draw(6);
    EXPECT_NEAR(picture.redAt(-0.5, 0), dimRed, rounding);
    EXPECT_EQ(copy->getTileCount(), 0u);
    EXPECT_EQ(said.count("another TerrainLighting lights it"), 1) << said.text();
    ASSERT_EQ(copy->getTileHandles().size(), 1u);
    EXPECT_EQ(copy->getTileState(copy->getTileHandles()[0]).stage, TileState::Stage::Failed);
    original->removeChildren(0, 1);
    picture.draw(6);
    EXPECT_NEAR(picture.redAt(0.5, 0), brightRed, rounding);
    EXPECT_EQ(copy->getTileState(copy->getTileHandles()[0]).stage, TileState::Stage::Lit);
    EXPECT_EQ(said.count("unlit"), 1) << said.text();
    EXPECT_EQ(takeGlErrors(), "");
}

// Expected: the light of the lighting that the node stands below, and no warning, in whichever
// order the two are updated.
TEST(CopiedScene, ANodeThatMovesToAnotherLightingIsLitThere)
{
    OTL_NEED_GL(context);
    Said said;
    const osg::ref_ptr<TerrainLighting> a = levelGround(), b = levelGround();
    b->setSkyLight(uniform(bright));
    b->removeChildren(0, 1);
    const osg::ref_ptr<osg::Node> terrain = a->getChild(0);
    ScenePicture picture(sideBySide(a, b), 2.0 * reach);
    picture.draw(3);
    for (int round = 0; round < 2; ++round)
    {
        a->removeChild(terrain);
        b->addChild(terrain);
        picture.draw(4);
        EXPECT_NEAR(picture.redAt(0.5, 0), brightRed, rounding);
        b->removeChild(terrain);
        a->addChild(terrain);
        picture.draw(4);
        EXPECT_NEAR(picture.redAt(-0.5, 0), dimRed, rounding);
    }
    EXPECT_EQ(said.count("unlit"), 0) << said.text();
    EXPECT_EQ(takeGlErrors(), "");
}
