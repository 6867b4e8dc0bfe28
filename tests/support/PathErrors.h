#pragma once

#include "reference/PathTracer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <random>
#include <vector>

namespace osgTerrainLight
{

/// Valid posts, drawn with a fixed seed.
inline std::vector<reference::Receiver> randomReceivers(const DemTile& tile, std::size_t count)
{
    std::mt19937 random(11);
    std::vector<reference::Receiver> receivers;
    while (receivers.size() < count)
    {
        reference::Receiver receiver;
        receiver.column = static_cast<int>(random() % static_cast<unsigned>(tile.width()));
        receiver.row = static_cast<int>(random() % static_cast<unsigned>(tile.height()));
        if (tile.isValid(receiver.column, receiver.row))
            receivers.push_back(receiver);
    }
    return receivers;
}

/// Light beside that of the path tracer, whose own noise is subtracted in the mean square.
class PathErrors
{
public:
    /// variance: the square of the expected value's standard error.
    void add(double found, double expected, double variance)
    {
        _squares += (found - expected) * (found - expected);
        _expectedSquares += expected * expected;
        _noise += variance;
        _difference += found - expected;
        _expected += expected;
    }

    double relativeRms() const
    {
        return std::sqrt(std::max(0.0, _squares - _noise) / _expectedSquares);
    }
    double relativeNoise() const { return std::sqrt(_noise / _expectedSquares); }
    double relativeBias() const { return _difference / _expected; }

private:
    double _squares = 0.0, _expectedSquares = 0.0, _noise = 0.0;
    double _difference = 0.0, _expected = 0.0;
};

inline std::ostream& operator<<(std::ostream& out, const PathErrors& errors)
{
    return out << "relative RMS " << 100.0 * errors.relativeRms() << " % (noise "
               << 100.0 * errors.relativeNoise() << " %), bias " << 100.0 * errors.relativeBias()
               << " %";
}

} // namespace osgTerrainLight
