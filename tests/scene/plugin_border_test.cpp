// What passes the border of the plugin: no exception, and a warning where light is lost.
#include "support/ScenePicture.h"
#include "support/TestFolder.h"

#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Geode>
#include <osg/Geometry>
#include <osgDB/FileNameUtils>
#include <osgDB/ReadFile>
#include <osgDB/Registry>
#include <osgDB/WriteFile>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

using namespace osgTerrainLight;
namespace fs = std::filesystem;

namespace
{
/// A reader of somebody else that throws.
class Throwing : public osgDB::ReaderWriter
{
public:
    Throwing() { supportsExtension("throws", "a format of this test"); }
    const char* className() const override { return "Throwing reader"; }
    ReadResult readNode(const std::string& name, const osgDB::Options*) const override
    {
        if (!acceptsExtension(osgDB::getFileExtension(name)))
            return ReadResult::FILE_NOT_HANDLED;
        throw std::runtime_error("thrown by a reader");
    }
};

class PluginBorder : public testing::Test
{
protected:
    void SetUp() override { useOwnPlugins(); }
    std::string in(const std::string& name) const { return (folder / name).string(); }

    const fs::path folder = testFolder();
};

osg::ref_ptr<osg::Node> triangle()
{
    const osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
    const osg::ref_ptr<osg::Vec3Array> corners = new osg::Vec3Array;
    for (const osg::Vec3& corner : {osg::Vec3(0, 0, 0), osg::Vec3(1, 0, 0), osg::Vec3(0, 1, 0)})
        corners->push_back(corner);
    geometry->setVertexArray(corners);
    geometry->addPrimitiveSet(new osg::DrawArrays(GL_TRIANGLES, 0, 3));
    const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(geometry);
    return geode;
}
} // namespace

TEST_F(PluginBorder, ExceptionsOfReadersBecomeErrors)
{
    const osgDB::RegisterReaderWriterProxy<Throwing> registered;
    std::ofstream(in("a.throws")) << "something";
    const Said said;
    EXPECT_EQ(osgDB::readRefNodeFile(in("a.throws") + ".terrainlight"), nullptr);
    EXPECT_EQ(said.count("thrown by a reader"), 1) << said.text();
}

// Writers of OSG that report success and leave the node out, and those that keep it.
TEST_F(PluginBorder, AFormatThatDropsTheLightIsAWarning)
{
    const osg::ref_ptr<osg::Group> scene = new osg::Group;
    const osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->addChild(triangle());
    scene->addChild(lighting);
    int written = 0;
    for (const char* name : {"a.obj", "a.stl", "a.3ds", "a.iv", "a.ive", "a.ac"})
    {
        const Said said;
        if (!osgDB::writeNodeFile(*scene, in(name)))
            continue; // no such plugin here
        ++written;
        EXPECT_EQ(said.count(in(name) + ": the light is left out"), 1) << name << said.text();
    }
    EXPECT_GT(written, 0) << "none of these formats can be written here";
    for (const char* name : {"a.osgt", "a.osgb", "a.osgx"})
    {
        const Said said;
        ASSERT_TRUE(osgDB::writeNodeFile(*scene, in(name))) << name;
        EXPECT_EQ(said.count("left out"), 0) << said.text();
    }
    const Said said;
    osgDB::writeNodeFile(*triangle(), in("plain.obj"));
    EXPECT_FALSE(osgDB::writeNodeFile(*scene, in("a.unheard_of")));
    EXPECT_EQ(said.count("left out"), 0) << said.text();
}

TEST_F(PluginBorder, AnApplicationsCallbackOfWritingStays)
{
    class Counter : public osgDB::WriteFileCallback
    {
    public:
        osgDB::ReaderWriter::WriteResult writeNode(const osg::Node&, const std::string&,
                                                   const osgDB::Options*) override
        {
            ++count;
            return osgDB::ReaderWriter::WriteResult::FILE_SAVED;
        }
        int count = 0;
    };
    osgDB::Registry& registry = *osgDB::Registry::instance();
    const osg::ref_ptr<osgDB::WriteFileCallback> before = registry.getWriteFileCallback();
    const osg::ref_ptr<Counter> counter = new Counter;
    registry.setWriteFileCallback(counter);
    useOwnPlugins();
    const Said said;
    EXPECT_TRUE(osgDB::writeNodeFile(*new TerrainLighting, in("a.obj")));
    EXPECT_EQ(counter->count, 1);
    EXPECT_EQ(said.count("left out"), 0);
    registry.setWriteFileCallback(before);
}
