#include "fields/FieldFile.h"

#include "io/PendingFile.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

namespace osgTerrainLight
{

namespace
{
// To be raised where a file, or what the same mesh comes to, changes.
constexpr std::uint32_t version = 1;
constexpr std::size_t mostVoxels = std::size_t(1) << 31; // more than 512 cells and all margins have

/// The start of a file, in the machine's own byte order: a file of the other order has another
/// mark.
struct Header
{
    char mark[8];
    std::uint32_t version;
    std::uint32_t byteOrder;
    FieldKey key;
    std::int32_t size[3];
    float first[3];
    float spacing;
    float unit; ///< of the stored numbers [m]
    double ambiguousShare;
    std::uint64_t checksum; ///< of all else: header, with 0 here, and numbers
};
static_assert(sizeof(Header) == 80 && std::is_trivially_copyable_v<Header>);

/// FNV-1a with 64 bits (Fowler, Noll and Vo), over bytes.
class Fnv
{
public:
    explicit Fnv(std::uint64_t start = 0xcbf29ce484222325u) : _value(start) {}
    void add(const void* data, std::size_t bytes)
    {
        const auto* byte = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < bytes; ++i)
            _value = (_value ^ byte[i]) * 0x100000001b3u;
    }
    std::uint64_t value() const { return _value; }

private:
    std::uint64_t _value;
};

/// A second hash that shares nothing with the first: the finaliser of splitmix64 (Steele et al.
/// 2014) over words.
class Splitmix
{
public:
    void add(const void* data, std::size_t bytes)
    {
        const auto* from = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < bytes; i += 4)
        {
            std::uint32_t word = 0;
            std::memcpy(&word, from + i, std::min<std::size_t>(4, bytes - i));
            std::uint64_t z = (_value += 0x9e3779b97f4a7c15u + word);
            z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
            z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
            _value = z ^ (z >> 31);
        }
    }
    std::uint64_t value() const { return _value; }

private:
    std::uint64_t _value = 0;
};

std::uint64_t checksumOf(Header header, const std::vector<std::int16_t>& numbers)
{
    header.checksum = 0;
    Fnv sum;
    sum.add(&header, sizeof header);
    sum.add(numbers.data(), numbers.size() * sizeof(std::int16_t));
    return sum.value();
}

/// The least power of two that brings all distances into 16 bits. Numbers of it are exact in a
/// float, so that rounding twice is rounding once.
float unitOf(const DistanceGrid& grid)
{
    float greatest = 0.0f;
    for (const float distance : grid.distances)
        greatest = std::max(greatest, std::abs(distance));
    int exponent = 0;
    const float mantissa = std::frexp(greatest / 32767.0f, &exponent); // 0, or 0.5 … 1
    return mantissa == 0.0f ? 0.0f : std::ldexp(1.0f, mantissa == 0.5f ? exponent - 1 : exponent);
}

std::int16_t numberOf(float distance, float unit)
{
    const float number = unit > 0.0f ? std::round(distance / unit) : 0.0f;
    return static_cast<std::int16_t>(std::clamp(number, -32767.0f, 32767.0f));
}

struct Close
{
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;
} // namespace

FieldKey fieldKey(const TriangleMesh& mesh, const BakeOptions& options)
{
    static_assert(sizeof(glm::vec3) == 12 && sizeof(mesh.triangles[0]) == 12);
    const std::uint64_t plain[] = {version, mesh.vertices.size(), mesh.triangles.size(),
                                   static_cast<std::uint64_t>(options.cells),
                                   static_cast<std::uint64_t>(options.margin)};
    Fnv one;
    Splitmix other;
    const auto add = [&](const void* data, std::size_t bytes)
    {
        one.add(data, bytes);
        other.add(data, bytes);
    };
    add(plain, sizeof plain);
    add(mesh.vertices.data(), mesh.vertices.size() * sizeof(glm::vec3));
    add(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
    return {one.value(), other.value()};
}

void roundToFile(DistanceGrid& grid)
{
    const float unit = unitOf(grid);
    for (float& distance : grid.distances)
        distance = unit * static_cast<float>(numberOf(distance, unit));
}

Status writeField(const std::string& path, const FieldKey& key, const BakedField& field)
{
    const DistanceGrid& grid = field.grid;
    Header header{};
    std::memcpy(header.mark, "OTLField", sizeof header.mark);
    header.version = version;
    header.byteOrder = 0x01020304;
    header.key = key;
    for (int k = 0; k < 3; ++k)
    {
        header.size[k] = grid.size[k];
        header.first[k] = grid.first[k];
    }
    header.spacing = grid.spacing;
    header.unit = unitOf(grid);
    header.ambiguousShare = field.ambiguousShare;
    std::vector<std::int16_t> numbers;
    numbers.reserve(grid.distances.size());
    for (const float distance : grid.distances)
        numbers.push_back(numberOf(distance, header.unit));
    header.checksum = checksumOf(header, numbers);

    PendingFile pending(path);
    if (const Status created = pending.create(true); !created)
        return created;
    const File file(std::fopen(pending.path().c_str(), "wb"));
    if (!file || std::fwrite(&header, sizeof header, 1, file.get()) != 1 ||
        std::fwrite(numbers.data(), sizeof(std::int16_t), numbers.size(), file.get()) !=
            numbers.size() ||
        std::fflush(file.get()) != 0)
    {
        const double bytes = double(sizeof header + numbers.size() * sizeof(std::int16_t));
        return Error{ErrorCode::Failed, path + ": " + pending.reason("cannot be written", bytes)};
    }
    return pending.commit();
}

std::optional<BakedField> readField(const std::string& path, const FieldKey& key)
{
    const File file(std::fopen(path.c_str(), "rb"));
    Header header;
    if (!file || std::fread(&header, sizeof header, 1, file.get()) != 1 ||
        std::memcmp(header.mark, "OTLField", sizeof header.mark) != 0 ||
        header.version != version || header.byteOrder != 0x01020304 || header.key != key)
        return std::nullopt;
    std::size_t voxels = 1;
    for (const std::int32_t size : header.size)
    {
        if (size < 1 || static_cast<std::size_t>(size) > mostVoxels / voxels)
            return std::nullopt;
        voxels *= static_cast<std::size_t>(size);
    }
    // Not before it is known that they are there: a damaged size may ask for all memory.
    if (std::fseek(file.get(), 0, SEEK_END) != 0 ||
        std::ftell(file.get()) !=
            static_cast<long>(sizeof header + voxels * sizeof(std::int16_t)) ||
        std::fseek(file.get(), sizeof header, SEEK_SET) != 0)
        return std::nullopt;
    std::vector<std::int16_t> numbers(voxels);
    if (std::fread(numbers.data(), sizeof(std::int16_t), voxels, file.get()) != voxels ||
        header.checksum != checksumOf(header, numbers))
        return std::nullopt;
    BakedField field;
    DistanceGrid& grid = field.grid;
    for (int k = 0; k < 3; ++k)
    {
        grid.size[k] = header.size[k];
        grid.first[k] = header.first[k];
    }
    grid.spacing = header.spacing;
    field.ambiguousShare = header.ambiguousShare;
    grid.distances.reserve(voxels);
    for (const std::int16_t number : numbers)
        grid.distances.push_back(header.unit * static_cast<float>(number));
    return field;
}

} // namespace osgTerrainLight
