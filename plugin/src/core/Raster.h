#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// A two-dimensional array, row-major, bounds-checked by assertion. Row 0 is the southernmost.
template <class T>
class Raster
{
public:
    Raster() = default;
    Raster(int width, int height, T fill = T())
        : _width(width), _height(height),
          _data(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill)
    {
        assert(width >= 0 && height >= 0);
    }

    int width() const { return _width; }
    int height() const { return _height; }
    std::size_t size() const { return _data.size(); }
    bool empty() const { return _data.empty(); }
    bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < _width && y < _height; }

    T& at(int x, int y) { return _data[index(x, y)]; }
    const T& at(int x, int y) const { return _data[index(x, y)]; }

    T* data() { return _data.data(); }
    const T* data() const { return _data.data(); }
    std::vector<T>& values() { return _data; }
    const std::vector<T>& values() const { return _data; }

private:
    std::size_t index(int x, int y) const
    {
        assert(contains(x, y));
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(_width) +
               static_cast<std::size_t>(x);
    }

    int _width = 0;
    int _height = 0;
    std::vector<T> _data;
};

} // namespace osgTerrainLight
