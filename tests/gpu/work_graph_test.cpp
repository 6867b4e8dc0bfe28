#include "gpu/WorkGraph.h"

#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

using namespace osgTerrainLight;

namespace
{
/// Writes down that it ran.
class Noted : public Node
{
public:
    Noted(const std::string& name, std::string& ran, const std::vector<Resource*>& inputs,
          const TextureLayout& layout = {}, const TextureLayout& expected = {})
        : Node(name), _ran(&ran),
          _output(writes(
              own(layout == TextureLayout() ? new Resource(name) : new Resource(name, layout))))
    {
        for (Resource* input : inputs)
            reads(input, expected);
    }

    Status run(osg::State& state) override
    {
        if (fails)
            return Error{ErrorCode::Failed, name() + " failed"};
        *_ran += name() + std::to_string(state.getContextID()) + " ";
        return Nothing{};
    }

    using Node::reads;
    using Node::samples;
    using Node::writes;
    Resource* output() const { return _output; }
    bool fails = false;

private:
    std::string* _ran;
    Resource* _output;
};

/// Stops wherever it is asked.
class Never : public WorkPace
{
public:
    int asked = 0;

protected:
    bool mayContinue() override
    {
        ++asked;
        return false;
    }
};

constexpr TextureLayout small = {5, 4, 0, GL_R32F}; // 80 bytes

/// Graphs whose nodes only write down that they ran. They need no OpenGL.
class WorkGraphTest : public testing::Test
{
protected:
    osg::ref_ptr<Noted> node(const std::string& name, const std::vector<Resource*>& inputs,
                             const TextureLayout& layout = {}, const TextureLayout& expected = {})
    {
        _needed[name] = true;
        osg::ref_ptr<Noted> made = new Noted(name, _ran, inputs, layout, expected);
        made->neededWhere([this, name] { return _needed[name]; });
        return made;
    }

    void declare(WorkGraph::Nodes nodes)
    {
        const Status done = _graph.declare(std::move(nodes));
        EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
    }

    std::string complaint(WorkGraph::Nodes nodes)
    {
        const Status done = _graph.declare(std::move(nodes));
        return done ? "" : done.error().message;
    }

    osg::State& state(unsigned context)
    {
        osg::ref_ptr<osg::State>& state = _states[context];
        if (!state)
        {
            state = new osg::State;
            state->setContextID(context);
        }
        return *state;
    }

    /// What ran, for instance "a0 b0 ".
    std::string run(unsigned context = 0) { return run(_graph, context); }
    std::string run(WorkGraph& graph, unsigned context)
    {
        _ran.clear();
        const bool dirty = graph.isDirty(context);
        const Status done = graph.run(state(context));
        _error = done ? "" : done.error().message;
        EXPECT_TRUE(dirty || _ran.empty()) << "ran, and said that it would not: " << _ran;
        EXPECT_EQ(graph.isDirty(context) && !graph.isStale(context), !done.ok());
        return _ran;
    }

    StageCost cost(const std::string& name) const
    {
        for (const StageCost& row : _graph.costs())
            if (row.name == name)
                return row;
        return {};
    }

    WorkGraph _graph;
    osg::ref_ptr<Resource> _source = new Resource("source"), _other = new Resource("other");
    std::map<std::string, bool> _needed;
    std::string _ran;
    std::string _error;

private:
    std::map<unsigned, osg::ref_ptr<osg::State>> _states;
};
} // namespace

TEST_F(WorkGraphTest, AnEmptyGraphIsClean)
{
    EXPECT_EQ(run(), "");
    EXPECT_TRUE(_graph.costs().empty());
}

TEST_F(WorkGraphTest, RunsWhatDependsOnWhatChangedInOrderAndOnce)
{
    // heights -> a -> b -> d
    //            sun -> c -^
    const auto a = node("a", {_source});
    const auto b = node("b", {a->output()});
    const auto c = node("c", {_other});
    const auto d = node("d", {b->output(), c->output(), _source});
    declare({a, b, c, d});
    EXPECT_EQ(run(), "a0 b0 c0 d0 ");
    EXPECT_EQ(run(), "");
    _other->touch();
    EXPECT_EQ(run(), "c0 d0 ");
    EXPECT_EQ(run(), "");
    _source->touch();
    EXPECT_EQ(run(), "a0 b0 d0 ");
    _other->touch();
    _source->touch();
    _other->touch();
    EXPECT_EQ(run(), "a0 b0 c0 d0 ");
    EXPECT_EQ(run(), "");
    const std::vector<StageCost> costs = _graph.costs();
    ASSERT_EQ(costs.size(), 4u);
    EXPECT_EQ(costs[0].name, "a");
    EXPECT_EQ(costs[0].dispatches, 3u);
    EXPECT_EQ(costs[2].dispatches, 3u);
    EXPECT_EQ(costs[3].dispatches, 4u);
}

TEST_F(WorkGraphTest, ANodeWithoutInputsRunsOnce)
{
    declare({node("a", {})});
    EXPECT_EQ(run(), "a0 ");
    EXPECT_EQ(run(), "");
}

TEST_F(WorkGraphTest, ANodeThatIsNotNeededCostsNothing)
{
    const auto a = node("a", {_source}, small);
    const auto b = node("b", {a->output()}, small);
    const auto c = node("c", {b->output(), _source});
    declare({a, b, c});
    _needed["b"] = false;
    EXPECT_EQ(run(), "a0 c0 ");
    EXPECT_EQ(run(), "");
    EXPECT_EQ(cost("b").bytes, 0u);
    EXPECT_EQ(cost("b").dispatches, 0u);
    EXPECT_FALSE(b->output()->texture());
    EXPECT_EQ(_graph.bytes(), 80u);

    // Needed: it runs, and what depends on it.
    _needed["b"] = true;
    EXPECT_TRUE(_graph.isDirty(0));
    EXPECT_EQ(run(), "b0 c0 ");
    EXPECT_EQ(cost("b").bytes, 80u);
    EXPECT_TRUE(b->output()->texture());

    // No longer: its texture is dropped, and what depended on it runs without it.
    _needed["b"] = false;
    EXPECT_TRUE(_graph.isDirty(0));
    EXPECT_EQ(run(), "c0 ");
    EXPECT_FALSE(b->output()->texture());
    EXPECT_EQ(cost("b").bytes, 0u);
    EXPECT_EQ(run(), "");

    // A change that it slept through reaches it when it is needed again.
    _source->touch();
    EXPECT_EQ(run(), "a0 c0 ");
    _needed["b"] = true;
    EXPECT_EQ(run(), "b0 c0 ");
    EXPECT_EQ(run(), "");
    EXPECT_EQ(cost("b").dispatches, 2u);
}

// What two nodes own is counted once, and dropped with the last that needs it.
TEST_F(WorkGraphTest, NodesMayShareWhatTheyOwn)
{
    class Sharing : public Noted
    {
    public:
        Sharing(const std::string& name, std::string& ran, Resource* shared) : Noted(name, ran, {})
        {
            own(shared);
        }
    };
    int made = 0;
    const osg::ref_ptr<Resource> shared = new Resource("shared",
                                                       [&made]() -> osg::ref_ptr<osg::Texture>
                                                       {
                                                           ++made;
                                                           return createTarget(5, 4, GL_R32F);
                                                       });
    const osg::ref_ptr<Sharing> a = new Sharing("a", _ran, shared);
    const osg::ref_ptr<Sharing> b = new Sharing("b", _ran, shared);
    bool needsA = true, needsB = true;
    a->neededWhere([&] { return needsA; });
    b->neededWhere([&] { return needsB; });
    declare({a, b});
    EXPECT_EQ(made, 0);
    EXPECT_EQ(run(), "a0 b0 ");
    EXPECT_EQ(made, 1);
    EXPECT_EQ(_graph.bytes(), 80u);
    EXPECT_EQ(cost("a").bytes, 80u);
    needsA = false;
    run();
    EXPECT_TRUE(shared->texture());
    EXPECT_EQ(cost("b").bytes, 80u);
    needsB = false;
    run();
    EXPECT_FALSE(shared->texture());
    EXPECT_EQ(_graph.bytes(), 0u);
}

// What is sampled does not make a node run, but is told; its next run takes it up.
TEST_F(WorkGraphTest, ANodeIsStaleWhereWhatItSamplesHasChanged)
{
    const auto direct = node("direct", {_source});
    const auto late = node("late", {_other});
    late->samples(direct->output());
    const auto last = node("last", {direct->output(), late->output()});
    declare({direct, late, last});
    EXPECT_EQ(run(2), "direct2 late2 last2 ");
    EXPECT_FALSE(_graph.isDirty(2));
    _source->touch();
    EXPECT_TRUE(_graph.isDirty(2));
    EXPECT_FALSE(_graph.isStale(2)) << "there is something to run";
    EXPECT_EQ(run(2), "direct2 last2 ");
    EXPECT_TRUE(_graph.isDirty(2));
    EXPECT_TRUE(_graph.isStale(2));
    EXPECT_EQ(run(2), "");
    _other->touch(2);
    EXPECT_EQ(run(2), "late2 last2 ");
    EXPECT_FALSE(_graph.isDirty(2));
    _source->touch();
    _other->touch();
    EXPECT_EQ(run(2), "direct2 late2 last2 ");
    EXPECT_FALSE(_graph.isDirty(2));
}

TEST_F(WorkGraphTest, EachContextHasItsOwnVersions)
{
    const auto a = node("a", {_source});
    declare({a, node("b", {a->output()})});
    EXPECT_EQ(run(0), "a0 b0 ");
    EXPECT_TRUE(_graph.isDirty(3));
    EXPECT_EQ(run(3), "a3 b3 ");
    EXPECT_EQ(run(0), "");
    EXPECT_EQ(run(3), "");
    _source->touch();
    EXPECT_EQ(run(3), "a3 b3 ");
    EXPECT_TRUE(_graph.isDirty(0));
    EXPECT_EQ(run(0), "a0 b0 ");
    EXPECT_EQ(run(3), "");
    _source->touch(3);
    EXPECT_EQ(run(0), "");
    EXPECT_EQ(run(3), "a3 b3 ");
    EXPECT_EQ(cost("a").dispatches, 5u);
}

TEST_F(WorkGraphTest, WhatIsDroppedIsGoneInEveryContext)
{
    const auto a = node("a", {_source}, small);
    declare({a, node("b", {a->output()})});
    run(0);
    run(1);
    // Context 1 is not drawn while `a` is away and comes back.
    _needed["a"] = false;
    EXPECT_EQ(run(0), "b0 ");
    _needed["a"] = true;
    EXPECT_EQ(run(0), "a0 b0 ");
    EXPECT_TRUE(_graph.isDirty(1));
    EXPECT_EQ(run(1), "a1 b1 ");
    EXPECT_EQ(run(0), "");
}

TEST_F(WorkGraphTest, ANodeMayReadAResourceOfAnotherGraph)
{
    const auto a = node("a", {_source}, small);
    declare({a});
    const auto b = node("b", {a->output()}, {}, small);
    WorkGraph other;
    ASSERT_TRUE(other.declare({b}).ok());
    EXPECT_EQ(run(_graph, 0), "a0 ");
    EXPECT_EQ(run(other, 0), "b0 ");
    EXPECT_FALSE(other.isDirty(0));
    _source->touch();
    EXPECT_FALSE(other.isDirty(0)) << "what it reads has not changed yet";
    EXPECT_EQ(run(_graph, 0), "a0 ");
    EXPECT_TRUE(other.isDirty(0));
    EXPECT_EQ(run(other, 0), "b0 ");
    EXPECT_EQ(other.bytes(), 0u) << "it is the other's";
}

TEST_F(WorkGraphTest, StopsBetweenNodesAndGoesOn)
{
    const auto a = node("a", {_source});
    const auto b = node("b", {a->output()});
    declare({a, b, node("c", {b->output()})});
    int asked = 0;
    for (const char* expected : {"a0 ", "b0 ", "c0 ", ""})
    {
        _ran.clear();
        Never never;
        EXPECT_TRUE(_graph.run(state(0), &never).ok());
        asked += never.asked;
        EXPECT_EQ(never.isStopped(), never.asked > 0);
        EXPECT_EQ(_ran, expected) << "each call gets further";
        EXPECT_EQ(_graph.isDirty(0), *expected == 'a' || *expected == 'b');
    }
    EXPECT_EQ(asked, 2) << "asked between two nodes, and only there";
    _source->touch();
    EXPECT_EQ(run(), "a0 b0 c0 ");
}

TEST_F(WorkGraphTest, OtherNodesTakeThePlaceOfThoseThereWere)
{
    const auto a = node("a", {_source}, small);
    const auto b = node("b", {a->output()}, small);
    declare({a, b});
    run();
    // `a` stays and does not run again; what `b` owned goes.
    const auto c = node("c", {a->output()}, small);
    declare({a, c});
    EXPECT_FALSE(b->output()->texture());
    EXPECT_EQ(run(), "c0 ");
    EXPECT_EQ(_graph.bytes(), 160u);
    EXPECT_EQ(cost("b").dispatches, 1u) << "what ran is not forgotten";
    EXPECT_EQ(_graph.costs().back().name, "b");
}

TEST_F(WorkGraphTest, IsCheckedWhenItIsDeclared)
{
    const auto a = node("a", {_source}, small);
    const auto reader = node("b", {a->output()}, {}, small);
    declare({a, reader});
    EXPECT_EQ(complaint({reader, a}),
              "node 'b' reads 'a' before 'a' writes it: needs the writer first");
    const auto second = node("c", {});
    second->writes(a->output());
    EXPECT_EQ(complaint({a, second}), "'a' is written by two nodes, 'a' and 'c': needs one");
    const auto self = node("d", {});
    self->reads(self->output());
    EXPECT_EQ(complaint({self}),
              "node 'd' reads 'd', which it writes: needs a resource of its own to write");
    const auto wrong = node("e", {a->output()}, {}, {5, 4, 2, GL_R16});
    EXPECT_EQ(complaint({a, wrong}), "node 'e' reads 'a' as R16 5 x 4 x 2: found R32F 5 x 4");
    // A cycle of two.
    const auto first = node("f", {});
    const auto last = node("g", {first->output()});
    first->reads(last->output());
    EXPECT_NE(complaint({first, last}), "");
    // Nothing of that was taken.
    EXPECT_EQ(run(), "a0 b0 ");
}

TEST_F(WorkGraphTest, ForgetsAContext)
{
    declare({node("a", {_source})});
    run(0);
    run(1);
    _graph.forget(1);
    EXPECT_EQ(run(0), "");
    EXPECT_EQ(run(1), "a1 ");
    _graph.forget(7); // never seen
    _graph.forget(~0u);
    EXPECT_EQ(run(0), "a0 ");
    EXPECT_EQ(run(1), "a1 ");
}

TEST_F(WorkGraphTest, AnErrorStopsTheGraphUntilItIsGone)
{
    const auto a = node("a", {_source});
    const auto b = node("b", {a->output()});
    declare({a, b, node("c", {b->output()}), node("other", {})});
    b->fails = true;
    EXPECT_EQ(run(), "a0 ");
    EXPECT_EQ(_error, "b failed");
    // What ran stays done; what failed is tried again.
    EXPECT_EQ(run(), "");
    EXPECT_EQ(_error, "b failed");
    EXPECT_EQ(cost("b").dispatches, 0u);
    b->fails = false;
    EXPECT_EQ(run(), "b0 c0 other0 ");
    EXPECT_EQ(_error, "");

    // The same where it had run before.
    _source->touch();
    b->fails = true;
    EXPECT_EQ(run(), "a0 ");
    b->fails = false;
    EXPECT_EQ(run(), "b0 c0 ");
    EXPECT_EQ(run(), "");
}

TEST_F(WorkGraphTest, UntimedNodesHaveNoTimes)
{
    declare({node("a", {})});
    run();
    EXPECT_EQ(cost("a").milliseconds, 0.0);
    EXPECT_EQ(cost("a").gpuMilliseconds, 0.0);
}

namespace
{
class Busy : public Node
{
public:
    Busy(Resource* source)
        : Node("busy"), target(writes(own(new Resource("busy", {64, 64, 0, GL_R32F})))),
          _pass(own(new GpuPass("test_busy")))
    {
        reads(source);
        _pass->writes(0, target);
    }
    Status run(osg::State& state) override
    {
        if (fails)
            return Error{ErrorCode::Failed, "not yet"};
        return _pass->dispatch(state, {8, 8, 1});
    }
    Resource* const target;
    bool fails = true;

private:
    GpuPass* _pass;
};

constexpr const char* busyShader = R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f, binding = 0) writeonly uniform image2D result;
void main()
{
    float sum = 0.0;
    for (int i = 0; i < 2000; ++i)
        sum += sin(float(i) + float(gl_GlobalInvocationID.x));
    imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(sum));
}
)";
} // namespace

TEST(WorkGraphTiming, IsMeasuredAndErrorsEndTheirQuery)
{
    OTL_NEED_GL(context);
    const ShaderFile file("passes/test_busy.comp", busyShader);
    const osg::ref_ptr<Resource> source = new Resource("source");
    const osg::ref_ptr<Busy> busy = new Busy(source);
    WorkGraph graph;
    ASSERT_TRUE(graph.declare({busy}).ok());
    graph.setTimed(true);
    EXPECT_FALSE(graph.run(context->state()).ok());
    EXPECT_EQ(takeGlErrors(), "");
    busy->fails = false;
    for (int i = 1; i <= 3; ++i)
    {
        source->touch();
        const Status done = graph.run(context->state());
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(takeGlErrors(), "");
        const StageCost cost = graph.costs().front();
        EXPECT_EQ(cost.dispatches, static_cast<unsigned>(i));
        EXPECT_EQ(cost.bytes, 64u * 64u * 4u);
        EXPECT_GT(cost.gpuMilliseconds, 0.0);
        EXPECT_GT(cost.milliseconds, 0.0);
        // The wall clock runs from before the query to after it.
        EXPECT_LE(cost.gpuMilliseconds, cost.milliseconds + 1.0);
    }
    graph.releaseGLObjects(&context->state());
}

// Released, a texture has no object in the context, and the node runs again and makes one.
TEST(WorkGraphObjects, AreReleasedResizedAndMadeAgain)
{
    OTL_NEED_GL(context);
    const ShaderFile file("passes/test_busy.comp", busyShader);
    osg::State& state = context->state();
    const unsigned id = state.getContextID();
    const osg::ref_ptr<Resource> source = new Resource("source");
    const osg::ref_ptr<Busy> busy = new Busy(source);
    busy->fails = false;
    WorkGraph graph;
    ASSERT_TRUE(graph.declare({busy}).ok());
    ASSERT_TRUE(graph.run(state).ok());
    const std::vector<float> before = readFloats(state, *busy->target->texture(), 1);
    EXPECT_TRUE(busy->target->texture()->getTextureObject(id));
    graph.releaseGLObjects(&state);
    EXPECT_FALSE(busy->target->texture()->getTextureObject(id));
    EXPECT_TRUE(graph.isDirty(id));
    graph.resizeGLObjectBuffers(id + 5);
    ASSERT_TRUE(graph.run(state).ok());
    EXPECT_EQ(readFloats(state, *busy->target->texture(), 1), before);
    EXPECT_EQ(takeGlErrors(), "");
    graph.releaseGLObjects(&state);
}
