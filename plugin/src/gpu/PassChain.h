#pragma once

#include <osgTerrainLight/Export.h>

#include "core/Result.h"

#include <osg/State>

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What one stage of a chain has cost so far.
struct StageCost
{
    std::string name;
    unsigned dispatches = 0;      ///< runs since creation, all contexts together
    std::size_t bytes = 0;        ///< textures that the stage owns now; 0 where it does not exist
    double gpuMilliseconds = 0.0; ///< timer query of the last run; 0 unless timed (software: wall)
    double milliseconds = 0.0;    ///< wall clock of the last run, ended by glFinish; 0 unless timed
};

/// Ordered stages that run only when a value they depend on has changed.
///
/// A value is anything with a name: heights, settings, the sun, or a texture that an earlier stage
/// writes. Each has a version per graphics context; a stage runs where one of its inputs' versions
/// is not the one it last ran with, and gives its output a new one. Nothing is marked dirty by hand
/// but the values that come from outside.
class OSGTERRAINLIGHT_EXPORT PassChain
{
public:
    using Value = std::size_t;

    /// A value that changes from outside.
    Value addSource();
    void touch(Value source);

    enum class Turn
    {
        Run,
        Wait, ///< not this time: the stage stays behind its inputs, and the chain dirty
        Skip  ///< nothing to do for these inputs
    };

    struct Stage
    {
        std::string name;
        std::vector<Value> inputs;
        /// False: the scene does not need the stage. It then costs no dispatch, and destroy is
        /// called so that it costs no byte.
        std::function<bool()> needed;
        std::function<Status(osg::State&)> run;
        std::function<std::size_t()> bytes;
        std::function<void()> destroy;
        /// Asked in a context where inputs have changed; none: Run.
        std::function<Turn(unsigned contextID)> turn = {};
    };

    /// Stages run in the order in which they are added. Returns the value that the stage writes.
    Value addStage(Stage stage);

    /// Runs what has changed for the state's context, which must be current. Stops at the first
    /// error, or between two stages where mayContinue says so: the next call goes on from there.
    Status run(osg::State& state, const std::function<bool()>& mayContinue = {});

    /// True where run() would run at least one stage.
    bool isDirty(unsigned contextID) const;
    /// The same for the stages up to the one that writes a value.
    bool isDirty(unsigned contextID, Value last) const;

    /// Forget everything that was computed in a context (all contexts: ~0u), as its textures are
    /// gone.
    void forget(unsigned contextID);
    /// The stage that writes a value runs again in a context.
    void forget(unsigned contextID, Value output);

    /// Measure GPU and wall time of each run; each then waits for the GPU.
    void setTimed(bool timed) { _timed = timed; }

    std::vector<StageCost> costs() const;

private:
    struct Entry
    {
        Stage stage;
        Value output;
        StageCost cost;
    };
    using Version = unsigned long;
    struct Context
    {
        std::map<Value, Version> derived;                 ///< versions of stage outputs
        std::map<std::size_t, std::vector<Version>> seen; ///< inputs at each stage's last run
    };

    std::vector<Version> inputVersions(const Entry& entry, const Context& context) const;

    std::vector<Version> _sources; ///< by value; outputs of stages have an unused slot
    std::vector<Entry> _stages;
    std::map<unsigned, Context> _contexts;
    Version _next = 1;
    bool _timed = false;
};

} // namespace osgTerrainLight
