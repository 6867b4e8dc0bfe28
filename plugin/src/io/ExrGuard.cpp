#include "io/ExrGuard.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <system_error>

namespace osgTerrainLight
{

namespace
{
/// OpenEXR's integers are little-endian.
std::uint32_t nextInteger(std::istream& file)
{
    std::array<char, 4> bytes = {};
    file.read(bytes.data(), bytes.size());
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
        value |= std::uint32_t(static_cast<unsigned char>(bytes[i])) << (8 * i);
    return value;
}

/// Bytes that a list of channels has: name, 16 bytes, and an empty name at its end.
std::uint64_t lengthOfChannels(std::istream& file)
{
    std::uint64_t length = 0;
    std::string name;
    while (std::getline(file, name, '\0'))
    {
        length += name.size() + 1;
        if (name.empty())
            break;
        length += 16;
        file.seekg(16, std::ios::cur);
    }
    return length;
}
} // namespace

// OpenEXR file layout, https://openexr.com/en/latest/OpenEXRFileLayout.html
Status checkExrFile(const std::string& path)
{
    std::error_code failure;
    if (!std::filesystem::exists(path, failure))
        return Error{ErrorCode::NotFound, path + ": no such file"};
    if (std::filesystem::is_directory(path, failure))
        return Error{ErrorCode::Invalid, path + ": is a folder; needed an OpenEXR file"};
    const std::uintmax_t size = std::filesystem::file_size(path, failure);
    std::ifstream file(path, std::ios::binary);
    constexpr std::uint32_t magic = 0x01312f76, manyParts = 0x1000;
    if (failure || !file || nextInteger(file) != magic)
        return Nothing{}; // the library has the words for it
    const bool hasParts = (nextInteger(file) & manyParts) != 0;
    static const std::map<std::string, std::uint32_t> lengths = {
        {"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
        {"compression", 1}, {"double", 8},   {"envmap", 1},
        {"float", 4},       {"int", 4},      {"keycode", 28},
        {"lineOrder", 1},   {"m33f", 36},    {"m44f", 64},
        {"rational", 8},    {"tiledesc", 9}, {"timecode", 8},
        {"v2f", 8},         {"v2i", 8},      {"v3f", 12},
        {"v3i", 12}};
    // Headers of attributes (name, type, length, value), an empty name after each; of several parts
    // another one after the last.
    bool isFirst = true;
    std::string name, type;
    while (std::getline(file, name, '\0') && !(name.empty() && (isFirst || !hasParts)))
    {
        isFirst = name.empty();
        if (isFirst)
            continue;
        std::getline(file, type, '\0');
        const std::uint32_t length = nextInteger(file);
        if (!file)
            break;
        const auto start = file.tellg();
        std::uint64_t needed = length;
        if (const auto known = lengths.find(type); known != lengths.end())
            needed = known->second;
        else if (type == "chlist")
            needed = lengthOfChannels(file);
        if (length > size || length != needed)
            return Error{ErrorCode::Invalid,
                         path + ": cannot be read as OpenEXR: attribute " + name.substr(0, 64) +
                             " claims " + std::to_string(length) + " bytes; needed " +
                             (length > size ? "at most the file's " + std::to_string(size)
                                            : std::to_string(needed))};
        file.clear();
        file.seekg(start + static_cast<std::streamoff>(length));
    }
    return Nothing{};
}

} // namespace osgTerrainLight
