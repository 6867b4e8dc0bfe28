#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// A three-dimensional array, x fastest, then y, then z, bounds-checked by assertion. Row 0 is the
/// southernmost, slice 0 the lowest.
template <class T>
class Volume
{
public:
    Volume() = default;
    Volume(int width, int height, int depth, T fill = T())
        : _width(width), _height(height), _depth(depth),
          _data(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                    static_cast<std::size_t>(depth),
                fill)
    {
        assert(width >= 0 && height >= 0 && depth >= 0);
    }

    int width() const { return _width; }
    int height() const { return _height; }
    int depth() const { return _depth; }

    T& at(int x, int y, int z) { return _data[index(x, y, z)]; }
    const T& at(int x, int y, int z) const { return _data[index(x, y, z)]; }

    const std::vector<T>& values() const { return _data; }

private:
    std::size_t index(int x, int y, int z) const
    {
        assert(x >= 0 && y >= 0 && z >= 0 && x < _width && y < _height && z < _depth);
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(_height) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(_width) +
               static_cast<std::size_t>(x);
    }

    int _width = 0;
    int _height = 0;
    int _depth = 0;
    std::vector<T> _data;
};

} // namespace osgTerrainLight
