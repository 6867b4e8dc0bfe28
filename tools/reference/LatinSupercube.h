#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace osgTerrainLight::reference
{

/// A well-mixed 64-bit number from any other: the finaliser of SplitMix64 (Steele, Lea, Flood:
/// Fast Splittable Pseudorandom Number Generators, 2014). Neighbouring inputs give unrelated
/// outputs, so keys of streams are built by chaining it.
std::uint64_t mixed(std::uint64_t value);

/// Points for integrals over many dimensions, taken in pairs: Latin supercube sampling (Owen, ACM
/// TOMACS 8(1), 1998). Every pair runs through the same (0,2)-sequence, base 2 (van der Corput and
/// Sobol's second dimension; Kollig and Keller, 2002), each with its own random digital shift and
/// in its own random order. So each pair is stratified as well as points of a plane can be, pairs
/// are independent of each other, and each point is uniform: the mean over a batch is unbiased, and
/// batches of different streams are independent.
class LatinSupercube
{
public:
    /// count: points of a batch, a power of 2, 1 … 2^30.
    explicit LatinSupercube(int count);

    int count() const { return static_cast<int>(_sequence.size()); }

    /// Begins a batch; the stream alone decides its points.
    void start(std::uint64_t stream);

    /// Coordinates of pair `pair` ≥ 0 of point `index` 0 … count − 1, each 0 ≤ x < 1.
    std::array<double, 2> point(int pair, int index);

private:
    struct Pair
    {
        bool ready = false;
        std::array<std::uint64_t, 2> shift = {};
        std::vector<std::uint32_t> order;
    };
    void prepare(Pair& pair, std::uint64_t key) const;

    std::vector<std::array<std::uint32_t, 2>> _sequence;
    std::vector<Pair> _pairs;
    std::uint64_t _stream = 0;
};

} // namespace osgTerrainLight::reference
