#pragma once

#include "gpu/WorkPace.h"

#include <osg/GLObjects>
#include <osg/State>
#include <osg/ref_ptr>

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// How long the pieces of a frame's work take, without waiting for them. Software OpenGL runs a
/// dispatch before the call returns, so the clock on the wall has seen it. On hardware dispatches
/// are queued: timer queries of earlier pieces, read once their results are there, tell what to
/// expect. One per context; begin(), step() need it current.
class WorkClock
{
public:
    /// Time since some moment [ms].
    using Now = std::function<double()>;

    /// now: by default the clock on the wall.
    explicit WorkClock(Now now = {});
    /// The context deletes the timer queries when it flushes objects that are gone, in its next
    /// frame.
    ~WorkClock();
    WorkClock(const WorkClock&) = delete;
    WorkClock& operator=(const WorkClock&) = delete;

    /// Starts a frame's work, or goes on with that of the same frame.
    void begin(osg::State& state);
    /// A piece is about to run.
    void start() { _started = _now(); }
    /// It has been queued, or run: so many groups of a kind.
    void step(osg::State& state, const std::string& kind, unsigned groups);
    /// The frame's work pauses, or is done.
    void end() { _before = wall(); }

    /// Of the frame's work so far: measured or expected, whichever is more [ms].
    double spent() const;
    /// What a group of a kind takes [ms]: a moving mean; 0 where none has run.
    double expected(const std::string& kind) const;
    /// What it takes where nothing is in the way: the least, which rises slowly.
    double least(const std::string& kind) const;
    /// Of a piece of a kind, a moving mean; 1 after its first one.
    double groups(const std::string& kind) const;
    /// Pieces since the frame began.
    unsigned steps() const { return _steps; }

private:
    class Mean
    {
    public:
        /// value: of a group, in a piece of so many.
        void add(double value, unsigned groups);
        double value() const { return _value; }
        double least() const { return _least; }
        double groups() const { return _groups; }

    private:
        double _value = 0.0; ///< 0: none was added
        double _least = 0.0;
        double _groups = 0.0; ///< of a piece
    };
    struct Cost
    {
        Mean wall, gpu; ///< of a group [ms]
    };
    /// A point on the GPU's time line: where a frame's work begins, or a piece ends.
    struct Mark
    {
        GLuint query = 0;
        Cost* cost = nullptr; ///< of the piece that ends here; null: none does
        unsigned groups = 0;
    };
    double wall() const { return _before + _now() - _begun; }
    void mark(osg::State& state, Cost* cost, unsigned groups);
    void collect(osg::State& state);

    Now _now;
    osg::ref_ptr<osg::GLObjectManager> _gone; ///< queries to be deleted; null before begin()
    std::map<std::string, Cost> _costs;       ///< by kind
    std::deque<Mark> _marks;                  ///< whose times have not been read
    std::vector<GLuint> _queries;             ///< to be used again
    bool _isSoftware = false;
    bool _hasGap = true;                 ///< the mark before the next one is missing
    GLuint64 _last = 0;                  ///< time of the mark before those [ns]
    long long _frame = -1;               ///< its number; -1: not known
    double _before = 0.0;                ///< of this frame's work, until end() [ms]
    double _begun = 0.0, _started = 0.0; ///< on the clock
    double _expected = 0.0;              ///< of this frame's pieces on the GPU [ms]
    unsigned _steps = 0;
};

/// Keeps the work of a frame within its budget.
///
/// A piece whose kind has been measured runs where it is expected to end before a tenth more than
/// the budget has been spent, and takes about an eighth of it, so that no piece whose time turns
/// out otherwise matters much. The first piece of a frame runs in any case, so that the work comes
/// to an end; a kind that was never measured runs as such only. What is not cut is one piece.
class FramePace : public WorkPace
{
public:
    /// limit: the budget [ms]; 0: none. Between the clock's begin() and end().
    FramePace(WorkClock& clock, osg::State& state, double limit)
        : _clock(clock), _state(state), _limit(limit)
    {
    }

    void ran(const std::string& kind, unsigned groups) override;

protected:
    bool mayContinue() override;
    unsigned choose(const std::string& kind, unsigned left, unsigned least) override;

private:
    WorkClock& _clock;
    osg::State& _state;
    double _limit;
};

} // namespace osgTerrainLight
