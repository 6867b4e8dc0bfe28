#pragma once

#include <cpl_json.h>

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

/// `terrainlight bench`: rows as CSV and JSON have them.
namespace osgTerrainLight::tool::bench
{

/// Nothing where a row was skipped, or a number does not exist.
using Value = std::variant<std::monostate, std::string, std::int64_t, double>;

struct Cell
{
    std::string column;
    Value value;
};

/// Rows of the same columns, which make the first line.
std::string csvOf(const std::vector<std::vector<Cell>>& rows);
CPLJSONObject jsonOf(const std::vector<Cell>& row);

} // namespace osgTerrainLight::tool::bench
