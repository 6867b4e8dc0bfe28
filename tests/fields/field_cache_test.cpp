#include "fields/FieldCache.h"

#include "fields/FieldFile.h"
#include "support/TestFolder.h"
#include "support/TestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

using namespace osgTerrainLight;

namespace
{
BakeOptions coarse()
{
    BakeOptions options;
    options.cells = 16;
    return options;
}

std::string content(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void setContent(const std::string& path, const std::string& bytes)
{
    std::ofstream(path, std::ios::binary) << bytes;
}

void expectSame(const BakedField& a, const BakedField& b)
{
    EXPECT_EQ(a.grid.size, b.grid.size);
    EXPECT_EQ(a.grid.first, b.grid.first);
    EXPECT_EQ(a.grid.spacing, b.grid.spacing);
    EXPECT_EQ(a.grid.distances, b.grid.distances);
    EXPECT_EQ(a.ambiguousShare, b.ambiguousShare);
}

CachedField bakeIn(const FieldCache& cache, const TriangleMesh& mesh,
                   const BakeOptions& options = coarse())
{
    const Result<CachedField> baked = cache.bake(mesh, options);
    EXPECT_TRUE(baked) << baked.error().message;
    return baked ? *baked : CachedField{};
}
} // namespace

// Expected: equal bits, in a folder that did not exist, and nothing but the one file.
TEST(FieldCache, ReadsWhatItMade)
{
    const TriangleMesh mesh = withoutBottom(makeHouse().mesh);
    const std::string folder = (testFolder() / "new" / "fields").string();
    const CachedField made = bakeIn(FieldCache(folder), mesh);
    EXPECT_FALSE(made.isFromFile);
    EXPECT_EQ(made.problem, "");
    EXPECT_GT(made.field.ambiguousShare, 0.0);
    const CachedField read = bakeIn(FieldCache(folder), mesh);
    EXPECT_TRUE(read.isFromFile);
    expectSame(read.field, made.field);
    const auto files = std::filesystem::directory_iterator(folder);
    EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

// Expected: at most half the unit of a file, which is at most 1/16384 of the greatest distance, and
// signs that stay.
TEST(FieldCache, SixteenBitsAreEnough)
{
    BakeOptions options;
    const TriangleMesh mesh = makeHouse().mesh;
    const CachedField kept = bakeIn(FieldCache({}), mesh, options);
    const Result<BakedField> whole = bakeMesh(mesh, options);
    ASSERT_TRUE(whole);
    const auto& expected = whole->grid.distances;
    float greatest = 0.0f;
    for (const float distance : expected)
        greatest = std::max(greatest, std::abs(distance));
    double squares = 0.0, most = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i)
    {
        const float found = kept.field.grid.distances[i];
        const double error = double(std::abs(found - expected[i]) / whole->grid.spacing);
        most = std::max(most, error);
        squares += error * error;
        EXPECT_GE(found * expected[i], 0.0f);
    }
    std::printf("  16 bits, 64 cells: RMS %.5f, greatest %.5f voxels\n",
                std::sqrt(squares / double(expected.size())), most);
    EXPECT_LE(most, double(greatest / whole->grid.spacing) / 32767.0);
}

// Expected: made anew, with the same bits, and whole again.
TEST(FieldCache, DamagedFilesAreMadeAnew)
{
    const TriangleMesh mesh = makeTree(8).mesh;
    const FieldCache cache(testFolder().string());
    const CachedField made = bakeIn(cache, mesh);
    const std::string path = cache.pathOf(mesh, coarse());
    const std::string whole = content(path);
    ASSERT_GT(whole.size(), 1000u);

    std::vector<std::string> damaged = {"", "a picture", whole.substr(0, 50),
                                        whole.substr(0, whole.size() - 1), whole + "x"};
    // One bit in the mark, the version, the key, a size, the spacing, the checksum, a distance.
    for (const std::size_t place : {0u, 8u, 20u, 34u, 35u, 56u, 75u, 80u, 900u})
    {
        damaged.push_back(whole);
        damaged.back()[place] = static_cast<char>(damaged.back()[place] ^ 0x40);
    }
    for (const std::string& bytes : damaged)
    {
        setContent(path, bytes);
        const CachedField again = bakeIn(cache, mesh);
        EXPECT_FALSE(again.isFromFile);
        expectSame(again.field, made.field);
        EXPECT_EQ(content(path), whole);
    }
}

// Expected: the file of another mesh under this one's name is not this one's.
TEST(FieldCache, ForeignFieldsAreMadeAnew)
{
    const FieldCache cache(testFolder().string());
    const TriangleMesh tree = makeTree(8).mesh, other = makeTree(9).mesh;
    bakeIn(cache, other);
    setContent(cache.pathOf(tree, coarse()), content(cache.pathOf(other, coarse())));
    EXPECT_FALSE(bakeIn(cache, tree).isFromFile);
}

TEST(FieldCache, AnyChangeIsAnotherField)
{
    const FieldCache cache(testFolder().string());
    const TriangleMesh mesh = makeTree(8).mesh;
    bakeIn(cache, mesh);
    TriangleMesh moved = mesh, turned = mesh, fewer = mesh;
    moved.vertices.back().z = std::nextafter(moved.vertices.back().z, 100.0f);
    std::swap(turned.triangles[3][0], turned.triangles[3][1]);
    fewer.triangles.pop_back();
    for (const TriangleMesh& changed : {moved, turned, fewer})
        EXPECT_FALSE(bakeIn(cache, changed).isFromFile);
    BakeOptions finer = coarse(), wider = coarse(), followed = coarse();
    finer.cells = 17;
    wider.margin = 5;
    followed.progress = [](double) { return true; };
    EXPECT_FALSE(bakeIn(cache, mesh, finer).isFromFile);
    EXPECT_FALSE(bakeIn(cache, mesh, wider).isFromFile);
    EXPECT_TRUE(bakeIn(cache, mesh, followed).isFromFile);
}

// Expected: the field all the same, and a sentence with the file and the reason.
TEST(FieldCache, AFolderThatCannotBeIsNoError)
{
    const std::string file = (testFolder() / "file").string();
    setContent(file, "in the way");
    const CachedField made = bakeIn(FieldCache(file + "/fields"), makeTree(8).mesh);
    EXPECT_FALSE(made.field.grid.distances.empty());
    EXPECT_NE(made.problem.find(file), std::string::npos) << made.problem;
}

// Expected: every one has the field, and the file is whole. Threads stand for processes: both put
// files of their own in place.
TEST(FieldCache, SeveralAtOnce)
{
    const FieldCache cache(testFolder().string());
    const TriangleMesh mesh = makeTree(8).mesh;
    const CachedField expected = bakeIn(FieldCache({}), mesh);
    std::vector<CachedField> found(4);
    std::vector<std::thread> threads;
    for (CachedField& field : found)
        threads.emplace_back([&] { field = bakeIn(cache, mesh); });
    for (std::thread& thread : threads)
        thread.join();
    for (const CachedField& field : found)
    {
        EXPECT_EQ(field.problem, "");
        expectSame(field.field, expected.field);
    }
    EXPECT_TRUE(bakeIn(cache, mesh).isFromFile);
}
