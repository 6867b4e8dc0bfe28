// What needs no OpenGL: help, versions, mistakes, generated terrain.
#include "ToolRun.h"

#include "core/SyntheticTerrain.h"

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

const std::vector<std::string> modes = {
    "horizon", "svf", "shadow", "sunhours", "shade", "render", "info", "generate",
#ifdef OTL_BENCH // which needs Embree
    "bench",
#endif
};

using CommandLine = ToolTest;

TEST_F(CommandLine, HelpListsModesAndExitStatus)
{
    const ToolRun help = run("--help");
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.err, "");
    for (const std::string& mode : modes)
        EXPECT_NE(help.out.find("\n  " + mode + " "), std::string::npos) << mode;
    EXPECT_NE(help.out.find("Exit status"), std::string::npos);
}

TEST_F(CommandLine, HelpOfEveryModeHasAnExample)
{
    for (const std::string& mode : modes)
    {
        const ToolRun help = run(mode + " --help");
        EXPECT_EQ(help.status, 0) << mode;
        EXPECT_EQ(help.err, "") << mode;
        const std::size_t examples = help.out.find("Examples:");
        ASSERT_NE(examples, std::string::npos) << mode;
        EXPECT_NE(help.out.find("terrainlight " + mode, examples), std::string::npos) << mode;
    }
}

TEST_F(CommandLine, HelpSpellsOptionsAsGdalDoes)
{
    const ToolRun help = run("svf --help");
    for (const char* option : {" -of FORMAT", " -co NAME=VALUE", " -srcwin,--window X Y W H", " -q",
                               " --config KEY VALUE", " --azimuths N"})
        EXPECT_NE(help.out.find(option), std::string::npos) << option;
    EXPECT_EQ(help.out.find("--of"), std::string::npos);
    EXPECT_NE(help.out.find("One of draft,"), std::string::npos) << "a name as it is read";
}

TEST_F(CommandLine, VersionNamesToolGdalAndOsg)
{
    const ToolRun version = run("--version");
    EXPECT_EQ(version.status, 0);
    EXPECT_EQ(version.out.rfind("terrainlight " OSGTERRAINLIGHT_VERSION ", GDAL ", 0), 0u)
        << version.out;
    EXPECT_NE(version.out.find("OpenSceneGraph 3."), std::string::npos);
}

TEST_F(CommandLine, MistakesExitWith2AndNameWhatIsWrong)
{
    const struct
    {
        const char* arguments;
        std::vector<const char*> complaints;
    } mistakes[] = {
        {"", {"no mode given", "horizon, svf"}},
        {"frob", {"'frob' is no mode", "horizon, svf"}},
        {"svf", {"INPUT is required"}},
        {"svf in.tif", {"OUTPUT is required"}},
        {"svf in.tif out.tif third", {"third"}},
        {"svf in.tif out.tif --frob", {"--frob"}},
        {"svf in.tif out.tif -frob", {"-frob"}},
        {"svf in.tif out.tif --azimuths 30", {"--azimuths", "30", "multiple of 4, 4 ... 256"}},
        {"svf in.tif out.tif --azimuths 260", {"--azimuths", "260", "4 ... 256"}},
        {"svf in.tif out.tif --azimuths 8.5", {"--azimuths", "8.5"}},
        {"svf in.tif out.tif --azimuths many", {"--azimuths", "many"}},
        {"svf in.tif out.tif --azimuths nan", {"--azimuths", "nan"}},
        {"svf in.tif out.tif --quality good", {"--quality", "good", "draft, normal or best"}},
        {"svf in.tif out.tif --definition sky", {"--definition", "sky", "solid-angle"}},
        {"svf in.tif out.tif -srcwin 1 2 3", {"-srcwin"}},
        {"svf in.tif out.tif -of", {"-of"}},
        {"svf in.tif out.tif --cell-size 0", {"--cell-size", "0"}},
        {"shadow in.tif out.tif --sun 315", {"--sun", "315", "AZ,EL"}},
        {"shadow in.tif out.tif --sun 315,20,1", {"--sun", "AZ,EL"}},
        {"shadow in.tif out.tif --sun 315,up", {"--sun", "up", "AZ,EL"}},
        {"shadow in.tif out.tif --sun 315,91", {"--sun", "sun-elevation", "91", "-90 ... 90"}},
        {"shadow in.tif out.tif --sun 1000,5", {"--sun", "sun-azimuth", "-360 ... 720"}},
        {"shadow in.tif out.tif --sun-radius 20", {"--sun-radius", "20", "0.01 ... 10"}},
        {"shadow in.tif out.tif --azimuths 8", {"--azimuths"}},
        {"shade in.tif out.tif --exposure 21", {"--exposure", "21", "-20 ... 20"}},
        {"shade in.tif out.tif --sky-radiance 1,1", {"--sky-radiance", "one number or three"}},
        {"shade in.tif out.tif --sun-irradiance 1,-1,1", {"--sun-irradiance", "-1"}},
        {"shade in.tif out.tif --turbidity 3", {"--turbidity", "needs sky clear"}},
        {"shade in.tif out.tif --subsampling 2", {"--subsampling", "needs legendre"}},
        {"shade in.tif out.tif --sky clear --turbidity 1", {"turbidity", "2 ... 10"}},
        {"shade in.tif out.tif --sky clear --sky-radiance 1,1,1", {"--sky-radiance", "uniform"}},
        {"shade in.tif out.tif --sky-heading 90", {"--sky-heading", "needs a sky from a file"}},
        {"shade in.tif out.tif --sky p.exr --sun 1,2", {"--sun", "p.exr", "--sky-heading"}},
        {"shade in.tif out.tif --body-radius 10", {"body-radius", "0, or 1000"}},
        {"shade in.tif out.tif --sky clear --max-error 0.1", {"--max-error", "uniform sky"}},
        {"shade in.tif out.tif --key-light 1,2,3", {"--key-light", "azimuth,width,lowest,highest"}},
        {"shade in.tif out.tif --key-light 0,30,50,20", {"--key-light", "lowest < highest"}},
        {"shade in.tif out.tif --key-light 0,30,20,50,-1", {"--key-light", "radiance = -1"}},
        {"shade in.tif out.tif --sky-harmonics 1,2", {"--sky-harmonics", "1, 4, 9 or 16", "2 num"}},
        {"shade in.tif out.tif --sky-harmonics 1 --sky none", {"--sky-harmonics", "--sky"}},
        {"shade in.tif out.tif --sky-harmonics 1 --sky-radiance 1,1,1",
         {"sky-harmonics", "--sky-radiance"}},
        {"shade in.tif out.tif --key-light 0,30,20,50 --max-error 0.1",
         {"--max-error", "uniform sky and a sun"}},
        {"shade in.tif out.tif --sky-harmonics 1 --max-ms 10", {"--max-ms", "another sky"}},
        {"render in.tif out.png --gloss 0.3 --bounce-method legendre", {"--gloss", "needs slices"}},
        {"render in.tif out.png --sky uniform --turbidity 3", {"--turbidity", "needs sky clear"}},
        {"render in.tif out.png --size 0", {"--size", "0", "1 ... 65536"}},
        {"render in.tif out.png --size 10,10,10", {"--size", "W[,H]"}},
        {"render in.tif out.png --top --eye 1,2,3", {"--top", "--eye"}},
        {"generate hills out.tif", {"KIND", "hills", "fractal"}},
        {"generate fractal out.tif --spacing 0", {"--spacing", "0.001 ... 10000"}},
        {"generate fractal out.tif --seed 1.5", {"--seed", "1.5", "whole"}},
    };
    for (const auto& mistake : mistakes)
    {
        SCOPED_TRACE(mistake.arguments);
        const ToolRun result = run(mistake.arguments);
        EXPECT_EQ(result.status, 2);
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(result.err.rfind("terrainlight: ", 0), 0u) << result.err;
        for (const char* complaint : mistake.complaints)
            EXPECT_TRUE(result.complains(complaint)) << complaint << " not in: " << result.err;
        EXPECT_TRUE(left().empty());
    }
}

TEST_F(CommandLine, OutputMustNotBeTheInput)
{
    std::filesystem::copy_file(jacksboro, path("dem.tif"));
    std::filesystem::create_symlink("dem.tif", path("link.tif"));
    const std::string before = contentOf(path("dem.tif"));
    for (const std::string output : {"dem.tif", "./dem.tif", "link.tif"})
        for (const std::string mode : {"horizon", "svf", "shadow", "shade", "render"})
        {
            const ToolRun result = run(mode + " dem.tif " + output);
            EXPECT_EQ(result.status, 2);
            EXPECT_TRUE(result.complains(output + " is the input file")) << result.err;
        }
    EXPECT_EQ(contentOf(path("dem.tif")), before);
}

TEST_F(CommandLine, GeneratedTerrainIsTheLibrarys)
{
    const ToolRun result = run("generate cliffs c.tif --size 20,10 --spacing 5 --seed 3");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("100 - done."), std::string::npos);
    const DemTile tile = generateTerrain(TerrainKind::Cliffs, 20, 10, 5.0, 3).value();
    const ReadRaster raster(path("c.tif"));
    ASSERT_EQ(raster.width, 20);
    ASSERT_EQ(raster.height, 10);
    ASSERT_EQ(raster.count, 1);
    EXPECT_EQ(raster.transform[1], 5.0);
    EXPECT_EQ(raster.transform[5], -5.0);
    EXPECT_STREQ(raster.dataset->GetRasterBand(1)->GetUnitType(), "m");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_KIND"), "cliffs");
    EXPECT_EQ(raster.metadata("TERRAINLIGHT_SEED"), "3");
    for (int row = 0; row < 10; ++row)
        for (int column = 0; column < 20; ++column)
            EXPECT_EQ(raster.at(1, column, row),
                      static_cast<float>(tile.heightOrigin +
                                         static_cast<double>(tile.heightAt(column, 9 - row))));
    EXPECT_EQ(left(), std::set<std::string>{"c.tif"});
}

TEST_F(CommandLine, EveryKindGeneratesAndOneNumberIsASquare)
{
    for (const TerrainKind kind : allTerrainKinds())
    {
        const std::string name = toString(kind);
        ASSERT_EQ(run("generate " + name + " " + name + ".tif --size 9 -q").status, 0) << name;
        const ReadRaster raster(path(name + ".tif"));
        EXPECT_EQ(raster.width, 9);
        EXPECT_EQ(raster.height, 9);
    }
}

TEST_F(CommandLine, QuietSaysNothing)
{
    const ToolRun result = run("generate fractal f.tif --size 8 -q");
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out + result.err, "");
}

TEST_F(CommandLine, ConfigReachesGdal)
{
    // An .asc file has no place for metadata: they go to a sidecar file, which this switches off.
    ASSERT_EQ(run("generate fractal a.asc --size 8 -q").status, 0);
    EXPECT_EQ(left().count("a.asc.aux.xml"), 1u);
    ASSERT_EQ(run("generate fractal b.asc --size 8 -q --config GDAL_PAM_ENABLED NO").status, 0);
    EXPECT_EQ(left().count("b.asc.aux.xml"), 0u);
    EXPECT_EQ(left().count("b.asc"), 1u);
}

} // namespace
