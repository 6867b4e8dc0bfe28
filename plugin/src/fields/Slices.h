#pragma once

#include <functional>

namespace osgTerrainLight
{

/// Calls work(i) for each i of 0 … count − 1, on all processors, the calling thread among them.
/// After each of its own, the calling thread calls progress with the share that is done; where that
/// returns false, no further call begins. Returns whether all was done. work may not throw.
bool forEachSlice(int count, const std::function<void(int)>& work,
                  const std::function<bool(double)>& progress);

} // namespace osgTerrainLight
