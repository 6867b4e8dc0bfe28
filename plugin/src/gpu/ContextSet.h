#pragma once

#include <mutex>
#include <set>

namespace osgTerrainLight
{

/// Graphics contexts in which something has been computed. Thread-safe.
class ContextSet
{
public:
    void add(unsigned context)
    {
        std::lock_guard<std::mutex> lock(_mutex);
        _contexts.insert(context);
    }
    /// ~0u: all.
    void remove(unsigned context)
    {
        std::lock_guard<std::mutex> lock(_mutex);
        if (context == ~0u)
            _contexts.clear();
        else
            _contexts.erase(context);
    }
    bool has(unsigned context) const
    {
        std::lock_guard<std::mutex> lock(_mutex);
        return _contexts.count(context) > 0;
    }

private:
    mutable std::mutex _mutex;
    std::set<unsigned> _contexts;
};

} // namespace osgTerrainLight
