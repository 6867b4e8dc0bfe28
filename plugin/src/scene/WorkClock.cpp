#include "scene/WorkClock.h"

#include <osg/ContextData>
#include <osg/GLExtensions>

#include <algorithm>

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
constexpr double newest = 0.25;        // weight of the last step in the mean

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
        _gone = osg::get<QueryManager>(state.getContextID());
    collect(state);
    _start = std::chrono::steady_clock::now();
    _expected = 0.0;
    _steps = 0;
    mark(state, 0.0);
}

void WorkClock::step(osg::State& state, double posts)
{
    ++_steps;
    _expected += _perPost * posts;
    mark(state, posts);
}

double WorkClock::spent() const
{
    const std::chrono::duration<double, std::milli> wall =
        std::chrono::steady_clock::now() - _start;
    return std::max(wall.count(), _expected);
}

void WorkClock::mark(osg::State& state, double posts)
{
    const auto* gl = state.get<osg::GLExtensions>();
    if (!gl->isARBTimerQuerySupported || _marks.size() >= mostMarks)
        return;
    Mark mark;
    mark.posts = posts;
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
        if (mark.posts > 0.0 && time >= _last)
        {
            const double perPost = 1.0e-6 * static_cast<double>(time - _last) / mark.posts;
            _perPost += (_perPost > 0.0 ? newest : 1.0) * (perPost - _perPost);
        }
        _last = time;
    }
}

} // namespace osgTerrainLight
