#pragma once

#include "io/DemReader.h"
#include "io/GroundSpacing.h"
#include "io/HeightReader.h"
#include "io/HeightSurvey.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

/// The DEM of heights [m] at the posts of a frame, as readDem() makes it: by the map's scale, and
/// void beyond a pole. heightAt(column, row): of a post in the tile's order; NaN where void.
/// notes: what there is to say about the heights. path: for messages.
template <class HeightAt>
Result<DemFile> placeHeights(const std::string& path, const RasterFrame& frame,
                             const GroundSpacing& ground, std::vector<std::string> notes,
                             const HeightAt& heightAt)
{
    HeightRange range;
    const auto eachHeight = [&](const auto& take)
    {
        for (int row = 0; row < frame.height; ++row)
            for (int column = 0;
                 column < frame.width && !isBeyondPole(ground, frame, frame.fileRow(row)); ++column)
                if (const double height = heightAt(column, row); !std::isnan(height))
                    take(column, row, height);
    };
    eachHeight([&](int, int, double height) { range.add(height); });
    if (range.count == 0)
        return Error{ErrorCode::Invalid, path + ": holds no valid height between the poles"};

    DemFile file;
    file.frame = frame;
    file.lowest = range.lowest;
    file.highest = range.highest;
    file.notes = std::move(notes);
    if (const std::string note = noteOfSlopes(ground, file.lowest, file.highest); !note.empty())
        file.notes.push_back(note);
    DemTile& tile = file.tile;
    tile = DemTile(frame.width, frame.height, ground.north);
    tile.eastSpacings = ground.east;
    tile.heightOrigin = originOfHeights(file.lowest, file.highest);
    tile.crs = frame.crs;
    tile.mapStepX = std::abs(frame.geoTransform[1]);
    tile.mapStepY = std::abs(frame.geoTransform[5]);
    tile.mapOriginX = frame.mapX(0);
    tile.mapOriginY = frame.mapY(0);
    // Posts of a new tile are void.
    std::size_t beyond = 0;
    eachHeight(
        [&](int column, int row, double height)
        {
            tile.setHeight(
                column, row,
                static_cast<float>((height - tile.heightOrigin) * ground.factors.at(column, row)));
            beyond += tile.isValid(column, row) ? 0u : 1u;
        });
    if (auto error = tellOfBeyond(path, beyond, range.count, file.notes))
        return *error;
    return file;
}

} // namespace osgTerrainLight
