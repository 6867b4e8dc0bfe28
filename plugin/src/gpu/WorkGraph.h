#pragma once

#include "core/Result.h"
#include "gpu/GpuPass.h"
#include "gpu/Resource.h"
#include "gpu/WorkPace.h"

#include <osg/Referenced>
#include <osg/State>

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What the nodes of one name have cost so far.
struct StageCost
{
    std::string name;
    unsigned dispatches = 0;      ///< runs since creation, all contexts together
    std::size_t bytes = 0;        ///< textures that they own now; 0 where they are not needed
    double gpuMilliseconds = 0.0; ///< timer query of the last run; 0 unless timed (software: wall)
    double milliseconds = 0.0;    ///< wall clock of the last run, ended by glFinish; 0 unless timed
};

/// Passes and textures of one purpose. It counts, releases and resizes all that it owns, so that no
/// class that computes something has to.
class GpuWork : public osg::Referenced
{
public:
    /// Of all textures that exist.
    std::size_t bytes() const;
    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

    /// Its own resources, then those of the work that it owns.
    std::vector<Resource*> resources() const;

protected:
    ~GpuWork() override = default;

    Resource* own(Resource* resource);
    GpuPass* own(GpuPass* pass);
    template <class T>
    T* own(T* work)
    {
        _works.push_back(work);
        return work;
    }

private:
    std::vector<osg::ref_ptr<Resource>> _resources;
    std::vector<osg::ref_ptr<GpuPass>> _passes;
    std::vector<osg::ref_ptr<GpuWork>> _works;
};

/// A piece of work of a WorkGraph. A subclass declares in its constructor what it reads, writes and
/// owns; run() sets uniforms and dispatches.
class Node : public GpuWork
{
public:
    /// Nodes of one name are counted together.
    const std::string& name() const { return _name; }

    /// Where the condition does not hold the scene does not need the node: it costs no dispatch,
    /// and what it owns no byte.
    void neededWhere(std::function<bool()> condition) { _needed = std::move(condition); }
    bool needed() const { return !_needed || _needed(); }

    /// The node runs where this has changed, too.
    void follows(Resource* value) { reads(value); }

    /// Needs a current context. All that the node writes and owns exists. Where the graph stopped
    /// within the node's dispatches it runs again, and must come to the same ones.
    virtual Status run(osg::State& state) = 0;

    /// What the driver keeps while the node runs, beside textures [bytes].
    virtual std::size_t workingBytes() const { return 0; }

protected:
    explicit Node(std::string name) { _name = std::move(name); }
    ~Node() override = default;

    /// The node runs where this has changed. expected: the layout that its shaders are written for.
    void reads(Resource* resource, const TextureLayout& expected = {});
    /// This is read, too, but a change of it makes the node stale and does not let it run.
    void samples(Resource* resource);
    /// The first, or where the light is paced the second, of these two.
    void followsLight(Resource* light, bool isPaced) { isPaced ? samples(light) : reads(light); }
    /// Every run makes a new version of this. No other node may write it.
    Resource* writes(Resource* resource);

private:
    friend class WorkGraph;
    struct Read
    {
        osg::ref_ptr<Resource> resource;
        TextureLayout expected; ///< empty: any
    };
    using Versions = std::vector<Resource::Version>;
    struct Seen
    {
        Versions reads, samples;
        bool operator==(const Seen& other) const
        {
            return reads == other.reads && samples == other.samples;
        }
    };
    struct Partly
    {
        Seen seen;
        WorkProgress progress;
    };

    std::string _name;
    std::function<bool()> _needed;
    std::vector<Read> _reads;
    std::vector<osg::ref_ptr<Resource>> _samples, _writes;
    std::map<unsigned, Seen> _seen;     ///< of the last run in each context
    std::map<unsigned, Partly> _partly; ///< of a run that stopped within the node
    bool _exists = false;               ///< what it owns was made, and not dropped since
    StageCost _cost;
};

/// Declared work: nodes that run, in order, where they are behind what they read.
///
/// Nothing is marked dirty by hand but values from outside (Resource::touch()), and nothing is
/// written in place: a node that adds to light reads one resource and writes another. Resources may
/// be those of another graph. isDirty(), isStale() and costs() may be called while run() computes
/// in another thread; all other functions come from one thread at a time.
class WorkGraph
{
public:
    using Nodes = std::vector<osg::ref_ptr<Node>>;

    /// Takes these nodes in place of those there were. A node that stays is not run again for that;
    /// what only nodes owned that go is dropped. An error, and no change, where two nodes write one
    /// resource, a node reads what itself or a later one writes, or a resource has another layout
    /// than its reader expects.
    Status declare(Nodes nodes);

    /// Runs what is behind in the state's context, which must be current. Stops at the first error,
    /// or where the pace says so, between two nodes or within the dispatches of one: the next call
    /// goes on from there. A node that is partly done counts as behind, and begins anew where what
    /// it reads has changed since.
    Status run(osg::State& state, WorkPace* pace = nullptr);

    /// True where run() would do something, or where isStale().
    bool isDirty(unsigned contextID) const;
    /// True where run() would do nothing, but a node has sampled what has changed since.
    bool isStale(unsigned contextID) const;

    /// Forgets everything that was computed in a context (all contexts: ~0u).
    void forget(unsigned contextID);

    /// Measures GPU and wall time of each run; each then waits for the GPU.
    void setTimed(bool timed) { _timed = timed; }

    /// By name, in the order of the nodes; names that are gone but have run come last.
    std::vector<StageCost> costs() const;
    /// Of all nodes.
    std::size_t bytes() const;

    /// Of all nodes; what was computed in the context is forgotten.
    void releaseGLObjects(osg::State* state);
    void resizeGLObjectBuffers(unsigned size);

private:
    enum class State
    {
        Current,
        Stale,
        Behind
    };
    static State stateOf(const Node& node, unsigned contextID);
    State worst(unsigned contextID) const;
    void retire(Node& node);
    void dropUnowned(const std::vector<Resource*>& resources);
    static Status runNode(osg::State& state, Node& node, WorkProgress& progress, WorkPace* pace);
    Status runTimed(osg::State& state, Node& node, WorkProgress& progress, WorkPace* pace) const;

    mutable std::mutex _mutex; ///< of all but what nodes compute
    Nodes _nodes;
    std::vector<StageCost> _gone; ///< of nodes that are no longer declared
    bool _timed = false;
};

} // namespace osgTerrainLight
