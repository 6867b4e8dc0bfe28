#include "gpu/PassChain.h"

#include "gpu/GlConstants.h"
#include "gpu/GpuCapabilities.h"

#include <osg/GLExtensions>

#include <chrono>

namespace osgTerrainLight
{

PassChain::Value PassChain::addSource()
{
    _sources.push_back(_next++);
    return _sources.size() - 1;
}

void PassChain::touch(Value source)
{
    _sources[source] = _next++;
}

PassChain::Value PassChain::addStage(Stage stage)
{
    const Value output = addSource();
    StageCost cost;
    cost.name = stage.name;
    _stages.push_back({std::move(stage), output, cost});
    return output;
}

std::vector<PassChain::Version> PassChain::inputVersions(const Entry& entry,
                                                         const Context& context) const
{
    std::vector<Version> versions;
    for (Value value : entry.stage.inputs)
    {
        const auto derived = context.derived.find(value);
        versions.push_back(derived != context.derived.end() ? derived->second : _sources[value]);
    }
    return versions;
}

Status PassChain::run(osg::State& state, const std::function<bool()>& mayContinue)
{
    bool ran = false; // so that each call gets further
    using Clock = std::chrono::steady_clock;
    Context& context = _contexts[state.getContextID()];
    for (std::size_t i = 0; i < _stages.size(); ++i)
    {
        Entry& entry = _stages[i];
        if (!entry.stage.needed())
        {
            entry.stage.destroy();
            // What depended on it runs again without it, and it runs again once it is needed: in
            // every context, as its textures are gone for all of them.
            for (auto& [id, other] : _contexts)
                if (other.seen.erase(i) > 0)
                    other.derived[entry.output] = _next++;
            continue;
        }
        std::vector<Version> inputs = inputVersions(entry, context);
        const auto seen = context.seen.find(i);
        if (seen != context.seen.end() && seen->second == inputs)
            continue;
        const unsigned id = state.getContextID();
        const Turn turn = entry.stage.turn ? entry.stage.turn(id) : Turn::Run;
        if (turn == Turn::Skip)
            context.seen[i] = std::move(inputs);
        if (turn != Turn::Run)
            continue;
        if (ran && mayContinue && !mayContinue())
            return Nothing{};
        ran = true;

        const auto* extensions = state.get<osg::GLExtensions>();
        GLuint query = 0;
        Clock::time_point start;
        if (_timed)
        {
            glFinish();
            start = Clock::now();
            extensions->glGenQueries(1, &query);
            extensions->glBeginQuery(GL_TIME_ELAPSED, query);
        }
        Status done = entry.stage.run(state);
        if (_timed)
        {
            extensions->glEndQuery(GL_TIME_ELAPSED);
            glFinish();
            entry.cost.milliseconds =
                std::chrono::duration<double, std::milli>(Clock::now() - start).count();
            GLuint64 nanoseconds = 0;
            extensions->glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
            extensions->glDeleteQueries(1, &query);
            // llvmpipe's clock does not see compute work: without a drawing before, it gives the
            // time since the machine started. There the GPU is the CPU, and the wall clock tells.
            const auto capabilities = GpuCapabilities::query(state);
            entry.cost.gpuMilliseconds = capabilities && capabilities->isSoftware()
                                             ? entry.cost.milliseconds
                                             : static_cast<double>(nanoseconds) * 1.0e-6;
        }
        if (!done)
            return done;
        ++entry.cost.dispatches;
        context.seen[i] = std::move(inputs);
        context.derived[entry.output] = _next++;
    }
    return Nothing{};
}

bool PassChain::isDirty(unsigned contextID) const
{
    return !_stages.empty() && isDirty(contextID, _stages.back().output);
}

bool PassChain::isDirty(unsigned contextID, Value last) const
{
    const auto found = _contexts.find(contextID);
    for (std::size_t i = 0; i < _stages.size(); ++i)
    {
        const Entry& entry = _stages[i];
        const bool needed = entry.stage.needed();
        if (found == _contexts.end())
        {
            if (needed)
                return true;
        }
        else
        {
            const auto seen = found->second.seen.find(i);
            const bool ran = seen != found->second.seen.end();
            if (needed != ran || (needed && seen->second != inputVersions(entry, found->second)))
                return true;
        }
        if (entry.output == last)
            return false;
    }
    return false;
}

void PassChain::forget(unsigned contextID)
{
    if (contextID == ~0u)
        _contexts.clear();
    else
        _contexts.erase(contextID);
}

void PassChain::forget(unsigned contextID, Value output)
{
    for (std::size_t i = 0; i < _stages.size(); ++i)
        if (_stages[i].output == output)
            _contexts[contextID].seen.erase(i);
}

std::vector<StageCost> PassChain::costs() const
{
    std::vector<StageCost> costs;
    for (const Entry& entry : _stages)
    {
        costs.push_back(entry.cost);
        costs.back().bytes = entry.stage.needed() ? entry.stage.bytes() : 0;
    }
    return costs;
}

} // namespace osgTerrainLight
