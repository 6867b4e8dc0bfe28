#include "scene/WorkClock.h"

#include "gpu/GpuCapabilities.h"

#include <osg/ContextData>
#include <osg/GLExtensions>

#include <algorithm>
#include <chrono>

#ifndef GL_TIMESTAMP
#define GL_TIMESTAMP 0x8E28
#endif
#ifndef GL_QUERY_RESULT
#define GL_QUERY_RESULT 0x8866
#define GL_QUERY_RESULT_AVAILABLE 0x8867
#endif

namespace osgTerrainLight
{

namespace
{
constexpr std::size_t mostMarks = 256; // a driver that is so far behind is not asked for more
// Weight of the newest piece in a mean that it raises or lowers.
constexpr double higher = 0.5, lower = 0.25;
constexpr double rising = 1.2;    // of the least, per piece: about eight matter
constexpr double growing = 2.0;   // pieces of a kind, at most, over their mean
constexpr double slowed = 0.25;   // least over mean, where other threads are in the way
constexpr double tolerated = 1.1; // of the budget: as much again is left for what is not foreseen
constexpr double largest = 1.0 / 8.0; // piece, of the budget
// A first piece takes as long [ms] where the budget is less: more pieces would cost more.
constexpr double shortest = 0.5;
constexpr unsigned unmeasured = 4; // groups of a piece of unknown cost: one per core of a small one

class QueryManager : public osg::GLObjectManager
{
public:
    explicit QueryManager(unsigned contextID)
        : osg::GLObjectManager("osgTerrainLight::WorkClock", contextID)
    {
    }
    void deleteGLObject(GLuint query) override
    {
        osg::GLExtensions::Get(_contextID, true)->glDeleteQueries(1, &query);
    }

private:
    ~QueryManager() override = default;
};
} // namespace

WorkClock::WorkClock(Now now) : _now(std::move(now))
{
    if (_now)
        return;
    _now = []
    {
        const auto time = std::chrono::steady_clock::now().time_since_epoch();
        return std::chrono::duration<double, std::milli>(time).count();
    };
}

WorkClock::~WorkClock()
{
    for (const Mark& mark : _marks)
        _gone->scheduleGLObjectForDeletion(mark.query);
    for (const GLuint query : _queries)
        _gone->scheduleGLObjectForDeletion(query);
}

void WorkClock::begin(osg::State& state)
{
    if (!_gone)
    {
        _gone = osg::get<QueryManager>(state.getContextID());
        const auto capabilities = GpuCapabilities::query(state);
        _isSoftware = capabilities && capabilities->isSoftware();
    }
    if (_isSoftware)
        glFinish(); // else the first piece would wait for what was drawn last, and seem to take it
    collect(state);
    const osg::FrameStamp* stamp = state.getFrameStamp();
    const long long frame = stamp ? static_cast<long long>(stamp->getFrameNumber()) : -1;
    if (frame < 0 || frame != _frame)
    {
        _before = 0.0;
        _expected = 0.0;
        _steps = 0;
    }
    _frame = frame;
    _begun = _started = _now();
    mark(state, nullptr, 0);
}

void WorkClock::step(osg::State& state, const std::string& kind, unsigned groups)
{
    Cost& cost = _costs[kind];
    ++_steps;
    _expected += cost.gpu.value() * groups;
    mark(state, &cost, groups);
    cost.wall.add((_now() - _started) / groups, groups);
}

double WorkClock::spent() const
{
    return std::max(wall(), _expected);
}

double WorkClock::expected(const std::string& kind) const
{
    const auto found = _costs.find(kind);
    return found == _costs.end() ? 0.0
                                 : std::max(found->second.wall.value(), found->second.gpu.value());
}

double WorkClock::least(const std::string& kind) const
{
    const auto found = _costs.find(kind);
    return found == _costs.end() ? 0.0
                                 : std::max(found->second.wall.least(), found->second.gpu.least());
}

double WorkClock::groups(const std::string& kind) const
{
    const auto found = _costs.find(kind);
    return found == _costs.end() ? 0.0 : found->second.wall.groups();
}

/// The first piece of a kind also compiles shaders: what is far below the mean takes its place. But
/// groups of a kind need not take the same (those at the ends of a sweep have short lines, or
/// none), so that a piece of few groups says little.
void WorkClock::Mean::add(double value, unsigned groups)
{
    value = std::max(value, 1.0e-9); // a clock that is too coarse
    if (_value == 0.0)
    {
        _value = _least = value;
        _groups = 1.0;
        return;
    }
    const double part = std::min(groups / _groups, 1.0);
    const bool isTypical = part >= 0.75;
    if (isTypical)
        _least = std::min(value, rising * _least);
    if (isTypical && value < 0.5 * _value)
        _value = value;
    else
        _value += part * (value > _value ? higher : lower) * (value - _value);
    _groups += lower * (groups - _groups);
}

void WorkClock::mark(osg::State& state, Cost* cost, unsigned groups)
{
    const auto* gl = state.get<osg::GLExtensions>();
    // Software's own clock does not see compute work; it has run once the call returns.
    if (_isSoftware || !gl->isARBTimerQuerySupported || _marks.size() >= mostMarks)
    {
        _hasGap = true;
        return;
    }
    Mark mark;
    mark.cost = _hasGap ? nullptr : cost;
    mark.groups = groups;
    _hasGap = false;
    if (_queries.empty())
        gl->glGenQueries(1, &mark.query);
    else
    {
        mark.query = _queries.back();
        _queries.pop_back();
    }
    gl->glQueryCounter(mark.query, GL_TIMESTAMP);
    _marks.push_back(mark);
}

void WorkClock::collect(osg::State& state)
{
    const auto* gl = state.get<osg::GLExtensions>();
    while (!_marks.empty())
    {
        const Mark mark = _marks.front();
        GLuint there = 0;
        gl->glGetQueryObjectuiv(mark.query, GL_QUERY_RESULT_AVAILABLE, &there);
        if (!there)
            return;
        GLuint64 time = 0;
        gl->glGetQueryObjectui64v(mark.query, GL_QUERY_RESULT, &time);
        _queries.push_back(mark.query);
        _marks.pop_front();
        if (mark.cost && time >= _last)
            mark.cost->gpu.add(1.0e-6 * static_cast<double>(time - _last) / mark.groups,
                               mark.groups);
        _last = time;
    }
}

void FramePace::ran(const std::string& kind, unsigned groups)
{
    _clock.step(_state, kind, groups);
}

bool FramePace::mayContinue()
{
    return _limit <= 0.0 || _clock.steps() == 0 || _clock.spent() < _limit;
}

unsigned FramePace::choose(const std::string& kind, unsigned left, unsigned least)
{
    _clock.start();
    if (_limit <= 0.0)
        return left;
    const bool isFirst = _clock.steps() == 0;
    const double each = _clock.expected(kind);
    if (each == 0.0)
        return isFirst ? std::max(least, std::min(left, unmeasured)) : 0;
    const double spent = _clock.spent();
    if (!isFirst && (spent >= _limit || spent + each * least > tolerated * _limit))
        return 0;
    double time = std::min(_limit - spent, largest * _limit);
    if (isFirst)
        time = std::max(time, shortest);
    // By the least: where other threads are in the way, pieces by the mean would become smaller and
    // smaller, each as long as the wait for a processor. But groups of a kind need not take the
    // same, so the mean bounds pieces, and what is left of the frame goes by it.
    const double mild = std::max(_clock.least(kind), slowed * each);
    const double room = tolerated * _limit - spent;
    const double groups = std::min({time / mild, (isFirst ? std::max(room, shortest) : room) / each,
                                    growing * _clock.groups(kind), static_cast<double>(left)});
    return std::max(least, static_cast<unsigned>(std::max(groups, 0.0)));
}

} // namespace osgTerrainLight
