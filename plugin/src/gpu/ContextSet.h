#pragma once

#include <algorithm>
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

    bool hasAllOf(const ContextSet& other) const
    {
        const std::set<unsigned> theirs = other.contexts();
        const std::set<unsigned> ours = contexts();
        return std::includes(ours.begin(), ours.end(), theirs.begin(), theirs.end());
    }

private:
    std::set<unsigned> contexts() const
    {
        std::lock_guard<std::mutex> lock(_mutex);
        return _contexts;
    }

    mutable std::mutex _mutex;
    std::set<unsigned> _contexts;
};

} // namespace osgTerrainLight
