#include "scene/WorkClock.h"

#include "support/GlContext.h"

#include <osg/GLExtensions>
#include <osg/GLObjects>

#include <gtest/gtest.h>

#include <memory>

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
    const int before = queriesThatExist(*gl);
    auto clock = std::make_unique<WorkClock>();
    for (const int steps : {3, 1}) // in the end some wait for their time, and some to be used again
    {
        clock->begin(state);
        for (int step = 0; step < steps; ++step)
            clock->step(state, 100.0);
        glFinish();
    }
    EXPECT_GE(queriesThatExist(*gl), before + 4);
    clock.reset();
    osg::flushAllDeletedGLObjects(state.getContextID());
    EXPECT_EQ(queriesThatExist(*gl), before);
    EXPECT_EQ(takeGlErrors(), "");
}
