#pragma once

#include <osg/GLObjects>
#include <osg/State>
#include <osg/ref_ptr>

#include <chrono>
#include <deque>
#include <vector>

namespace osgTerrainLight
{

/// How long the steps of a frame take on the GPU, without waiting for them. Software OpenGL runs a
/// dispatch before the call returns, so the clock on the wall has seen it. On hardware dispatches
/// are queued: timer queries of earlier steps, read once their results are there, tell what to
/// expect of a step on so many posts. One per context; all but spent() and the destructor need it
/// current.
class WorkClock
{
public:
    WorkClock() = default;
    /// The context deletes the timer queries when it flushes objects that are gone, in its next
    /// frame.
    ~WorkClock();
    WorkClock(const WorkClock&) = delete;
    WorkClock& operator=(const WorkClock&) = delete;

    /// Starts a frame's work.
    void begin(osg::State& state);
    /// A step on a tile of so many posts has been queued, or run.
    void step(osg::State& state, double posts);
    /// Of the frame's steps so far: measured or expected, whichever is more [ms].
    double spent() const;
    /// Steps since begin().
    unsigned steps() const { return _steps; }

private:
    /// A point on the GPU's time line: where a frame's work begins, or a step ends.
    struct Mark
    {
        GLuint query = 0;
        double posts = 0.0; ///< of the step that ends here; 0: none does
    };
    void mark(osg::State& state, double posts);
    void collect(osg::State& state);

    osg::ref_ptr<osg::GLObjectManager> _gone; ///< queries to be deleted; null before begin()
    std::deque<Mark> _marks;                  ///< whose times have not been read
    std::vector<GLuint> _queries;             ///< to be used again
    GLuint64 _last = 0;                       ///< time of the mark before those [ns]
    double _perPost = 0.0;                    ///< expected [ms], a moving mean
    double _expected = 0.0;                   ///< of this frame's steps [ms]
    unsigned _steps = 0;
    std::chrono::steady_clock::time_point _start;
};

} // namespace osgTerrainLight
