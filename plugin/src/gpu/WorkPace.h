#pragma once

#include "core/Result.h"
#include "gpu/GpuPass.h"

#include <functional>
#include <string>

namespace osgTerrainLight
{

/// Says how far a WorkGraph runs before it stops.
class WorkPace
{
public:
    virtual ~WorkPace() = default;

    /// Whether something was left for another call.
    bool isStopped() const { return _isStopped; }

    /// Asked between two nodes.
    bool goesOn();
    /// How many of the `left` groups of a dispatch run now: none, or `least` and more. kind: of
    /// dispatches that cost the same per group.
    unsigned next(const std::string& kind, unsigned left, unsigned least);
    /// So many have run.
    virtual void ran(const std::string& kind, unsigned groups);

protected:
    virtual bool mayContinue() = 0;
    /// As next(); by default all.
    virtual unsigned choose(const std::string& kind, unsigned left, unsigned least);

private:
    bool _isStopped = false;
};

/// What of a node's dispatches was done before its run stopped.
struct WorkProgress
{
    unsigned dispatches = 0; ///< whole ones
    unsigned groups = 0;     ///< of the next one
};

/// A node's run in pieces. While one lives, GpuPass::dispatch() on its thread leaves out what was
/// done before, and gives an error where the run stops: the node is then run again, from its first
/// line, and comes to the same dispatches in the same order.
class PacedRun
{
public:
    /// pace: null runs all that is left. Both must outlive it.
    PacedRun(std::string node, WorkProgress& progress, WorkPace* pace);
    ~PacedRun();
    PacedRun(const PacedRun&) = delete;
    PacedRun& operator=(const PacedRun&) = delete;

    /// Of this thread; null where there is none.
    static PacedRun* current();

    bool isStopped() const { return _isStopped; }

    /// isWhole: it is not cut, nor does the run stop after it.
    using Dispatch = std::function<Status(GpuPass::Groups first, GpuPass::Groups count)>;
    Status dispatch(const std::string& pass, GpuPass::Groups groups, bool isWhole,
                    const Dispatch& dispatch);

private:
    std::string _node;
    WorkProgress& _progress;
    WorkPace* _pace;
    PacedRun* _outer;
    unsigned _met = 0; ///< dispatches
    bool _isStopped = false, _mustEnd = false;
};

} // namespace osgTerrainLight
