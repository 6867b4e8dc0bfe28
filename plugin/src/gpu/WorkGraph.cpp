#include "gpu/WorkGraph.h"

#include "gpu/GlConstants.h"
#include "gpu/GpuCapabilities.h"

#include <osg/GLExtensions>

#include <algorithm>
#include <chrono>
#include <set>

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;

/// The row of a name, which is there from now on.
StageCost& rowOf(std::vector<StageCost>& rows, const std::string& name)
{
    const auto found = std::find_if(rows.begin(), rows.end(),
                                    [&](const StageCost& row) { return row.name == name; });
    if (found != rows.end())
        return *found;
    rows.emplace_back();
    rows.back().name = name;
    return rows.back();
}
} // namespace

Resource* GpuWork::own(Resource* resource)
{
    _resources.emplace_back(resource);
    return resource;
}

GpuPass* GpuWork::own(GpuPass* pass)
{
    _passes.emplace_back(pass);
    return pass;
}

std::vector<Resource*> GpuWork::resources() const
{
    std::vector<Resource*> all;
    for (const auto& resource : _resources)
        all.push_back(resource);
    for (const auto& work : _works)
    {
        const std::vector<Resource*> theirs = work->resources();
        all.insert(all.end(), theirs.begin(), theirs.end());
    }
    return all;
}

std::size_t GpuWork::bytes() const
{
    std::size_t sum = 0;
    for (const Resource* resource : resources())
        sum += resource->bytes();
    return sum;
}

void GpuWork::releaseGLObjects(osg::State* state) const
{
    for (const auto& resource : _resources)
        resource->releaseGLObjects(state);
    for (const auto& pass : _passes)
        pass->releaseGLObjects(state);
    for (const auto& work : _works)
        work->releaseGLObjects(state);
}

void GpuWork::resizeGLObjectBuffers(unsigned size)
{
    for (const auto& resource : _resources)
        resource->resizeGLObjectBuffers(size);
    for (const auto& pass : _passes)
        pass->resizeGLObjectBuffers(size);
    for (const auto& work : _works)
        work->resizeGLObjectBuffers(size);
}

void Node::reads(Resource* resource, const TextureLayout& expected)
{
    _reads.push_back({resource, expected});
}

void Node::samples(Resource* resource)
{
    _samples.emplace_back(resource);
}

Resource* Node::writes(Resource* resource)
{
    _writes.emplace_back(resource);
    return resource;
}

Status WorkGraph::declare(Nodes nodes)
{
    std::map<const Resource*, std::size_t> writers;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (const auto& written : nodes[i]->_writes)
            if (const auto [other, fresh] = writers.emplace(written, i); !fresh)
                return Error{ErrorCode::Invalid, "'" + written->name() +
                                                     "' is written by two nodes, '" +
                                                     nodes[other->second]->name() + "' and '" +
                                                     nodes[i]->name() + "': needs one"};
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
        std::vector<Node::Read> all = nodes[i]->_reads;
        for (const auto& sampled : nodes[i]->_samples)
            all.push_back({sampled, {}});
        for (const Node::Read& read : all)
        {
            const std::string what =
                "node '" + nodes[i]->name() + "' reads '" + read.resource->name() + "'";
            const auto writer = writers.find(read.resource);
            if (writer != writers.end() && writer->second == i)
                return Error{ErrorCode::Invalid,
                             what + ", which it writes: needs a resource of its own to write"};
            if (writer != writers.end() && writer->second > i)
                return Error{ErrorCode::Invalid, what + " before '" +
                                                     nodes[writer->second]->name() +
                                                     "' writes it: needs the writer first"};
            if (read.expected != TextureLayout() && read.expected != read.resource->layout())
                return Error{ErrorCode::Invalid, what + " as " + read.expected.text() + ": found " +
                                                     read.resource->layout().text()};
        }
    }
    Lock lock(_mutex);
    nodes.swap(_nodes); // now those there were
    for (const auto& node : nodes)
        if (std::find(_nodes.begin(), _nodes.end(), node) == _nodes.end())
        {
            rowOf(_gone, node->name()).dispatches += node->_cost.dispatches;
            dropUnowned(node->resources());
        }
    return Nothing{};
}

/// Of these resources, those that no needed node owns.
void WorkGraph::dropUnowned(const std::vector<Resource*>& resources)
{
    std::set<const Resource*> kept;
    for (const auto& node : _nodes)
        if (node->needed())
        {
            const std::vector<Resource*> owned = node->resources();
            kept.insert(owned.begin(), owned.end());
        }
    for (Resource* resource : resources)
        if (kept.count(resource) == 0)
            resource->drop();
}

/// What depended on the node runs again without it, and it runs again once it is needed: in every
/// context, as its textures are gone for all of them.
void WorkGraph::retire(Node& node)
{
    if (!node._exists)
        return;
    node._exists = false;
    node._seen.clear();
    node._partly.clear();
    for (const auto& written : node._writes)
        written->touch();
    dropUnowned(node.resources());
}

WorkGraph::State WorkGraph::stateOf(const Node& node, unsigned contextID)
{
    if (!node.needed())
        return node._exists ? State::Behind : State::Current; // to be retired
    const auto seen = node._seen.find(contextID);
    if (seen == node._seen.end())
        return State::Behind;
    for (std::size_t i = 0; i < node._reads.size(); ++i)
        if (node._reads[i].resource->version(contextID) != seen->second.reads[i])
            return State::Behind;
    for (std::size_t i = 0; i < node._samples.size(); ++i)
        if (node._samples[i]->version(contextID) != seen->second.samples[i])
            return State::Stale;
    return State::Current;
}

WorkGraph::State WorkGraph::worst(unsigned contextID) const
{
    Lock lock(_mutex);
    State found = State::Current;
    for (const auto& node : _nodes)
        found = std::max(found, stateOf(*node, contextID));
    return found;
}

bool WorkGraph::isDirty(unsigned contextID) const
{
    return worst(contextID) != State::Current;
}

bool WorkGraph::isStale(unsigned contextID) const
{
    return worst(contextID) == State::Stale;
}

Status WorkGraph::run(osg::State& state, WorkPace* pace)
{
    const unsigned id = state.getContextID();
    {
        Lock lock(_mutex);
        for (const auto& node : _nodes)
            if (!node->needed())
                retire(*node);
    }
    bool ran = false; // so that each call gets further
    for (const auto& node : _nodes)
    {
        Node::Seen seen;
        WorkProgress progress;
        {
            Lock lock(_mutex);
            if (!node->needed() || stateOf(*node, id) != State::Behind)
                continue;
            for (const Node::Read& read : node->_reads)
                seen.reads.push_back(read.resource->version(id));
            for (const auto& sampled : node->_samples)
                seen.samples.push_back(sampled->version(id));
            const auto partly = node->_partly.find(id);
            if (partly != node->_partly.end() && partly->second.seen == seen)
                progress = partly->second.progress;
        }
        if (ran && pace && !pace->goesOn())
            return Nothing{};
        ran = true;
        {
            Lock lock(_mutex);
            node->_exists = true;
        }
        for (Resource* owned : node->resources())
            owned->make();
        for (const auto& written : node->_writes)
            written->make();
        const Status done =
            _timed ? runTimed(state, *node, progress, pace) : runNode(state, *node, progress, pace);
        Lock lock(_mutex);
        node->_partly.erase(id);
        if (pace && pace->isStopped())
        {
            node->_partly[id] = {std::move(seen), progress};
            return Nothing{};
        }
        if (!done)
            return done;
        ++node->_cost.dispatches;
        node->_seen[id] = std::move(seen);
        for (const auto& written : node->_writes)
            written->touch(id);
    }
    return Nothing{};
}

Status WorkGraph::runNode(osg::State& state, Node& node, WorkProgress& progress, WorkPace* pace)
{
    if (!pace && progress.dispatches == 0 && progress.groups == 0)
        return node.run(state);
    const PacedRun run(node.name(), progress, pace);
    return node.run(state);
}

Status WorkGraph::runTimed(osg::State& state, Node& node, WorkProgress& progress,
                           WorkPace* pace) const
{
    using Clock = std::chrono::steady_clock;
    const auto* extensions = state.get<osg::GLExtensions>();
    glFinish();
    const Clock::time_point start = Clock::now();
    GLuint query = 0;
    extensions->glGenQueries(1, &query);
    extensions->glBeginQuery(GL_TIME_ELAPSED, query);
    Status done = runNode(state, node, progress, pace);
    extensions->glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    const double wall = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    GLuint64 nanoseconds = 0;
    extensions->glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    extensions->glDeleteQueries(1, &query);
    // llvmpipe's clock does not see compute work: without a drawing before, it gives the time since
    // the machine started. There the GPU is the CPU, and the wall clock tells.
    const auto capabilities = GpuCapabilities::query(state);
    Lock lock(_mutex);
    node._cost.milliseconds = wall;
    node._cost.gpuMilliseconds = capabilities && capabilities->isSoftware()
                                     ? wall
                                     : static_cast<double>(nanoseconds) * 1.0e-6;
    return done;
}

void WorkGraph::forget(unsigned contextID)
{
    Lock lock(_mutex);
    for (const auto& node : _nodes)
        if (contextID == ~0u)
        {
            node->_seen.clear();
            node->_partly.clear();
        }
        else
        {
            node->_seen.erase(contextID);
            node->_partly.erase(contextID);
        }
}

std::vector<StageCost> WorkGraph::costs() const
{
    Lock lock(_mutex);
    std::vector<StageCost> rows;
    std::set<const Resource*> counted;
    for (const auto& node : _nodes)
    {
        StageCost& row = rowOf(rows, node->name());
        row.dispatches += node->_cost.dispatches;
        row.milliseconds += node->_cost.milliseconds;
        row.gpuMilliseconds += node->_cost.gpuMilliseconds;
        if (!node->needed() || !node->_exists)
            continue;
        row.bytes += node->workingBytes();
        for (const Resource* owned : node->resources())
            if (counted.insert(owned).second)
                row.bytes += owned->bytes();
    }
    for (const StageCost& gone : _gone)
        rowOf(rows, gone.name).dispatches += gone.dispatches;
    return rows;
}

std::size_t WorkGraph::bytes() const
{
    std::size_t sum = 0;
    for (const StageCost& row : costs())
        sum += row.bytes;
    return sum;
}

void WorkGraph::releaseGLObjects(osg::State* state)
{
    forget(state ? state->getContextID() : ~0u);
    for (const auto& node : _nodes)
        node->releaseGLObjects(state);
}

void WorkGraph::resizeGLObjectBuffers(unsigned size)
{
    for (const auto& node : _nodes)
        node->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
