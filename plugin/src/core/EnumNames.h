#pragma once

#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include <array>
#include <string>

namespace osgTerrainLight
{

/// The names of an enumeration's values, in their order.
template <class Enum>
struct EnumNames;

template <>
struct EnumNames<HorizonQuality>
{
    static constexpr std::array<const char*, 3> names = {"draft", "normal", "best"};
};

template <>
struct EnumNames<BounceMethod>
{
    static constexpr std::array<const char*, 3> names = {"slices", "legendre", "legendre-bspline"};
};

template <>
struct EnumNames<GlossTransfer>
{
    static constexpr std::array<const char*, 2> names = {"vector", "scalar"};
};

template <>
struct EnumNames<SkyModel>
{
    static constexpr std::array<const char*, 3> names = {"uniform", "overcast", "clear"};
};

template <>
struct EnumNames<bool>
{
    static constexpr std::array<const char*, 2> names = {"off", "on"};
};

template <class Enum>
const char* nameOf(Enum value)
{
    return EnumNames<Enum>::names[static_cast<std::size_t>(value)];
}

/// False where the text is none of the names; value is then unchanged.
template <class Enum>
bool readName(const std::string& text, Enum& value)
{
    const auto& names = EnumNames<Enum>::names;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (text == names[i])
        {
            value = static_cast<Enum>(i);
            return true;
        }
    return false;
}

} // namespace osgTerrainLight
