#pragma once

#include "core/Raster.h"
#include "core/Volume.h"

#include <glm/glm.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace osgTerrainLight
{

/// Whether the library's own calls of shared functions check their preconditions.
#ifdef NDEBUG
constexpr bool glslChecked = false;
#else
constexpr bool glslChecked = true;
#endif

[[noreturn]] inline void glslAssertionFailed(const char* condition, const char* file, int line)
{
    std::fprintf(stderr, "%s:%d: precondition '%s' does not hold\n", file, line, condition);
    std::abort();
}

/// C++ side of the dialect that shaders/lib shares with GLSL: every function of shaders/lib as a
/// member, in the precision of Real (float or double). The other side is preamble.glsl. Checked: a
/// call that breaks a function's precondition ends the program, in any build; a type of its own,
/// so that tests can check where the library does not. Counted: reads of volumes are counted, per
/// thread, for benchmarks.
template <class Real, bool Checked = glslChecked, bool Counted = false>
struct Glsl
{
    using real = Real;
    using Length = Real;
    using Angle = Real;
    using Slope = Real;
    using Radiance = Real;
    using vec2 = glm::vec<2, Real>;
    using vec3 = glm::vec<3, Real>;
    using vec4 = glm::vec<4, Real>;
    using uint = unsigned;
    using ivec2 = glm::ivec2;
    using ivec3 = glm::ivec3;
    using ivec4 = glm::ivec4;
    using sampler2D = const Raster<Real>&;
    using HeightMap = const Raster<Real>&;
    using DistanceVolume = const Volume<Real>&;

    static vec4 texelFetch(sampler2D raster, ivec2 post, int)
    {
        return vec4(raster.at(post.x, post.y), Real(0), Real(0), Real(1));
    }
    static vec4 imageLoad(HeightMap heights, ivec2 post) { return texelFetch(heights, post, 0); }
    static ivec2 textureSize(sampler2D raster, int)
    {
        return ivec2(raster.width(), raster.height());
    }

    /// textureLod() of volumes since the thread set it to 0, where Counted.
    static inline thread_local unsigned long volumeReads = 0;

    /// Trilinear between voxels' centres, clamped to the edge.
    static vec4 textureLod(DistanceVolume volume, vec3 place, Real)
    {
        if constexpr (Counted)
            ++volumeReads;
        const ivec3 size(volume.width(), volume.height(), volume.depth());
        const vec3 voxel = glm::clamp(place * vec3(size) - Real(0.5), vec3(0), vec3(size - 1));
        const ivec3 low = glm::min(ivec3(glm::floor(voxel)), glm::max(size - 2, 0));
        const ivec3 high = glm::min(low + 1, size - 1);
        const vec3 part = voxel - vec3(low);
        const auto row = [&](int y, int z)
        { return glm::mix(volume.at(low.x, y, z), volume.at(high.x, y, z), part.x); };
        const auto slice = [&](int z) { return glm::mix(row(low.y, z), row(high.y, z), part.y); };
        return vec4(glm::mix(slice(low.z), slice(high.z), part.z), Real(0), Real(0), Real(1));
    }

    // Overloads of GLSL's built-ins for Real; glm's take its vectors.
    static Real abs(Real x) { return std::abs(x); }
    static Real sqrt(Real x) { return std::sqrt(x); }
    static Real floor(Real x) { return std::floor(x); }
    static Real sin(Real x) { return std::sin(x); }
    static Real cos(Real x) { return std::cos(x); }
    static Real tan(Real x) { return std::tan(x); }
    static Real atan(Real x) { return std::atan(x); }
    static Real acos(Real x) { return std::acos(x); }
    static Real exp(Real x) { return std::exp(x); }
    static Real pow(Real x, Real y) { return std::pow(x, y); }
    static Real min(Real a, Real b) { return b < a ? b : a; }
    static Real max(Real a, Real b) { return a < b ? b : a; }
    static int min(int a, int b) { return b < a ? b : a; }
    static int max(int a, int b) { return a < b ? b : a; }
    static Real clamp(Real x, Real a, Real b) { return min(max(x, a), b); }
    static Real mix(Real a, Real b, Real t) { return a + (b - a) * t; }
    static Real dot(const vec3& a, const vec3& b) { return glm::dot(a, b); }
    static vec3 min(const vec3& a, const vec3& b) { return glm::min(a, b); }
    static vec3 max(const vec3& a, const vec3& b) { return glm::max(a, b); }
    static Real dot(const vec4& a, const vec4& b) { return glm::dot(a, b); }
    static Real length(const vec3& a) { return glm::length(a); }
    static vec3 normalize(const vec3& a) { return glm::normalize(a); }

#define GLSL_CONST static constexpr
#define GLSL_ASSERT(condition)                                                                     \
    (!Checked || (condition) ? void() : glslAssertionFailed(#condition, __FILE__, __LINE__))
#include "lib/all.glsl"
#undef GLSL_CONST
#undef GLSL_ASSERT
};

} // namespace osgTerrainLight
