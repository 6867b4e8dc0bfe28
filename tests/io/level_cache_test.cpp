#include "io/RasterSource.h"

#include "support/LevelChecks.h"
#include "support/MemoryRaster.h"
#include "support/TestFolder.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

using namespace osgTerrainLight;
namespace fs = std::filesystem;

namespace
{
const std::string suffix = ".terrainlight-levels";

MemoryRaster ramp(int width, int height, double first)
{
    MemoryRaster raster;
    raster.width = width;
    raster.height = height;
    raster.values.clear();
    for (int i = 0; i < width * height; ++i)
        raster.values.push_back(first + (i * 37) % 101);
    raster.creation = {"COMPRESS=DEFLATE", "BLOCKYSIZE=16"};
    return raster;
}

/// A copy of a raster in memory, in the test's folder.
std::string onDisk(const MemoryRaster& raster, const std::string& name)
{
    const std::string path = (testFolder() / name).string();
    EXPECT_EQ(CPLCopyFile(path.c_str(), raster.write().c_str()), 0);
    return path;
}

std::set<std::string> files()
{
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(testFolder()))
        names.insert(entry.path().filename().string());
    return names;
}

/// Opens a source and counts how often it told of progress: never where it made no levels.
struct Opened
{
    std::unique_ptr<RasterSource> source;
    int steps = 0;
    std::string error;

    bool says(const std::string& words) const
    {
        for (const std::string& note : source->notes())
            if (note.find(words) != std::string::npos)
                return true;
        return false;
    }
};

Opened open(const std::string& path, RasterSourceOptions options = {})
{
    Opened opened;
    double before = 0.0;
    options.read.progress = [&](double done)
    {
        EXPECT_GE(done, before);
        EXPECT_LE(done, 1.0);
        before = done;
        ++opened.steps;
        return true;
    };
    auto source = RasterSource::open(path, options);
    if (source)
        opened.source = std::move(*source);
    else
        opened.error = source.error().message;
    return opened;
}

class XdgCache
{
public:
    explicit XdgCache(const std::string& folder) { setenv("XDG_CACHE_HOME", folder.c_str(), 1); }
    ~XdgCache() { unsetenv("XDG_CACHE_HOME"); }
};

void expectSameLevels(TileSource& a, TileSource& b)
{
    ASSERT_EQ(a.lastLevel(), b.lastLevel());
    for (int level = 1; level <= a.lastLevel(); ++level)
    {
        const auto first = a.readLevel(level, CrestAxis::North, a.extent(level));
        const auto second = b.readLevel(level, CrestAxis::North, a.extent(level));
        ASSERT_TRUE(first && second);
        for (std::size_t i = 0; i < first->size(); ++i)
            EXPECT_TRUE(sameHeight(first->values()[i], second->values()[i])) << level;
    }
}
} // namespace

TEST(LevelCache, IsKeptBesideTheRasterAndUsedAgain)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    const Opened first = open(path);
    ASSERT_TRUE(first.source) << first.error;
    EXPECT_GT(first.steps, 0);
    EXPECT_TRUE(first.source->notes().empty());
    EXPECT_EQ(files(), (std::set<std::string>{"a.tif", "a.tif" + suffix}));
    const auto time = fs::last_write_time(path + suffix);
    const Opened second = open(path);
    ASSERT_TRUE(second.source);
    EXPECT_EQ(second.steps, 0);
    EXPECT_EQ(fs::last_write_time(path + suffix), time);
    expectSameLevels(*first.source, *second.source);
    EXPECT_EQ(second.source->heightOrigin(), first.source->heightOrigin());
    EXPECT_EQ(second.source->lowest(), 0.0);
    EXPECT_EQ(second.source->highest(), 100.0);
}

// What the first pass decided for the whole raster holds without one, to the note.
TEST(LevelCache, KeepsVoidsByCustomAndNotes)
{
    MemoryRaster raster = ramp(40, 30, 0);
    raster.values[17] = -9999;
    const std::string path = onDisk(raster, "a.tif");
    const Opened first = open(path);
    const Opened second = open(path);
    ASSERT_TRUE(first.source && second.source);
    EXPECT_EQ(second.steps, 0);
    EXPECT_TRUE(second.says("1 post of -9999"));
    EXPECT_EQ(first.source->notes(), second.source->notes());
    EXPECT_TRUE(std::isnan(second.source->readPosts({17, 29, 1, 1})->at(0, 0)));
}

TEST(LevelCache, IsMadeAnewWhenTheRasterChanges)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    ASSERT_TRUE(open(path).source);
    onDisk(ramp(80, 60, 700), "a.tif"); // of the same size, in the same second perhaps
    const Opened again = open(path);
    ASSERT_TRUE(again.source) << again.error;
    EXPECT_GT(again.steps, 0);
    EXPECT_TRUE(again.says("another state of the raster"));
    EXPECT_EQ(again.source->lowest(), 700.0);
    expectLevelsOfPosts(*again.source, again.source->lastLevel());
}

TEST(LevelCache, IsMadeAnewForOtherOptions)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    ASSERT_TRUE(open(path).source);
    RasterSourceOptions options;
    options.read.heightFactor = 2.0;
    const Opened doubled = open(path, options);
    ASSERT_TRUE(doubled.source);
    EXPECT_GT(doubled.steps, 0);
    EXPECT_EQ(doubled.source->highest(), 200.0);
    options.read.window = PixelWindow{3, 5, 40, 30};
    EXPECT_GT(open(path, options).steps, 0);
    EXPECT_EQ(open(path, options).steps, 0);
}

TEST(LevelCache, DamagedFilesAreMadeAnew)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    ASSERT_TRUE(open(path).source);
    const auto size = fs::file_size(path + suffix);
    const auto expectAnew = [&](const char* what)
    {
        const Opened again = open(path);
        ASSERT_TRUE(again.source) << what << again.error;
        EXPECT_GT(again.steps, 0) << what;
        EXPECT_TRUE(again.says("made anew")) << what;
        expectLevelsOfPosts(*again.source, again.source->lastLevel());
    };
    for (const std::uintmax_t length : {std::uintmax_t(0), std::uintmax_t(20), size / 2, size - 1})
    {
        fs::resize_file(path + suffix, length);
        expectAnew("truncated");
    }
    std::ofstream(path + suffix) << "something else, but longer than the head of such a file";
    expectAnew("another file");
    {
        std::fstream file(path + suffix, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(-5, std::ios::end);
        file << '#';
    }
    expectAnew("a changed letter");
    EXPECT_EQ(open(path).steps, 0);
}

TEST(LevelCache, GoesIntoAFolder)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    RasterSourceOptions options;
    options.cacheFolder = (testFolder() / "deep" / "cache").string();
    ASSERT_TRUE(open(path, options).source);
    EXPECT_EQ(files(), (std::set<std::string>{"a.tif", "deep"}));
    EXPECT_EQ(open(path, options).steps, 0);
    // Another raster of that name keeps its own.
    fs::create_directory(testFolder() / "other");
    fs::copy(path, testFolder() / "other" / "a.tif");
    EXPECT_GT(open((testFolder() / "other" / "a.tif").string(), options).steps, 0);
    EXPECT_EQ(open(path, options).steps, 0);
}

// An archive cannot be written into; nor can a file be where a folder is.
TEST(LevelCache, GoesToTheUsersFolderWhereTheRastersCannotBeWritten)
{
    const XdgCache cache((testFolder() / "user").string());
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    fs::create_directory(path + suffix);
    const Opened blocked = open(path);
    ASSERT_TRUE(blocked.source) << blocked.error;
    EXPECT_TRUE(blocked.says("coarse levels are kept in " + (testFolder() / "user").string()));
    EXPECT_EQ(open(path).steps, 0);

    const std::string zip = (testFolder() / "b.zip").string();
    ASSERT_EQ(CPLCopyFile(("/vsizip/" + zip + "/b.tif").c_str(), path.c_str()), 0);
    const Opened zipped = open("/vsizip/" + zip + "/b.tif");
    ASSERT_TRUE(zipped.source) << zipped.error;
    EXPECT_EQ(open("/vsizip/" + zip + "/b.tif").steps, 0);
    expectSameLevels(*blocked.source, *zipped.source);
}

// Overviews that hold other heights than the raster are not looked at.
TEST(LevelCache, StaleOverviewsDoNoHarm)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    const std::string other = onDisk(ramp(80, 60, 5000), "b.tif");
    {
        const GDALDatasetUniquePtr dataset(GDALDataset::Open(other.c_str(), GDAL_OF_RASTER));
        const int steps[] = {2, 4, 8};
        ASSERT_EQ(dataset->BuildOverviews("AVERAGE", 3, const_cast<int*>(steps), 0, nullptr,
                                          nullptr, nullptr),
                  CE_None);
    }
    fs::rename(other + ".ovr", path + ".ovr");
    const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
    ASSERT_EQ(dataset->GetRasterBand(1)->GetOverviewCount(), 3); // GDAL takes them for its own
    const Opened opened = open(path);
    ASSERT_TRUE(opened.source) << opened.error;
    EXPECT_EQ(opened.source->highest(), 100.0);
    expectLevelsOfPosts(*opened.source, opened.source->lastLevel());
    fs::remove(path + ".ovr"); // and they do not count for the state of the raster
    EXPECT_EQ(open(path).steps, 0);
}

// A block of rows 32 ... 47 holds no DEFLATE data any more.
TEST(LevelCache, UnreadableBlockIsAnErrorWithItsRows)
{
    const std::string path = onDisk(ramp(80, 64, 0), "a.tif");
    const auto spoil = [&path]
    {
        std::string place;
        {
            const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
            const char* at = dataset->GetRasterBand(1)->GetMetadataItem("BLOCK_OFFSET_0_2", "TIFF");
            ASSERT_NE(at, nullptr);
            place = at;
        }
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(std::stol(place));
        file << std::string(60, '\xff');
    };
    const std::string whole = path + ".whole";
    fs::copy(path, whole);
    spoil();
    const Opened unread = open(path);
    ASSERT_FALSE(unread.source);
    EXPECT_NE(unread.error.find(path), std::string::npos) << unread.error;
    EXPECT_NE(unread.error.find("rows 32 to 47 of 64"), std::string::npos) << unread.error;
    EXPECT_EQ(files(), (std::set<std::string>{"a.tif", "a.tif.whole"}));

    // Damage that comes later is met where the rows are read, and only there.
    fs::copy(whole, path, fs::copy_options::overwrite_existing);
    const auto time = fs::last_write_time(path);
    ASSERT_TRUE(open(path).source);
    spoil();
    fs::last_write_time(path, time);
    const Opened opened = open(path);
    ASSERT_TRUE(opened.source) << opened.error;
    EXPECT_EQ(opened.steps, 0);
    EXPECT_TRUE(opened.source->readPosts({0, 0, 80, 16})); // rows 48 ... 63 of the file
    const auto spoilt = opened.source->readPosts({0, 20, 80, 4});
    ASSERT_FALSE(spoilt);
    EXPECT_NE(spoilt.error().message.find("rows 40 to 43"), std::string::npos)
        << spoilt.error().message;
}

TEST(LevelCache, FullDiskIsAnErrorThatLeavesNothing)
{
    MemoryRaster raster = ramp(600, 400, 0);
    const std::string path = onDisk(raster, "a.tif");
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 200000; // the levels take 660 kB
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const Opened full = open(path);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    ASSERT_FALSE(full.source);
    EXPECT_NE(full.error.find("a.tif" + suffix + ": cannot write"), std::string::npos)
        << full.error;
    EXPECT_NE(full.error.find("File too large"), std::string::npos) << full.error;
    EXPECT_EQ(files(), std::set<std::string>{"a.tif"});
    EXPECT_TRUE(open(path).source);
}

TEST(LevelCache, CancelledPassLeavesNothing)
{
    const std::string path = onDisk(ramp(80, 60, 0), "a.tif");
    for (const double limit : {0.0, 0.3, 0.5, 0.9})
    {
        RasterSourceOptions options;
        options.read.progress = [limit](double done) { return done <= limit; };
        const auto source = RasterSource::open(path, options);
        ASSERT_FALSE(source);
        EXPECT_NE(source.error().message.find("cancelled"), std::string::npos);
        EXPECT_EQ(files(), std::set<std::string>{"a.tif"});
    }
}
