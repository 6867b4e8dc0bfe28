#include "scene/WorkClock.h"

#include "support/GlContext.h"

#include <osg/GLExtensions>
#include <osg/GLObjects>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

using namespace osgTerrainLight;

namespace
{
/// Queries that exist in the current context, of the first names, which drivers give out in order.
int queriesThatExist(const osg::GLExtensions& gl)
{
    int count = 0;
    for (GLuint name = 1; name <= 4096; ++name)
        count += gl.glIsQuery(name) ? 1 : 0;
    return count;
}
} // namespace

// Expected: none of a clock that is gone, once its context has flushed what is gone.
TEST(WorkClock, GivesItsQueriesBack)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto* gl = state.get<osg::GLExtensions>();
    if (!gl->isARBTimerQuerySupported)
        GTEST_SKIP() << "skipped: this OpenGL driver has no timer queries (ARB_timer_query); needs "
                        "one that has, such "
                        "as Mesa's";
    const auto capabilities = GpuCapabilities::query(state);
    const bool isSoftware = capabilities && capabilities->isSoftware(); // whose time the wall tells
    const int before = queriesThatExist(*gl);
    auto clock = std::make_unique<WorkClock>();
    for (const int steps : {3, 1}) // in the end some wait for their time, and some to be used again
    {
        clock->begin(state);
        for (int step = 0; step < steps; ++step)
            clock->step(state, "a", 100);
        glFinish();
    }
    if (isSoftware)
        EXPECT_EQ(queriesThatExist(*gl), before);
    else
        EXPECT_GE(queriesThatExist(*gl), before + 4);
    clock.reset();
    osg::flushAllDeletedGLObjects(state.getContextID());
    EXPECT_EQ(queriesThatExist(*gl), before);
    EXPECT_EQ(takeGlErrors(), "");
}

namespace
{
/// A frame on a clock that only moves when a piece runs.
class PacedFrames : public testing::Test
{
protected:
    PacedFrames() : _clock([this] { return _time; }) {}

    /// What runs of a dispatch of so many groups in a frame with this budget [groups]; each takes
    /// so long [ms].
    unsigned frame(osg::State& state, const std::string& kind, unsigned groups, double each,
                   double budget, unsigned least = 1)
    {
        _clock.begin(state);
        FramePace pace(_clock, state, budget);
        unsigned done = 0;
        _most = 0;
        while (const unsigned now = done < groups ? pace.next(kind, groups - done, least) : 0)
        {
            _time += each * now;
            pace.ran(kind, now);
            done += now;
            _most = std::max(_most, now);
        }
        _spent = _clock.spent();
        _clock.end();
        EXPECT_EQ(pace.isStopped(), done < groups);
        return done;
    }

    double _time = 0.0;
    WorkClock _clock;
    double _spent = 0.0;
    unsigned _most = 0; ///< groups of a piece
};
} // namespace

// Expected: what was never measured begins with four groups; then pieces of an eighth of the budget
// fill it, and the last one ends with it.
TEST_F(PacedFrames, FillTheirBudget)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    EXPECT_EQ(frame(state, "a", 1000, 2.0, 50.0), 25u);
    EXPECT_EQ(_most, 4u);
    EXPECT_EQ(frame(state, "a", 1000, 2.0, 50.0), 25u);
    EXPECT_EQ(_most, 3u); // of 6.25 ms
    EXPECT_DOUBLE_EQ(_spent, 50.0);
    EXPECT_EQ(frame(state, "a", 10, 2.0, 50.0), 10u);
    EXPECT_EQ(frame(state, "a", 1000, 2.0, 0.0), 1000u) << "no budget";
    EXPECT_EQ(_most, 1000u);
}

// Expected: never more than 1.2 times the budget where pieces take what they took before, or up to
// 1.8 times as much: 1.1 + 0.8 / 8. A piece that alone takes longer runs, and nothing with it.
TEST_F(PacedFrames, KeepTheirBudgetWithinAFifth)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    for (const double each : {0.001, 0.3, 5.0, 6.0, 19.0, 27.0, 49.0})
    {
        const std::string kind = std::to_string(each);
        frame(state, kind, 4, each, 50.0);
        for (int i = 0; i < 20; ++i)
        {
            EXPECT_GT(frame(state, kind, 1u << 20, each, 50.0), 0u);
            EXPECT_LE(_spent, 60.0) << each;
            EXPECT_GE(_spent, std::min(27.0, each)) << each;
        }
    }
    frame(state, "dearer", 4, 1.0, 50.0);
    EXPECT_GT(frame(state, "dearer", 1000, 1.8, 50.0), 0u);
    EXPECT_LE(_spent, 60.0);
    EXPECT_EQ(frame(state, "long", 4, 70.0, 50.0), 4u) << "not known before";
    EXPECT_EQ(frame(state, "long", 4, 70.0, 50.0), 1u);
    EXPECT_EQ(frame(state, "whole", 100, 1.0, 50.0, 100), 100u);
    EXPECT_EQ(frame(state, "whole", 100, 1.0, 50.0, 100), 100u) << "is not cut";
}

// Expected: groups that happen to take next to nothing, a few at the end of a frame or many in a
// tile without ground, do not make a later piece much too long: a piece grows to twice as many
// groups at most, and takes four eighths of the budget by the mean, and what is left of 1.1
// budgets.
TEST_F(PacedFrames, CheapGroupsSayLittleOfOthers)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    for (int i = 0; i < 20; ++i)
        frame(state, "a", 1000, 0.4, 50.0);
    for (const unsigned cheap : {3u, 7u, 15u, 60u})
    {
        frame(state, "a", cheap, 1.0e-3, 50.0);
        for (int i = 0; i < 20; ++i)
        {
            EXPECT_GT(frame(state, "a", 1000, 0.4, 50.0), 60u);
            EXPECT_LE(_spent, 60.0) << cheap;
            EXPECT_LE(_most, 70u) << cheap; // of 0.4 ms, and a mean that still knows the cheap ones
        }
    }
}

// Expected: a kind that was never measured waits for the beginning of a frame; a first piece that
// compiled shaders does not slow the later ones down.
TEST_F(PacedFrames, MeasureWhatIsNewFirst)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    EXPECT_EQ(frame(state, "a", 4, 100.0, 50.0), 4u);
    EXPECT_NEAR(frame(state, "a", 1000, 0.1, 50.0), 500.0, 1.0); // by the rounding of sums
    _clock.begin(state);
    FramePace pace(_clock, state, 50.0);
    EXPECT_GT(pace.next("a", 10, 1), 0u);
    pace.ran("a", 1);
    EXPECT_EQ(pace.next("new", 10, 1), 0u);
    EXPECT_TRUE(pace.isStopped());
}
