// Outputs through the tool: refused where an input is made of them, whole or not there, and what
// the file keeps.
#include "ToolRun.h"

#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <csignal>
#include <map>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;
namespace fs = std::filesystem;

namespace
{

const std::string quick = " -q --quality draft --azimuths 8";

/// A hill of 16 x 16 posts 10 m apart.
std::vector<float> hill()
{
    std::vector<float> heights;
    for (int i = 0; i < 256; ++i)
        heights.push_back(static_cast<float>(100 - (i % 16 - 8) * (i % 16 - 8)));
    return heights;
}

/// Inputs of each kind, as their names say, in a folder of their own.
class OutputIsInput : public ToolTest
{
protected:
    void SetUp() override
    {
        fs::create_directories(folder / "sub");
        for (const char* name : {"dem.tif", "sub/part.tif", "o.tif.ovr", "o.tif.msk"})
            writeRaster(name, 16, 16, hill(), {0, 10, 0, 160, 0, -10});
        translate("dem.tif", "o.bil", {"-of", "EHdr", "-a_srs", "EPSG:32633"}); // o.hdr, o.prj
        translate("dem.tif", "o.bmp", {"-ot", "Byte", "-co", "WORLDFILE=YES"}); // o.wld
        translate("dem.tif", "world.tif", {"-co", "PROFILE=BASELINE", "-co", "TFW=YES"});
        translate("dem.tif", "grey.tif", {"-ot", "Byte"});
        vrt("one.vrt", "sub/part.tif");
        vrt("two.vrt", "one.vrt");
        vrt("three.vrt", "two.vrt");
        vrt("albedo.vrt", "grey.tif");
        vrt("o.grd.aux.xml", "dem.tif"); // a raster of an odd name
        std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
        for (int i = 0; i < 32; ++i)
            sky += "\x80\x80\x80\x80";
        std::ofstream(path("sky.hdr"), std::ios::binary) << sky;
        std::ofstream(path("m.earth"))
            << "<Map><GDALElevation><url>two.vrt</url></GDALElevation><GDALImage URL='grey.tif'/>"
               "<terrain_light sky='sky.hdr'/></Map>";
        fs::copy_file(path("dem.tif"), path("q,1.tif"));
        fs::create_hard_link(path("dem.tif"), path("hard.tif"));
        fs::create_symlink("sub/part.tif", path("soft.tif"));
        fs::create_hard_link(path("sky.hdr"), path("hard.hdr"));
        fs::create_symlink("sky.hdr", path("soft.exr"));
        fs::create_symlink("sub", path("link"));
    }
    void translate(const char* from, const char* to, std::vector<const char*> arguments) const
    {
        GDALAllRegister();
        const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler); // bytes have no nodata value -9999
        arguments.insert(arguments.begin(), "-q");
        arguments.push_back(nullptr);
        GDALTranslateOptions* options =
            GDALTranslateOptionsNew(const_cast<char**>(arguments.data()), nullptr);
        const GDALDatasetUniquePtr source(GDALDataset::Open(path(from).c_str()));
        const GDALDatasetUniquePtr made(GDALDataset::FromHandle(GDALTranslate(
            path(to).c_str(), GDALDataset::ToHandle(source.get()), options, nullptr)));
        GDALTranslateOptionsFree(options);
        ASSERT_TRUE(made) << to;
    }
    void vrt(const std::string& name, const std::string& source) const
    {
        std::ofstream(path(name))
            << "<VRTDataset rasterXSize=\"16\" rasterYSize=\"16\"><GeoTransform>0, 10, 0, 160, 0, "
               "-10</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>"
               "<SourceFilename relativeToVRT=\"1\">"
            << source << "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
    }
    std::map<std::string, std::string> contents() const
    {
        std::map<std::string, std::string> all;
        for (const auto& entry : fs::recursive_directory_iterator(folder))
            all[entry.path().string()] =
                fs::is_directory(entry.path()) ? std::string() : contentOf(entry.path());
        return all;
    }
};

// The file that would be lost is how the inputs are made above. Nothing is begun, and nothing
// changes.
TEST_F(OutputIsInput, IsRefusedBeforeTheWork)
{
    const struct
    {
        std::string command, refused, isMadeOf;
    } runs[] = {
        // What the DEM is made of, under any name.
        {"svf three.vrt sub/part.tif", "sub/part.tif", "sub/part.tif"},
        {"horizon three.vrt ./sub/../one.vrt -of GTiff", "./sub/../one.vrt", "one.vrt"},
        {"svf three.vrt soft.tif", "soft.tif", "sub/part.tif"},
        {"shadow two.vrt link/part.tif", "link/part.tif", "sub/part.tif"},
        {"svf dem.tif hard.tif", "hard.tif", ""},
        {"svf hard.tif dem.tif", "dem.tif", ""},
        {"svf soft.tif sub/part.tif", "sub/part.tif", ""},
        {"svf vrt://two.vrt one.vrt -of GTiff", "one.vrt", "one.vrt"},
        {"sunhours three.vrt sub/part.tif --from 2024-06-21T00:00 "
         "--to 2024-06-22T00:00 --place 11,48",
         "sub/part.tif", "sub/part.tif"},
        // Files that the driver writes beside OUTPUT, and those that are removed there.
        {"svf o.bil o.asc", "o.prj", "o.prj"},
        {"svf o.bil o.img -of ENVI", "o.hdr", "o.hdr"},
        {"shade o.bmp o.png -co WORLDFILE=YES", "o.wld", "o.wld"},
        {"svf world.tif world.tiff -co TFW=YES", "world.tfw", "world.tfw"},
        {"svf o.tif.ovr o.tif", "o.tif.ovr", "o.tif.ovr"},
        {"svf o.tif.msk o.tif", "o.tif.msk", "o.tif.msk"},
        {"svf o.grd.aux.xml o.grd -of GSBG", "o.grd.aux.xml", "o.grd.aux.xml"},
        // Albedo.
        {"shade dem.tif grey.tif --bounces 1 --albedo albedo.vrt", "grey.tif", "grey.tif"},
        {"shade dem.tif albedo.vrt -of GTiff --bounces 1 --albedo albedo.vrt", "albedo.vrt",
         "albedo.vrt"},
        {"shade one.vrt o.tif --bounces 1 --albedo o.tif.ovr", "o.tif.ovr", "o.tif.ovr"},
        // Panoramas.
        {"shade dem.tif hard.hdr -of GTiff --sky sky.hdr", "hard.hdr", "sky.hdr"},
        {"shade dem.tif soft.exr --sky sky.hdr", "soft.exr", "sky.hdr"},
        {"shade dem.tif sky.bin -of ENVI --sky sky.hdr", "sky.hdr", "sky.hdr"},
        {"render dem.tif sky.hdr -of PNG --sky hard.hdr", "sky.hdr", "hard.hdr"},
        // Maps: layers, what these are made of, the sky.
        {"render m.earth grey.tif", "grey.tif", "grey.tif"},
        {"render m.earth sub/part.tif", "sub/part.tif", "sub/part.tif"},
        {"render dem.tif.terrainlight.0,0,10.rot dem.tif", "dem.tif", "dem.tif"},
        {"svf /vsisubfile/0_100000,q,1.tif q,1.tif", "q,1.tif", "q,1.tif"},
        {"render m.earth.terrainlight one.vrt -of PNG", "one.vrt", "one.vrt"},
        {"render m.earth soft.exr -of PNG", "soft.exr", "sky.hdr"},
        // The measurements of a DEM.
        {"bench three.vrt --csv sub/part.tif", "sub/part.tif", "sub/part.tif"},
        {"bench o.bil --json o.prj", "o.prj", "o.prj"},
    };
    const auto before = contents();
    for (const auto& each : runs)
    {
        SCOPED_TRACE(each.command);
        const ToolRun result = run(each.command);
#ifndef OTL_BENCH
        if (each.command.rfind("bench", 0) == 0)
            continue;
#endif
        EXPECT_EQ(result.status, 2) << result.err;
        EXPECT_EQ(result.out, "");
        EXPECT_TRUE(result.complains(each.refused)) << result.err;
        EXPECT_TRUE(result.complains(each.isMadeOf)) << result.err;
        EXPECT_TRUE(result.complains("needs another name")) << result.err;
        EXPECT_EQ(contents(), before);
    }
}

// A scene of OpenSceneGraph is made of its textures and of the scenes in it.
TEST_F(OutputIsInput, IsRefusedWhereASceneNeedsIt)
{
    translate("dem.tif", "sub/bricks.png", {"-of", "PNG", "-ot", "Byte"});
    std::ofstream(path("sub/part.obj")) << "mtllib part.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                           "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    std::ofstream(path("sub/part.mtl")) << "newmtl a\nmap_Kd bricks.png\n";
    const auto before = contents();
    for (const char* output : {"sub/bricks.png", "link/bricks.png", "./sub/../sub/bricks.png"})
    {
        const ToolRun result = run(std::string("render sub/part.obj ") + output + " --size 32");
        if (result.complains("OpenGL"))
            GTEST_SKIP() << "skipped: no OpenGL 4.3 here (install Mesa's libgl1-mesa-dri): "
                         << result.err;
        EXPECT_EQ(result.status, 2) << result.err;
        EXPECT_EQ(result.out, "");
        EXPECT_TRUE(result.complains("needs another name")) << result.err;
        EXPECT_EQ(contents(), before);
    }
}

// The other way round: names that only look alike are no reason to refuse.
TEST_F(OutputIsInput, OtherFilesAreNot)
{
    fs::copy_file(path("dem.tif"), path("copy.tif"));
    std::ofstream(path("o.tif.aux.xml")) << "<PAMDataset/>"; // of an older output
    for (const char* command : {"svf three.vrt copy.tif", "svf dem.tif o.tif --cell-size 10",
                                "svf copy.tif world.tif", "shade dem.tif soft.tif --sky none"})
    {
        // Stopped where the work would begin, by an OpenGL that is too old; else done.
        const ToolRun result =
            run(command + quick, "export MESA_GL_VERSION_OVERRIDE=3.0 LIBGL_ALWAYS_SOFTWARE=1");
        EXPECT_NE(result.status, 2) << command << result.err;
        EXPECT_FALSE(result.complains("another name")) << result.err;
    }
}

using Output = ToolTest;
using GlOutput = GlToolTest;

// Every signal that ends a program and can be caught, sent when the hidden folder is there: the run
// ends by it, and nothing is left. Without OpenGL, so that the file is most of the work.
TEST_F(Output, SignalsLeaveNothing)
{
    std::vector<int> signals = {SIGHUP,  SIGINT,  SIGQUIT,  SIGILL,    SIGTRAP, SIGABRT,
                                SIGBUS,  SIGFPE,  SIGUSR1,  SIGSEGV,   SIGUSR2, SIGPIPE,
                                SIGALRM, SIGTERM, SIGXCPU,  SIGVTALRM, SIGPROF, SIGIO,
                                SIGSYS,  SIGPWR,  SIGRTMIN, SIGRTMAX};
    for (const int signal : signals)
    {
        const std::string number = std::to_string(signal);
        // exec keeps the shell's process id; a child of it waits for the folder and signals that.
        const ToolRun result =
            run("generate fractal o.tif --size 1500 -q -co COMPRESS=DEFLATE -co ZLEVEL=9",
                "ulimit -c 0 && { (while kill -0 $$ && ! ls -A | grep -q partial; do sleep 0.01; "
                "done; kill -" +
                    number + " $$) >/dev/null 2>&1 & }");
        EXPECT_EQ(result.status, -signal) << result.err;
        EXPECT_TRUE(left().empty()) << number << ": " << *left().begin();
    }
}

// As under nohup: what was ignored when the program began stays so.
TEST_F(Output, AnIgnoredSignalStaysIgnored)
{
    const ToolRun result =
        run("generate fractal o.tif --size 700 -q -co COMPRESS=DEFLATE -co ZLEVEL=9",
            "trap '' HUP && { (while kill -0 $$ && ! ls -A | grep -q partial; do sleep 0.01; "
            "done; kill -HUP $$) >/dev/null 2>&1 & }");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(left(), std::set<std::string>{"o.tif"});
}

// 255 bytes are what a name may have on the usual file systems, 4096 what a path may.
TEST_F(Output, NamesAsLongAsTheyMayBe)
{
    const auto named = [](const std::string& extension, std::size_t length)
    { return std::string(length - extension.size(), 'n') + extension; };
    std::string longPath;
    for (int i = 0; i < 2050; ++i)
        longPath += "./";
    for (const std::string& command : {"svf " + jacksboro + " " + named(".tif", 256),
                                       "shade " + jacksboro + " " + named(".exr", 256),
                                       "shade " + jacksboro + " " + named(".png", 300),
                                       "svf " + jacksboro + " " + longPath + "o.tif",
                                       "generate spikes " + named(".asc", 256) + " --size 8"})
    {
        const ToolRun result = run(command);
        EXPECT_EQ(result.status, 1);
        EXPECT_TRUE(result.complains(": File name too long")) << result.err;
        EXPECT_FALSE(result.complains("ERROR")) << result.err;
        EXPECT_TRUE(left().empty());
    }
    // The others have a sidecar .aux.xml with what they cannot hold.
    for (const auto& [extension, length] :
         {std::pair{".tif", 255u}, {".asc", 247u}, {".bil", 247u}, {".pix", 247u}})
    {
        const std::string name = named(extension, length);
        const ToolRun result = run("generate spikes " + name + " --size 8 -q");
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(left().count(name), 1u);
        for (const std::string& each : left())
            fs::remove(path(each));
    }
    EXPECT_EQ(run("generate spikes " + longPath.substr(0, 3000) + "o.tif --size 8 -q").status, 0);
    EXPECT_EQ(left(), std::set<std::string>{"o.tif"});
    // A sidecar whose name finds no room; without it the file would read well.
    fs::remove(path("o.tif"));
    for (const char* extension : {".asc", ".bil", ".img"})
    {
        const ToolRun result = run("generate spikes " + named(extension, 250) + " --size 8 -q");
        EXPECT_EQ(result.status, 1) << extension;
        EXPECT_TRUE(result.complains("File name too long (Unable to save")) << result.err;
        EXPECT_TRUE(left().empty());
    }
}

// Folders of the kernel refuse the superuser, too; another user's folder needs another user.
TEST_F(Output, FoldersThatCannotBeWritten)
{
    for (const std::string& mode : {"svf " + jacksboro + " ", std::string("generate cliffs ")})
        for (const auto& [output, reason] :
             {std::pair{"/proc/o.tif", "cannot write into /proc: No such file or directory"},
              {"/sys/o.tif", "cannot write into /sys: "},
              {"/dev/full", "is a device or a pipe"},
              {"/dev/null/o.tif", "cannot write into /dev/null: Not a directory"}})
        {
            const ToolRun result = run(mode + output);
            EXPECT_EQ(result.status, 1);
            EXPECT_TRUE(result.complains(std::string(output) + ": " + reason)) << result.err;
        }
    const bool isRoot = geteuid() == 0;
    fs::create_directory(path("locked"));
    std::ofstream(path("locked/old.tif")) << "what was there";
    fs::permissions(path("locked"), fs::perms(0555));
    fs::permissions(folder, fs::perms(0755));
    const std::string with = isRoot ? "setpriv --reuid=65534 --regid=65534 --clear-groups" : "";
    const bool runs = run("--version", ":", with).status == 0;
    for (const char* output : {"locked/o.tif", "locked/old.tif", "locked/o.png", "locked/o.exr"})
    {
        if (!runs)
            break;
        const ToolRun result = run("shade " + jacksboro + " " + output, ":", with);
        EXPECT_EQ(result.status, 1);
        EXPECT_EQ(result.out, "") << "nothing was begun";
        EXPECT_TRUE(
            result.complains(std::string(output) + ": cannot write into locked: Permission denied"))
            << result.err;
    }
    EXPECT_EQ(contentOf(path("locked/old.tif")), "what was there");
    fs::permissions(path("locked"), fs::perms::owner_all);
    if (!runs)
        GTEST_SKIP()
            << "skipped in part: the superuser may write everywhere, and setpriv cannot run the "
               "tool as another user; run as a user, or build where every user may read";
}

// A link stays a link, and the file that it stands for gets the result, in its own folder, with the
// permissions that it had.
TEST_F(Output, LinksAndPermissionsStay)
{
    fs::create_directory(path("store"));
    std::ofstream(path("store/real.asc")) << "what was there";
    std::ofstream(path("store/real.asc.aux.xml")) << "<PAMDataset/>";
    fs::permissions(path("store/real.asc"), fs::perms(0640));
    fs::create_symlink("store/real.asc", path("link.asc"));
    fs::create_symlink("link.asc", path("again.asc"));
    fs::create_symlink("store/new.tif", path("ahead.tif")); // nothing is there yet
    for (const char* output : {"again.asc", "ahead.tif"})
    {
        const ToolRun result = run(std::string("generate spikes ") + output + " --size 8 -q");
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_TRUE(fs::is_symlink(path(output)));
    }
    EXPECT_TRUE(fs::is_symlink(path("link.asc")));
    EXPECT_EQ(ReadRaster(path("store/real.asc")).metadata("TERRAINLIGHT_KIND"), "spikes");
    EXPECT_EQ(ReadRaster(path("store/new.tif")).metadata("TERRAINLIGHT_KIND"), "spikes");
    EXPECT_EQ(fs::status(path("store/real.asc")).permissions(), fs::perms(0640));
    EXPECT_EQ(left(), (std::set<std::string>{"again.asc", "ahead.tif", "link.asc", "store"}));
}

// Memory that ends with the program, archives, streams.
TEST_F(Output, VirtualPlacesAreRefusedBeforeTheWork)
{
    for (const char* output : {"/vsimem/o.tif", "/vsimem/o.exr", "/vsizip/o.zip/o.tif",
                               "/vsigzip/o.tif.gz", "/vsistdout/o.tif"})
        for (const std::string& mode :
             {"shade " + jacksboro + " ", std::string("generate cliffs ")})
        {
            const ToolRun result = run(mode + output);
            EXPECT_EQ(result.status, 1) << output;
            EXPECT_EQ(result.out, "") << "nothing was begun";
            EXPECT_TRUE(result.complains(output)) << result.err;
            EXPECT_TRUE(result.complains("needed the name of a file on disk")) << result.err;
            EXPECT_TRUE(left().empty()) << *left().begin();
        }
}

// A limit of the length of files stands for a full disk; every format ends with the system's words,
// whatever its driver says.
TEST_F(Output, NoRoomIsSaidPlainly)
{
    std::ofstream(path("o.tif")) << "what was there";
    const auto before = left();
    for (const char* output :
         {"o.tif", "o.tif -of COG", "o.pix", "o.grd -of RRASTER", "o.gtx", "o.krx -of KRO",
          "o.lbl -of PDS4", "o.sigdem", "o.dat -of ENVI", "o.asc"})
    {
        const ToolRun result =
            run(std::string("generate fractal ") + output + " --size 150 -q", "ulimit -f 20");
        EXPECT_EQ(result.status, 1) << output;
        EXPECT_TRUE(result.complains("File too large")) << output << ": " << result.err;
        EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << "one line: " << result.err;
        EXPECT_EQ(left(), before) << output;
    }
    EXPECT_EQ(contentOf(path("o.tif")), "what was there");
}

// The same of a disk that is full, in a file system of its own that goes with the process.
TEST_F(GlOutput, AFullDiskIsSaidPlainly)
{
    const std::string small = "unshare -m sh -c 'mount -t tmpfs -o size=40k small small && "
                              "\"$@\"; status=$?; ls -A small >left; exit $status' sh";
    fs::create_directory(path("small"));
    if (run("--version", ":", small).status != 0)
        GTEST_SKIP() << "skipped: unshare -m and mount are refused, so there is no small disk to "
                        "fill; run as the superuser, in a container with CAP_SYS_ADMIN";
    for (const std::string& command :
         {std::string("generate fractal small/o.tif --size 150 -q"),
          std::string("generate fractal small/o.img --size 150 -q"),
          "shade " + jacksboro + " small/o.exr -srcwin 0 0 120 120" + quick,
          "shade " + jacksboro + " small/o.png -srcwin 0 0 200 200" + quick,
          "horizon " + jacksboro +
              " small/o.tif -srcwin 0 0 60 60 -co COMPRESS=DEFLATE -q "
              "--quality draft --azimuths 16"})
    {
        const ToolRun result = run(command, ":", small);
        EXPECT_EQ(result.status, 1) << command;
        EXPECT_TRUE(result.complains("No space left on device")) << result.err;
        EXPECT_EQ(contentOf(path("left")), "") << command;
    }
}

// One metadata item for each option of reading that was given, and none for the others.
TEST_F(GlOutput, SaysHowTheInputWasRead)
{
    GDALAllRegister();
    GDALDatasetUniquePtr dem(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path("d.tif").c_str(), 16, 16, 2, GDT_Float32, nullptr));
    dem.reset();
    const std::map<std::string, std::string> items = {{"TERRAINLIGHT_UNIT", "ft"},
                                                      {"TERRAINLIGHT_Z_FACTOR", "2.5"},
                                                      {"TERRAINLIGHT_CELL_SIZE", "10"},
                                                      {"TERRAINLIGHT_BAND", "2"},
                                                      {"TERRAINLIGHT_SRCWIN", "1,2,8,9"}};
    for (const bool given : {true, false})
    {
        const ToolRun result =
            run(std::string("svf d.tif o.tif --cell-size 10") +
                (given ? " --unit ft --z-factor 2.5 --band 2 -srcwin 1 2 8 9" : "") + quick);
        ASSERT_EQ(result.status, 0) << result.err;
        const ReadRaster written(path("o.tif"));
        for (const auto& [name, value] : items)
            EXPECT_EQ(written.metadata(name.c_str()),
                      given || name == "TERRAINLIGHT_CELL_SIZE" ? value : "")
                << name;
    }
}

// The moment for which coordinates of a dynamic CRS hold, in formats that store it themselves and
// in those with a sidecar; a CRS without one stays without.
TEST_F(GlOutput, KeepsTheCoordinateEpoch)
{
    const struct
    {
        int crs;
        double epoch;
        std::vector<double> place;
    } inputs[] = {{9000, 2010.25, {11.5, 1e-4, 0, 48.1, 0, -1e-4}},  // ITRF2014
                  {32756, 1994.0, {300000, 10, 0, 6200000, 0, -10}}, // WGS 84 / UTM 56S
                  {9990, 2024.75, {140.1, 2e-4, 0, 36.2, 0, -2e-4}}, // ITRF2020
                  {3857, 2005.5, {1280000, 10, 0, 6100000, 0, -10}}, // web Mercator
                  {2056, 0.0, {2600000, 10, 0, 1200000, 0, -10}}};   // static
    for (const auto& input : inputs)
    {
        writeRaster("d.tif", 16, 16, hill(), input.place);
        OGRSpatialReference crs;
        if (crs.importFromEPSG(input.crs) != OGRERR_NONE)
        {
            std::cout << "PROJ does not know EPSG:" << input.crs << ", left out\n";
            continue;
        }
        if (input.epoch > 0.0)
            crs.SetCoordinateEpoch(input.epoch);
        const GDALDatasetUniquePtr change(GDALDataset::Open(path("d.tif").c_str(), GDAL_OF_UPDATE));
        ASSERT_EQ(change->SetSpatialRef(&crs), CE_None);
        change->FlushCache(true);
        for (const char* output :
             {"svf d.tif o.tif", "shade d.tif o.png", "svf d.tif o.tif -of COG",
              "shade d.tif o.jpg --sky none", "horizon d.tif o.vrm -of GTiff"})
        {
            const ToolRun result = run(output + quick);
            ASSERT_EQ(result.status, 0) << output;
            EXPECT_FALSE(result.complains("epoch")) << result.err;
            const ReadRaster written(
                path(std::string(output).substr(std::string(output).find("o."), 5)));
            ASSERT_NE(written.dataset->GetSpatialRef(), nullptr) << output;
            EXPECT_EQ(written.dataset->GetSpatialRef()->GetCoordinateEpoch(), input.epoch)
                << output << ", EPSG:" << input.crs;
        }
        // Formats that have no place for it: said, where there is one.
        for (const char* output : {"svf d.tif o.img -of HFA", "svf d.tif o.bin -of ENVI"})
            EXPECT_EQ(run(output + quick).complains("does not keep the CRS's coordinate epoch"),
                      input.epoch > 0.0)
                << output;
    }
}

// PROJ's data are looked for in PROJ_LIB alone where it is set: a folder without them, with a text
// of that name, with an empty database.
TEST_F(Output, BrokenProjDataAreToldBeforeTheWork)
{
    for (const char* name : {"none", "text", "empty"})
        fs::create_directory(path(name));
    std::ofstream(path("text/proj.db")) << "no database\n";
    std::ofstream(path("empty/proj.db"));
    std::ofstream(path("m.earth")) << "<map><GDALElevation url='" << jacksboro << "'/></map>";
    const auto before = left();
    for (const std::string data : {"none", "text", "empty"})
        for (const std::string& command :
             {"svf " + jacksboro + " o.tif", "shade " + jacksboro + " o.exr",
              "shadow " + jacksboro + " o.tif --time 2024-06-21T10:00Z",
              "sunhours " + jacksboro + " o.tif --from 2024-06-21T00:00 --to 2024-06-22T00:00",
              "render " + jacksboro + " o.png", std::string("render m.earth o.png"),
              "render " + jacksboro + ".terrainlight o.png", "info " + jacksboro,
              "bench " + jacksboro + " --csv o.csv"})
        {
#ifndef OTL_BENCH
            if (command.rfind("bench", 0) == 0)
                continue;
#endif
            const ToolRun result = run(command, "export PROJ_LIB=\"$PWD/" + data +
                                                    "\" PROJ_DATA=\"$PWD/" + data + "\"");
            EXPECT_EQ(result.status, 1) << command;
            EXPECT_TRUE(result.out.empty() || command.rfind("info", 0) == 0) << "nothing was begun";
            EXPECT_TRUE(result.complains("PROJ_LIB")) << command << ": " << result.err;
            EXPECT_EQ(left(), before);
        }
}

} // namespace
