#include "io/LevelBuilder.h"

#include <limits>

namespace osgTerrainLight
{

LevelBuilder::LevelBuilder(const PostRect& posts, int base, int last, bool keepsBase)
    : _posts(posts), _base(base), _last(last), _keepsBase(keepsBase)
{
    const int step = 1 << (last - base);
    const PostRect coarsest = posts.coarser(last - base);
    _grid.column = coarsest.column * step;
    _grid.row = coarsest.row * step;
    _grid.width = posts.endColumn() - _grid.column;
    _grid.height = posts.endRow() - _grid.row;
}

std::vector<LevelPlane> LevelBuilder::planes() const
{
    std::vector<LevelPlane> planes;
    if (_keepsBase)
        planes.push_back({_base, _posts, false});
    for (int level = _base + 1; level <= _last; ++level)
        planes.push_back({level, _grid.coarser(level - _base), true});
    return planes;
}

void LevelBuilder::begin(LevelFileWriter& writer)
{
    _writer = &writer;
    _row.assign(static_cast<std::size_t>(_grid.width), std::numeric_limits<float>::quiet_NaN());
    if (_last == _base)
        return;
    const auto take = [this](int level, int row, const auto& heights)
    {
        // A row after a failed one fails, too; the writer remembers.
        for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
            _writer->writeRow(_base + level, axis, row,
                              heights[static_cast<std::size_t>(axis)].data());
    };
    _reducer = std::make_unique<LevelReducer>(_grid.width, _grid.height, _last - _base, take);
    for (int row = _grid.row; row < _posts.row; ++row)
        _reducer->addRow(_row.data());
}

bool LevelBuilder::addRow(const float* heights)
{
    if (_keepsBase)
        _writer->writeRow(_base, CrestAxis::East, _rows, heights);
    ++_rows;
    std::copy(heights, heights + _posts.width, _row.end() - _posts.width);
    if (_reducer)
        _reducer->addRow(_row.data());
    return !_writer->failed();
}

} // namespace osgTerrainLight
