// How tiles are found below a node, without light: what the finder tells, and how far it looks.
#include "scene/TileFinder.h"

#include <osg/MatrixTransform>
#include <osg/Switch>

#include <gtest/gtest.h>

#include <cmath>

#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
class Root : public osg::Group
{
public:
    mutable TileFinder finder;
    osg::BoundingSphere computeBound() const override
    {
        finder.noteDirtyBounds();
        return osg::Group::computeBound();
    }
};

osg::ref_ptr<osgTerrain::TerrainTile> tileNamed(const std::string& name)
{
    osg::ref_ptr<osgTerrain::TerrainTile> tile = new osgTerrain::TerrainTile;
    tile->setName(name);
    return tile;
}

struct Scene final : TileFinder::Listener
{
    osg::ref_ptr<Root> root = new Root;
    std::vector<std::string> said;

    void came(const FoundTile& found) override { say("came", found); }
    void changed(const FoundTile& found) override { say("changed", found); }
    void went(osgTerrain::TerrainTile& tile) override { said.push_back("went " + tile.getName()); }
    void say(const std::string& what, const FoundTile& found)
    {
        said.push_back(what + " " + found.tile->getName() + " " +
                       std::to_string(std::lround(found.toScene.getTrans().x())) +
                       (found.hasProgram ? " program" : ""));
    }

    /// As an update does; what was told since the last one.
    std::vector<std::string> update()
    {
        said.clear();
        root->getBound();
        root->finder.follow(*root, *this);
        return said;
    }
    /// Nodes looked at by an update.
    unsigned visits()
    {
        const unsigned before = root->finder.visits();
        update();
        return root->finder.visits() - before;
    }
};

using Said = std::vector<std::string>;
} // namespace

TEST(TileFinder, TellsWhatComesMovesAndGoes)
{
    Scene scene;
    const osg::ref_ptr<osg::MatrixTransform> moved = new osg::MatrixTransform;
    const osg::ref_ptr<osg::Group> deep = new osg::Group;
    moved->addChild(deep);
    scene.root->addChild(moved);
    EXPECT_EQ(scene.update(), Said());
    const auto a = tileNamed("a");
    const auto b = tileNamed("b");
    deep->addChild(a);
    EXPECT_EQ(scene.update(), Said{"came a 0"});
    deep->insertChild(0, b);
    EXPECT_EQ(scene.update(), Said{"came b 0"});
    moved->setMatrix(osg::Matrix::translate(7.0, 0.0, 0.0));
    EXPECT_EQ(scene.update(), (Said{"changed b 7", "changed a 7"}));
    EXPECT_EQ(scene.update(), Said());
    deep->removeChild(a);
    EXPECT_EQ(scene.update(), Said{"went a"});
    scene.root->removeChild(moved);
    EXPECT_EQ(scene.update(), Said{"went b"});
}

TEST(TileFinder, ATileInTwoPlacesCountsInTheFirst)
{
    Scene scene;
    const auto tile = tileNamed("a");
    osg::ref_ptr<osg::MatrixTransform> places[2];
    for (int i = 0; i < 2; ++i)
    {
        places[i] = new osg::MatrixTransform(osg::Matrix::translate(10.0 * (i + 1), 0.0, 0.0));
        places[i]->addChild(tile);
        scene.root->addChild(places[i]);
    }
    EXPECT_EQ(scene.update(), Said{"came a 10"});
    scene.root->removeChild(places[0]);
    EXPECT_EQ(scene.update(), Said{"changed a 20"});
    scene.root->removeChild(places[1]);
    EXPECT_EQ(scene.update(), Said{"went a"});
}

// Expected: a program without shaders, as a copy of a lit scene has it, counts as none.
TEST(TileFinder, SeesProgramsAbove)
{
    Scene scene;
    const osg::ref_ptr<osg::Group> group = new osg::Group, empty = new osg::Group;
    const osg::ref_ptr<osg::Program> program = new osg::Program;
    program->addShader(new osg::Shader(osg::Shader::VERTEX));
    group->getOrCreateStateSet()->setAttribute(program);
    group->addChild(tileNamed("a"));
    scene.root->addChild(group);
    scene.root->addChild(tileNamed("b"));
    empty->getOrCreateStateSet()->setAttribute(new osg::Program);
    empty->addChild(tileNamed("c"));
    scene.root->addChild(empty);
    EXPECT_EQ(scene.update(), (Said{"came a 0 program", "came b 0", "came c 0"}));
}

// Expected: the nodes on the path to what has changed, and none where nothing has.
TEST(TileFinder, LooksOnlyWhereSomethingHasChanged)
{
    Scene scene;
    std::vector<osg::ref_ptr<osg::Group>> groups;
    for (int i = 0; i < 20; ++i)
    {
        groups.push_back(new osg::Group);
        for (int j = 0; j < 20; ++j)
            groups.back()->addChild(tileNamed("a"));
        scene.root->addChild(groups.back());
    }
    EXPECT_EQ(scene.visits(), 1u + 20u + 400u);
    EXPECT_EQ(scene.visits(), 0u);
    groups[7]->addChild(tileNamed("b"));
    EXPECT_EQ(scene.visits(), 3u); // root, group, tile
    groups[7]->getChild(3)->dirtyBound();
    EXPECT_EQ(scene.visits(), 3u);
    groups[7]->removeChild(20);
    EXPECT_EQ(scene.visits(), 2u);
    EXPECT_EQ(scene.visits(), 0u);
}

// Expected: what came is found although a bound in between was asked for before that of the root,
// so that only the root and its child seem to have changed.
TEST(TileFinder, FindsWhatIsBelowABoundThatWasAskedForBefore)
{
    Scene scene;
    const osg::ref_ptr<osg::Group> between = new osg::Group;
    const osg::ref_ptr<osg::Group> deep = new osg::Group;
    between->addChild(deep);
    scene.root->addChild(between);
    scene.update();
    deep->addChild(tileNamed("a"));
    between->getBound();
    EXPECT_EQ(scene.update(), Said{"came a 0"});
}

// Expected: a switch does not add or remove children, so tiles below stay.
TEST(TileFinder, TilesThatAreSwitchedOffStay)
{
    Scene scene;
    const osg::ref_ptr<osg::Switch> parent = new osg::Switch;
    parent->addChild(tileNamed("a"));
    scene.root->addChild(parent);
    EXPECT_EQ(scene.update(), Said{"came a 0"});
    parent->setAllChildrenOff();
    EXPECT_EQ(scene.update(), Said{"changed a 0"});
    parent->getChild(0)->setNodeMask(0);
    parent->setAllChildrenOn();
    EXPECT_EQ(scene.update(), Said{"changed a 0"});
}

// Expected: a new node may get the address of one that is gone; it counts as new all the same.
TEST(TileFinder, ANewTileAtAnOldAddressIsNew)
{
    Scene scene;
    for (int i = 0; i < 20; ++i)
    {
        scene.root->addChild(tileNamed("a"));
        EXPECT_EQ(scene.update().back(), "came a 0");
        scene.root->removeChild(0, 1);
        if (i % 2)
        {
            EXPECT_EQ(scene.update(), Said{"went a"});
        }
    }
}
