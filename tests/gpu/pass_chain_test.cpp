#include "gpu/PassChain.h"

#include "gpu/GpuPass.h"
#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

using namespace osgTerrainLight;

namespace
{
/// A chain whose stages only write down that they ran. It needs no OpenGL.
class PassChainTest : public testing::Test
{
protected:
    using Value = PassChain::Value;

    Value stage(const std::string& name, std::vector<Value> inputs, std::size_t bytes = 0)
    {
        _needed[name] = true;
        PassChain::Stage stage;
        stage.name = name;
        stage.inputs = std::move(inputs);
        stage.needed = [this, name] { return _needed[name]; };
        stage.run = [this, name](osg::State& state) -> Status
        {
            if (_failing == name)
                return Error{ErrorCode::Failed, name + " failed"};
            _ran += name + std::to_string(state.getContextID()) + " ";
            _exists[name] = true;
            return Nothing{};
        };
        stage.bytes = [this, name, bytes] { return _exists[name] ? bytes : 0; };
        stage.destroy = [this, name] { _exists[name] = false; };
        return _chain.addStage(std::move(stage));
    }

    /// What ran, for instance "a0 b0 ".
    std::string run(unsigned context = 0)
    {
        osg::ref_ptr<osg::State>& state = _states[context];
        if (!state)
        {
            state = new osg::State;
            state->setContextID(context);
        }
        _ran.clear();
        const bool dirty = _chain.isDirty(context);
        const Status done = _chain.run(*state);
        _error = done ? "" : done.error().message;
        EXPECT_TRUE(dirty || _ran.empty()) << "ran, and said that it would not: " << _ran;
        EXPECT_EQ(_chain.isDirty(context), !done.ok());
        return _ran;
    }

    PassChain _chain;
    std::map<std::string, bool> _needed;
    std::map<std::string, bool> _exists;
    std::string _failing;
    std::string _ran;
    std::string _error;

private:
    std::map<unsigned, osg::ref_ptr<osg::State>> _states;
};
} // namespace

TEST_F(PassChainTest, AnEmptyChainIsClean)
{
    EXPECT_EQ(run(), "");
    EXPECT_TRUE(_chain.costs().empty());
}

TEST_F(PassChainTest, RunsWhatDependsOnWhatChangedInOrderAndOnce)
{
    // heights -> a -> b -> d
    //            sun -> c -^
    const Value heights = _chain.addSource();
    const Value sun = _chain.addSource();
    const Value a = stage("a", {heights});
    const Value b = stage("b", {a});
    const Value c = stage("c", {sun});
    stage("d", {b, c, heights});
    EXPECT_EQ(run(), "a0 b0 c0 d0 ");
    EXPECT_EQ(run(), "");
    _chain.touch(sun);
    EXPECT_EQ(run(), "c0 d0 ");
    EXPECT_EQ(run(), "");
    _chain.touch(heights);
    EXPECT_EQ(run(), "a0 b0 d0 ");
    _chain.touch(sun);
    _chain.touch(heights);
    _chain.touch(sun);
    EXPECT_EQ(run(), "a0 b0 c0 d0 ");
    EXPECT_EQ(run(), "");
    const std::vector<StageCost> costs = _chain.costs();
    ASSERT_EQ(costs.size(), 4u);
    EXPECT_EQ(costs[0].name, "a");
    EXPECT_EQ(costs[0].dispatches, 3u);
    EXPECT_EQ(costs[2].dispatches, 3u);
    EXPECT_EQ(costs[3].dispatches, 4u);
}

TEST_F(PassChainTest, AStageWithoutInputsRunsOnce)
{
    stage("a", {});
    EXPECT_EQ(run(), "a0 ");
    EXPECT_EQ(run(), "");
}

TEST_F(PassChainTest, AStageThatIsNotNeededCostsNothing)
{
    const Value source = _chain.addSource();
    const Value a = stage("a", {source}, 100);
    const Value b = stage("b", {a}, 10);
    stage("c", {b, source}, 1);
    _needed["b"] = false;
    EXPECT_EQ(run(), "a0 c0 ");
    EXPECT_EQ(run(), "");
    EXPECT_EQ(_chain.costs()[1].bytes, 0u);
    EXPECT_EQ(_chain.costs()[1].dispatches, 0u);

    // Needed: it runs, and what depends on it.
    _needed["b"] = true;
    EXPECT_TRUE(_chain.isDirty(0));
    EXPECT_EQ(run(), "b0 c0 ");
    EXPECT_EQ(_chain.costs()[1].bytes, 10u);
    EXPECT_TRUE(_exists["b"]);

    // No longer: it is destroyed, and what depended on it runs without it.
    _needed["b"] = false;
    EXPECT_TRUE(_chain.isDirty(0));
    EXPECT_EQ(run(), "c0 ");
    EXPECT_FALSE(_exists["b"]);
    EXPECT_EQ(_chain.costs()[1].bytes, 0u);
    EXPECT_EQ(run(), "");

    // A change that it slept through reaches it when it is needed again.
    _chain.touch(source);
    EXPECT_EQ(run(), "a0 c0 ");
    _needed["b"] = true;
    EXPECT_EQ(run(), "b0 c0 ");
    EXPECT_EQ(run(), "");
    EXPECT_EQ(_chain.costs()[1].dispatches, 2u);
}

TEST_F(PassChainTest, AStageMayWaitOrSkip)
{
    using Turn = PassChain::Turn;
    const Value source = _chain.addSource();
    const Value a = stage("a", {source});
    Turn turn = Turn::Run;
    std::string asked;
    PassChain::Stage late;
    late.name = "late";
    late.inputs = {a};
    late.needed = [] { return true; };
    late.run = [this](osg::State&) -> Status
    {
        _ran += "late ";
        return Nothing{};
    };
    late.bytes = [] { return std::size_t(0); };
    late.destroy = [] {};
    late.turn = [&](unsigned context)
    {
        asked += std::to_string(context);
        return turn;
    };
    stage("b", {_chain.addStage(late)});
    osg::ref_ptr<osg::State> state = new osg::State;
    state->setContextID(2);
    const auto ranNow = [&]
    {
        _ran.clear();
        EXPECT_TRUE(_chain.run(*state).ok());
        return _ran;
    };
    EXPECT_EQ(ranNow(), "a2 late b2 ");
    EXPECT_FALSE(_chain.isDirty(2));

    // It waits: what it wrote last stays, and it is asked again.
    turn = Turn::Wait;
    _chain.touch(source);
    EXPECT_TRUE(_chain.isDirty(2, a));
    EXPECT_EQ(ranNow(), "a2 ");
    EXPECT_TRUE(_chain.isDirty(2));
    EXPECT_FALSE(_chain.isDirty(2, a));
    EXPECT_EQ(ranNow(), "");
    turn = Turn::Run;
    EXPECT_EQ(ranNow(), "late b2 ");
    EXPECT_FALSE(_chain.isDirty(2));
    EXPECT_EQ(asked, "2222") << "asked where inputs have changed, and only there";

    // It skips: there was nothing to do.
    turn = Turn::Skip;
    _chain.touch(source);
    EXPECT_EQ(ranNow(), "a2 ");
    EXPECT_FALSE(_chain.isDirty(2));
    turn = Turn::Run;
    EXPECT_EQ(ranNow(), "");
    EXPECT_EQ(_chain.costs()[1].dispatches, 2u);

    // One stage may be asked to run again, in one context.
    _chain.forget(2, a);
    EXPECT_TRUE(_chain.isDirty(2));
    EXPECT_EQ(ranNow(), "a2 late b2 ");
}

TEST_F(PassChainTest, EachContextHasItsOwnVersions)
{
    const Value source = _chain.addSource();
    const Value a = stage("a", {source});
    stage("b", {a});
    EXPECT_EQ(run(0), "a0 b0 ");
    EXPECT_TRUE(_chain.isDirty(3));
    EXPECT_EQ(run(3), "a3 b3 ");
    EXPECT_EQ(run(0), "");
    EXPECT_EQ(run(3), "");
    _chain.touch(source);
    EXPECT_EQ(run(3), "a3 b3 ");
    EXPECT_TRUE(_chain.isDirty(0));
    EXPECT_EQ(run(0), "a0 b0 ");
    EXPECT_EQ(run(3), "");
    EXPECT_EQ(_chain.costs()[0].dispatches, 4u);
}

TEST_F(PassChainTest, WhatIsDestroyedIsGoneInEveryContext)
{
    const Value source = _chain.addSource();
    const Value a = stage("a", {source});
    stage("b", {a});
    run(0);
    run(1);
    // Context 1 is not drawn while `a` is away and comes back.
    _needed["a"] = false;
    EXPECT_EQ(run(0), "b0 ");
    _needed["a"] = true;
    EXPECT_EQ(run(0), "a0 b0 ");
    EXPECT_TRUE(_chain.isDirty(1));
    EXPECT_EQ(run(1), "a1 b1 ");
    EXPECT_EQ(run(0), "");
}

TEST_F(PassChainTest, ForgetsAContext)
{
    stage("a", {_chain.addSource()});
    run(0);
    run(1);
    _chain.forget(1);
    EXPECT_EQ(run(0), "");
    EXPECT_EQ(run(1), "a1 ");
    _chain.forget(7); // never seen
    _chain.forget(~0u);
    EXPECT_EQ(run(0), "a0 ");
    EXPECT_EQ(run(1), "a1 ");
}

TEST_F(PassChainTest, AnErrorStopsTheChainUntilItIsGone)
{
    const Value source = _chain.addSource();
    const Value a = stage("a", {source});
    const Value b = stage("b", {a});
    stage("c", {b});
    stage("other", {});
    _failing = "b";
    EXPECT_EQ(run(), "a0 ");
    EXPECT_EQ(_error, "b failed");
    // What ran stays done; what failed is tried again.
    EXPECT_EQ(run(), "");
    EXPECT_EQ(_error, "b failed");
    EXPECT_EQ(_chain.costs()[1].dispatches, 0u);
    _failing = "";
    EXPECT_EQ(run(), "b0 c0 other0 ");
    EXPECT_EQ(_error, "");

    // The same where it had run before.
    _chain.touch(source);
    _failing = "b";
    EXPECT_EQ(run(), "a0 ");
    _failing = "";
    EXPECT_EQ(run(), "b0 c0 ");
    EXPECT_EQ(run(), "");
}

TEST_F(PassChainTest, UntimedStagesHaveNoTimes)
{
    stage("a", {});
    run();
    EXPECT_EQ(_chain.costs()[0].milliseconds, 0.0);
    EXPECT_EQ(_chain.costs()[0].gpuMilliseconds, 0.0);
}

TEST(PassChainTiming, IsMeasuredAndErrorsEndTheirQuery)
{
    OTL_NEED_GL(context);
    const ShaderFile file("passes/test_busy.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f, binding = 0) writeonly uniform image2D result;
void main()
{
    float sum = 0.0;
    for (int i = 0; i < 2000; ++i)
        sum += sin(float(i) + float(gl_GlobalInvocationID.x));
    imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(sum));
}
)");
    const auto target = createTarget(64, 64, GL_R32F);
    const osg::ref_ptr<GpuPass> pass = new GpuPass("test_busy");
    pass->writes(0, target);
    bool fails = true;
    PassChain chain;
    const PassChain::Value source = chain.addSource();
    chain.addStage({"busy",
                    {source},
                    [] { return true; },
                    [&](osg::State& state) -> Status
                    {
                        if (fails)
                            return Error{ErrorCode::Failed, "not yet"};
                        return pass->dispatch(state, {8, 8, 1});
                    },
                    [&] { return textureBytes(*target); },
                    [] {}});
    chain.setTimed(true);
    EXPECT_FALSE(chain.run(context->state()).ok());
    EXPECT_EQ(takeGlErrors(), "");
    fails = false;
    for (int i = 1; i <= 3; ++i)
    {
        chain.touch(source);
        const Status done = chain.run(context->state());
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(takeGlErrors(), "");
        const StageCost cost = chain.costs().front();
        EXPECT_EQ(cost.dispatches, static_cast<unsigned>(i));
        EXPECT_EQ(cost.bytes, 64u * 64u * 4u);
        EXPECT_GT(cost.gpuMilliseconds, 0.0);
        EXPECT_GT(cost.milliseconds, 0.0);
        // The wall clock runs from before the query to after it.
        EXPECT_LE(cost.gpuMilliseconds, cost.milliseconds + 1.0);
    }
}
