#pragma once

#include "io/DemReader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Of a void, in expected and found heights.
inline const double missing = std::numeric_limits<double>::quiet_NaN();

/// Heights [m] in rows of the file.
inline std::vector<double> heightsOf(const DemFile& file)
{
    std::vector<double> heights;
    for (int row = 0; row < file.tile.height(); ++row)
        for (int column = 0; column < file.tile.width(); ++column)
        {
            const int x = file.frame.fileColumn(column);
            const int y = file.frame.fileRow(row);
            heights.push_back(file.tile.isValid(x, y)
                                  ? file.tile.heightOrigin +
                                        static_cast<double>(file.tile.heightAt(x, y))
                                  : missing);
        }
    return heights;
}

/// To float's rounding of what is 1e4 at most.
inline void expectHeights(const DemFile& file, const std::vector<double>& expected)
{
    const std::vector<double> found = heightsOf(file);
    ASSERT_GE(found.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (std::isnan(expected[i]))
            EXPECT_TRUE(std::isnan(found[i])) << i << ": " << found[i];
        else
            EXPECT_NEAR(found[i], expected[i], 1e-3) << i;
}

/// The one note that holds a text, or all of them.
inline std::string noteWith(const DemFile& file, const std::string& text)
{
    std::string all, found;
    int count = 0;
    for (const std::string& note : file.notes)
    {
        if (note.find(text) != std::string::npos)
        {
            found = note;
            ++count;
        }
        all += note + "; ";
    }
    EXPECT_EQ(count, 1) << "notes \"" << text << "\" among: " << all;
    return found;
}

} // namespace osgTerrainLight
