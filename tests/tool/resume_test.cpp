// Runs in windows that end before they are done: killed, interrupted, refused, shared by jobs.
#include "ToolRun.h"

#include <csignal>
#include <random>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

const std::string options = " --quality draft --azimuths 8 --window-size 64";

class Resume : public GlToolTest
{
protected:
    void SetUp() override
    {
        GlToolTest::SetUp();
        if (IsSkipped())
            return;
        ASSERT_EQ(run("generate fractal d.tif --size 330,270 --seed 5 -q").status, 0); // 30 windows
    }

    /// What a run writes that nobody disturbs.
    std::string undisturbed(const std::string& more = "") const
    {
        EXPECT_EQ(run("svf d.tif whole.tif -q" + options + more).status, 0);
        return contentOf(path("whole.tif"));
    }

    /// So many windows of o.tif are computed.
    void begin(int windows, const std::string& more = "") const
    {
        const ToolRun result =
            run("svf d.tif o.tif -q --job 1/" + std::to_string(30 / windows) + options + more);
        ASSERT_EQ(result.status, 0) << result.err;
        ASSERT_EQ(parts(), static_cast<std::size_t>(windows));
    }

    std::size_t parts() const
    {
        std::size_t count = 0;
        std::error_code failure;
        for (const auto& entry :
             std::filesystem::directory_iterator(path(".o.tif.windows"), failure))
            count += entry.path().filename().string().rfind("window-", 0) == 0;
        return count;
    }
};

// -9 at moments of which nothing is known: the same command goes on, to the same bytes.
TEST_F(Resume, AfterKillTheSameCommandGoesOnToTheSameBytes)
{
    const std::string expected = undisturbed();
    std::mt19937 random(11);
    std::uniform_real_distribution<double> delay(0.2, 2.0);
    int killed = 0;
    std::size_t before = 0;
    for (int run_ = 0; run_ < 8 && !std::filesystem::exists(path("o.tif")); ++run_)
    {
        const ToolRun result =
            run("svf d.tif o.tif" + options, "{ (sleep " + std::to_string(delay(random)) +
                                                 "; kill -KILL $$) >/dev/null 2>&1 & }");
        killed += result.status == -SIGKILL;
        if (before > 0)
        {
            EXPECT_NE(result.out.find("going on: "), std::string::npos) << result.out;
        }
        if (result.status == 0)
            break;
        EXPECT_EQ(result.status, -SIGKILL) << result.err;
        EXPECT_GE(parts(), before) << "nothing is lost that was done";
        before = parts();
    }
    EXPECT_GT(killed, 0);
    EXPECT_EQ(run("svf d.tif o.tif -q" + options).status, 0);
    EXPECT_TRUE(contentOf(path("o.tif")) == expected);
    EXPECT_EQ(left(), (std::set<std::string>{"d.tif", "whole.tif", "o.tif"}));
}

TEST_F(Resume, InterruptedSaysHowToGoOn)
{
    const ToolRun result = run("svf d.tif o.tif -q --quality best --azimuths 64 --window-size 64",
                               "{ (sleep 1.5; kill -TERM $$) >/dev/null 2>&1 & }");
    ASSERT_EQ(result.status, -SIGTERM) << result.err;
    EXPECT_TRUE(result.complains("terrainlight: interrupted: ")) << result.err;
    EXPECT_TRUE(result.complains(" of 30 windows are done; the same command goes on"))
        << result.err;
    EXPECT_FALSE(std::filesystem::exists(path("o.tif")));
}

TEST_F(Resume, AnotherOptionOrInputStartsAnew)
{
    begin(10);
    const ToolRun other =
        run("svf d.tif o.tif --job 1/30 --quality draft --azimuths 16 --window-size 64");
    EXPECT_EQ(other.status, 0) << other.err;
    EXPECT_NE(other.out.find("svf: starting anew: --azimuths was '8', now it is '16'\n"),
              std::string::npos)
        << other.out;
    EXPECT_EQ(parts(), 1u);
    const ToolRun added = run("svf d.tif o.tif --job 1/30 --definition horizontal" + options);
    EXPECT_NE(added.out.find("starting anew: --azimuths was '16', now it is '8'"),
              std::string::npos)
        << added.out;
    ASSERT_EQ(run("generate fractal d.tif --size 330,270 --seed 6 -q").status, 0);
    const ToolRun file = run("svf d.tif o.tif --definition horizontal" + options);
    EXPECT_EQ(file.status, 0) << file.err;
    EXPECT_NE(file.out.find("d.tif has changed\n"), std::string::npos) << file.out;
    EXPECT_TRUE(contentOf(path("o.tif")) == undisturbed(" --definition horizontal"));
}

// Windows that another command left have nothing to do with a raster that fits.
TEST_F(Resume, PartsOfAnotherCommandAreLeftAlone)
{
    begin(15);
    const ToolRun result = run("svf d.tif o.tif --azimuths 4");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out.find("window"), std::string::npos) << result.out;
    EXPECT_EQ(ReadRaster(path("o.tif")).metadata("TERRAINLIGHT_WINDOWS"), "");
}

// What is said of the data in one piece is said by jobs, too.
TEST_F(Resume, JobsSayWhatIsAssumed)
{
    std::vector<float> heights(120 * 90, 200.0f);
    std::fill_n(heights.begin() + 1000, 300, -32768.0f);
    writeRaster("v.tif", 120, 90, heights, {0, 30, 0, 2700, 0, -30}, -1.0);
    EXPECT_TRUE(run("svf v.tif one.tif --azimuths 4").complains("taken as void"));
    const ToolRun job = run("svf v.tif o.tif --azimuths 4 --window-size 64 --job 1/2");
    EXPECT_TRUE(job.complains("taken as void")) << job.err;
}

// How a result is stored does not matter to its values.
TEST_F(Resume, AnotherFormatGoesOn)
{
    begin(15);
    const ToolRun result = run("svf d.tif o.tif -co COMPRESS=LZW" + options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("svf: going on: 15 of 30 windows were done\n"), std::string::npos)
        << result.out;
}

TEST_F(Resume, TwoRunsAtOnceAreRefused)
{
    begin(1);
    const int lock = open(path(".o.tif.windows/use.lock").c_str(), O_RDWR);
    ASSERT_EQ(flock(lock, LOCK_EX), 0);
    for (const std::string job : {"", " --job 2/3"})
    {
        const ToolRun second = run("svf d.tif o.tif -q" + options + job);
        EXPECT_EQ(second.status, 1);
        EXPECT_TRUE(second.complains("o.tif: ")) << second.err;
        EXPECT_TRUE(second.complains("run is at work on it already")) << second.err;
    }
    ASSERT_EQ(flock(lock, LOCK_SH), 0); // as a job has it
    const ToolRun whole = run("svf d.tif o.tif -q" + options);
    EXPECT_EQ(whole.status, 1);
    EXPECT_TRUE(whole.complains("another run is at work on it already")) << whole.err;
    const ToolRun other = run("svf d.tif o.tif -q --job 2/3 --definition horizontal" + options);
    EXPECT_EQ(other.status, 1);
    EXPECT_TRUE(other.complains("other jobs are at work on it with other input or options"))
        << other.err;
    EXPECT_EQ(parts(), 1u) << "theirs stay";
    close(lock);
    EXPECT_EQ(run("svf d.tif o.tif -q" + options).status, 0);
}

TEST_F(Resume, JobsAtOnceThenOneThatJoins)
{
    const std::string job = "' svf d.tif o.tif -q" + options + " --job ";
    const ToolRun jobs = run("svf d.tif o.tif" + options + " --job 1/3",
                             "{ '" + std::string(OTL_TOOL) + job + "2/3 & '" +
                                 std::string(OTL_TOOL) + job + "3/3 & }");
    EXPECT_EQ(jobs.status, 0) << jobs.err;
    EXPECT_NE(jobs.out.find("svf: job 1 of 3 is done, "), std::string::npos) << jobs.out;
    EXPECT_FALSE(std::filesystem::exists(path("o.tif")));
    ToolRun joined;
    for (int turn = 0; turn < 20; ++turn) // the others may still be at work
    {
        joined = run("svf d.tif o.tif" + options);
        if (joined.status == 0)
            break;
        EXPECT_TRUE(joined.complains("is at work on it already")) << joined.err;
    }
    EXPECT_NE(joined.out.find("svf: going on: "), std::string::npos) << joined.out;
    EXPECT_NE(joined.out.find("svf: joining 30 of 30 windows\n"), std::string::npos);
    EXPECT_TRUE(contentOf(path("o.tif")) == undisturbed());
    EXPECT_EQ(left(), (std::set<std::string>{"d.tif", "whole.tif", "o.tif"}));
}

TEST_F(Resume, WrongSharesAreMistakes)
{
    for (const char* job : {"0/3", "4/3", "1", "1/", "/3", "1/3x", "a/b", "-1/3"})
    {
        const ToolRun result = run("svf d.tif o.tif -q --job " + std::string(job));
        EXPECT_EQ(result.status, 2) << job;
        EXPECT_TRUE(result.complains("--job")) << result.err;
    }
    EXPECT_EQ(left(), std::set<std::string>{"d.tif"});
}

// A part that was damaged on the disk is found when it is joined, and computed again.
TEST_F(Resume, ADamagedPartIsComputedAgain)
{
    const std::string expected = undisturbed();
    begin(30);
    const std::string part = path(".o.tif.windows/window-000017.tif");
    std::string content = contentOf(part);
    ASSERT_GT(content.size(), 3000u);
    for (std::size_t i = content.size() / 2; i < content.size() / 2 + 200; ++i)
        content[i] = static_cast<char>(~content[i]);
    std::ofstream(part, std::ios::binary) << content;
    const ToolRun broken = run("svf d.tif o.tif -q" + options);
    EXPECT_EQ(broken.status, 1);
    EXPECT_TRUE(broken.complains("window 17: ")) << broken.err;
    EXPECT_TRUE(broken.complains("29 of 30 windows are done; the same command goes on"))
        << broken.err;
    EXPECT_FALSE(std::filesystem::exists(path("o.tif")));
    EXPECT_EQ(run("svf d.tif o.tif -q" + options).status, 0);
    EXPECT_TRUE(contentOf(path("o.tif")) == expected);
}

// Blocks in the middle of the input that can no longer be read, though its size and time are those
// of before: a disk that fails.
TEST_F(Resume, AnUnreadableWindowIsNamedAndTheOthersStay)
{
    ASSERT_EQ(run("generate fractal z.tif --size 330,270 -q -co TILED=YES -co BLOCKXSIZE=64 "
                  "-co BLOCKYSIZE=64 -co COMPRESS=DEFLATE")
                  .status,
              0);
    ASSERT_EQ(run("svf z.tif o.tif -q --job 1/30" + options).status, 0); // makes coarse levels
    const auto time = std::filesystem::last_write_time(path("z.tif"));
    const std::string whole = contentOf(path("z.tif"));
    std::string damaged = whole;
    for (std::size_t i = damaged.size() * 3 / 4; i < damaged.size() * 3 / 4 + 3000; ++i)
        damaged[i] = '\x55';
    std::ofstream(path("z.tif"), std::ios::binary) << damaged;
    std::filesystem::last_write_time(path("z.tif"), time);
    const ToolRun result = run("svf z.tif o.tif" + options);
    ASSERT_EQ(result.status, 1) << result.out;
    EXPECT_TRUE(result.complains("terrainlight: window ")) << result.err;
    EXPECT_TRUE(result.complains(" of z.tif): z.tif: cannot read")) << result.err;
    EXPECT_TRUE(result.complains("; the same command goes on from there")) << result.err;
    EXPECT_GT(parts(), 5u);
    EXPECT_FALSE(std::filesystem::exists(path("o.tif")));
    std::ofstream(path("z.tif"), std::ios::binary) << whole;
    std::filesystem::last_write_time(path("z.tif"), time);
    const ToolRun mended = run("svf z.tif o.tif" + options);
    EXPECT_EQ(mended.status, 0) << mended.err;
    EXPECT_NE(mended.out.find("going on: "), std::string::npos) << mended.out;
}

// A limit on the size of files stands in for a full disk: writing fails in the same place.
TEST_F(Resume, ADiskThatIsFullKeepsWhatIsDone)
{
    const std::string expected = undisturbed();
    const ToolRun part = run("svf d.tif o.tif -q" + options, "ulimit -f 8"); // 4 or 8 KiB
    EXPECT_EQ(part.status, 1);
    EXPECT_TRUE(part.complains("window 1 of 30 (columns 0 to 63, rows 0 to 63 of d.tif): "))
        << part.err;
    EXPECT_TRUE(part.complains("File too large")) << part.err;
    EXPECT_TRUE(part.complains("0 of 30 windows are done; the same command goes on")) << part.err;
    const ToolRun join = run("svf d.tif o.tif -q" + options, "ulimit -f 80"); // parts fit
    EXPECT_EQ(join.status, 1);
    EXPECT_TRUE(join.complains("o.tif: ")) << join.err;
    EXPECT_TRUE(join.complains("File too large")) << join.err;
    EXPECT_TRUE(join.complains("30 of 30 windows are done; the same command goes on")) << join.err;
    EXPECT_FALSE(std::filesystem::exists(path("o.tif")));
    const ToolRun result = run("svf d.tif o.tif" + options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("going on: 30 of 30 windows were done"), std::string::npos);
    EXPECT_TRUE(contentOf(path("o.tif")) == expected);
    EXPECT_EQ(left(), (std::set<std::string>{"d.tif", "whole.tif", "o.tif"}));
}

// What a run wrote that was killed while it joined goes with its folder.
TEST_F(Resume, HalfWrittenFilesGoWithTheFolder)
{
    begin(30);
    std::filesystem::create_directories(path(".o.tif.windows/.partial-1-0"));
    std::ofstream(path(".o.tif.windows/.partial-1-0/o.tif")) << "half";
    EXPECT_EQ(run("svf d.tif o.tif -q" + options).status, 0);
    EXPECT_EQ(left(), (std::set<std::string>{"d.tif", "o.tif"}));
}

} // namespace
