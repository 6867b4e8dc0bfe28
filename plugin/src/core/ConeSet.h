#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

/// Cones about a normal, of equal cosine measure together the hemisphere: what sky light among
/// objects is gathered by (shaders/lib/object_light.glsl).
struct ConeSet
{
    struct Cone
    {
        std::array<float, 3> axis; ///< unit; about +z
        float sine;                ///< of the half-angle: that of its cell's, times 0.8
        std::uint32_t around;      ///< bit per cone: itself, and those whose axes are near
    };
    std::vector<Cone> cones;  ///< at most 32
    float stride;             ///< least step over the cone's radius
    std::array<float, 4> fit; ///< A, P, Q, g of coneLight()

    /// 4, 6, 9, 12, 16 or 32 cones; another count is the next one above, 32 at most. More cones err
    /// less (docs/methods/objects.md).
    static ConeSet of(int cones);

    static constexpr std::size_t most = 32;
    /// As shaders have them: vec4 by cone, its axis and sine, `most` of them; then the fit; then
    /// (count, stride, 0, 0).
    std::vector<std::array<float, 4>> packed() const;
};

} // namespace osgTerrainLight
