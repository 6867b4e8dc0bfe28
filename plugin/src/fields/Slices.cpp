#include "fields/Slices.h"

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace osgTerrainLight
{

bool forEachSlice(int count, const std::function<void(int)>& work,
                  const std::function<bool(double)>& progress)
{
    std::atomic<int> next{0}, done{0};
    std::atomic<bool> givenUp{false};
    const auto workOn = [&](bool isCaller)
    {
        for (int i = next++; i < count && !givenUp; i = next++)
        {
            work(i);
            const int soFar = ++done;
            if (isCaller && progress && !progress(double(soFar) / count))
                givenUp = true;
        }
    };
    std::vector<std::thread> others;
    const int processors = static_cast<int>(std::thread::hardware_concurrency());
    for (int i = 1; i < std::min(processors, count); ++i)
    {
        try
        {
            others.emplace_back(workOn, false);
        }
        catch (const std::system_error&)
        {
            break; // the system has no more threads: fewer do the same work
        }
    }
    workOn(true);
    for (std::thread& other : others)
        other.join();
    return !givenUp;
}

} // namespace osgTerrainLight
