#include "gpu/WorkPace.h"

#include <algorithm>

namespace osgTerrainLight
{

namespace
{
thread_local PacedRun* currentRun = nullptr;

using Groups = GpuPass::Groups;

/// The largest box of groups that begins with group `done`, counted along x, then y, then z, and
/// has no more than `most`.
void boxAt(const Groups& all, unsigned done, unsigned most, Groups& first, Groups& count)
{
    const unsigned layer = all.x * all.y;
    first = {done % all.x, done % layer / all.x, done / layer};
    if (first.x == 0 && first.y == 0 && most >= layer)
        count = {all.x, all.y, most / layer};
    else if (first.x == 0 && most >= all.x)
        count = {all.x, std::min(most / all.x, all.y - first.y), 1};
    else
        count = {std::min(most, all.x - first.x), 1, 1};
}
} // namespace

bool WorkPace::goesOn()
{
    if (!mayContinue())
        _isStopped = true;
    return !_isStopped;
}

unsigned WorkPace::next(const std::string& kind, unsigned left, unsigned least)
{
    const unsigned groups = choose(kind, left, least);
    if (groups == 0)
        _isStopped = true;
    return groups == 0 ? 0 : std::clamp(groups, least, left);
}

void WorkPace::ran(const std::string&, unsigned) {}

unsigned WorkPace::choose(const std::string&, unsigned left, unsigned)
{
    return left;
}

PacedRun::PacedRun(std::string node, WorkProgress& progress, WorkPace* pace)
    : _node(std::move(node)), _progress(progress), _pace(pace), _outer(currentRun)
{
    currentRun = this;
}

PacedRun::~PacedRun()
{
    currentRun = _outer;
}

PacedRun* PacedRun::current()
{
    return currentRun;
}

Status PacedRun::dispatch(const std::string& pass, Groups groups, bool isWhole,
                          const Dispatch& dispatch)
{
    if (_met++ < _progress.dispatches)
        return Nothing{};
    const std::string kind =
        _node + '/' + pass + ' ' + std::to_string(groups.x) + 'x' + std::to_string(groups.y);
    const unsigned all = groups.x * groups.y * groups.z;
    while (_progress.groups < all)
    {
        const unsigned left = all - _progress.groups;
        unsigned now = left;
        if (_pace && !_mustEnd)
            now = _pace->next(kind, left, isWhole ? left : 1);
        if (now == 0)
        {
            _isStopped = true;
            return Error{ErrorCode::Failed, kind + ": to be continued"};
        }
        Groups first, count;
        boxAt(groups, _progress.groups, now, first, count);
        if (Status done = dispatch(first, count); !done)
            return done;
        now = count.x * count.y * count.z;
        if (_pace)
            _pace->ran(kind, now);
        _progress.groups += now;
    }
    _mustEnd = _mustEnd || isWhole;
    ++_progress.dispatches;
    _progress.groups = 0;
    return Nothing{};
}

} // namespace osgTerrainLight
