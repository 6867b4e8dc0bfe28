#include "reference/LatinSupercube.h"

#include <cassert>
#include <numeric>
#include <utility>

namespace osgTerrainLight::reference
{

namespace
{
constexpr std::uint64_t step = 0x9e3779b97f4a7c15u; // SplitMix64's: 2^64 over the golden ratio

/// Van der Corput: the index's bits, mirrored.
std::uint32_t vanDerCorput(std::uint32_t index)
{
    std::uint32_t bits = 0;
    for (std::uint32_t bit = 1u << 31; index != 0; index >>= 1, bit >>= 1)
        if (index & 1u)
            bits |= bit;
    return bits;
}

/// Sobol's second dimension: its direction numbers are Pascal's triangle modulo 2.
std::uint32_t sobol(std::uint32_t index)
{
    std::uint32_t bits = 0;
    for (std::uint32_t direction = 1u << 31; index != 0; index >>= 1, direction ^= direction >> 1)
        if (index & 1u)
            bits ^= direction;
    return bits;
}
} // namespace

std::uint64_t mixed(std::uint64_t value)
{
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return value ^ (value >> 31);
}

LatinSupercube::LatinSupercube(int count)
{
    assert(count > 0 && (count & (count - 1)) == 0);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i)
        _sequence.push_back({vanDerCorput(i), sobol(i)});
}

void LatinSupercube::start(std::uint64_t stream)
{
    _stream = stream;
    for (Pair& pair : _pairs)
        pair.ready = false;
}

void LatinSupercube::prepare(Pair& pair, std::uint64_t key) const
{
    const auto next = [&key] { return mixed(key += step); };
    pair.shift = {next(), next()};
    pair.order.resize(_sequence.size());
    std::iota(pair.order.begin(), pair.order.end(), 0u);
    // Fisher and Yates. Not std::shuffle: its order differs between standard libraries.
    for (std::size_t left = pair.order.size(); left > 1; --left)
        std::swap(pair.order[left - 1], pair.order[((next() >> 32) * left) >> 32]);
    pair.ready = true;
}

std::array<double, 2> LatinSupercube::point(int pair, int index)
{
    const std::size_t p = static_cast<std::size_t>(pair);
    if (p >= _pairs.size())
        _pairs.resize(p + 1);
    if (!_pairs[p].ready)
        prepare(_pairs[p], mixed(_stream + step * (p + 1)));
    const auto& bits = _sequence[_pairs[p].order[static_cast<std::size_t>(index)]];
    std::array<double, 2> result = {};
    for (std::size_t k = 0; k < 2; ++k)
    {
        const std::uint64_t shifted = (std::uint64_t(bits[k]) << 32) ^ _pairs[p].shift[k];
        result[k] = static_cast<double>(shifted >> 11) * 0x1p-53;
    }
    return result;
}

} // namespace osgTerrainLight::reference
