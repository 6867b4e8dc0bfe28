#pragma once

#include "core/LevelReducer.h"
#include "io/LevelFile.h"

#include <memory>
#include <vector>

namespace osgTerrainLight
{

/// Rows of one level go in, from the south, and those of all coarser levels go into a file, on
/// posts at whole steps from post (0, 0) of the whole terrain.
class LevelBuilder
{
public:
    /// posts: of level `base`. keepsBase: the file holds that level, too, without crests.
    LevelBuilder(const PostRect& posts, int base, int last, bool keepsBase);

    /// What the file has to hold.
    std::vector<LevelPlane> planes() const;

    void begin(LevelFileWriter& writer);
    /// The next row of `posts`. False where it cannot be written.
    bool addRow(const float* heights);

private:
    PostRect _posts; ///< that are given
    PostRect _grid;  ///< with void ones before them, so that it begins at a post of every level
    int _base, _last;
    bool _keepsBase;
    LevelFileWriter* _writer = nullptr;
    std::unique_ptr<LevelReducer> _reducer; ///< none where no level is coarser
    std::vector<float> _row;                ///< of the grid
    int _rows = 0;                          ///< given so far
};

} // namespace osgTerrainLight
