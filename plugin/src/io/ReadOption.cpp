#include "io/ReadOption.h"

#include <charconv>
#include <cmath>

namespace osgTerrainLight
{

Status setReadOption(DemReadOptions& options, const std::string& name, const std::string& value)
{
    const auto wrong = [&](const char* needed) {
        return Error{ErrorCode::Invalid, name + " = \"" + value + "\": needs " + needed};
    };
    if (name == "unit")
    {
        if (!metresPerHeightUnit(value))
            return wrong("a unit of length such as m, ft or us-ft");
        options.heightUnit = value;
        return Nothing{};
    }
    double number = 0.0;
    const char* end = value.data() + value.size();
    const auto [stop, failed] = std::from_chars(value.data(), end, number);
    const bool isNumber = failed == std::errc() && stop == end && std::isfinite(number);
    if (name == "cell_size")
    {
        if (!isNumber || !(number > 0.0))
            return wrong("a number of metres more than 0");
        options.cellSize = number;
        return Nothing{};
    }
    if (name != "z_factor")
        return Error{ErrorCode::Invalid, name + ": is no key of how heights are read"};
    if (!isNumber || number == 0.0)
        return wrong("a number that is not 0");
    options.heightFactor = number;
    return Nothing{};
}

} // namespace osgTerrainLight
