#pragma once

#include "core/Raster.h"
#include "fields/TriangleMesh.h"

#include <glm/glm.hpp>

#include <memory>

namespace osgTerrainLight
{

/// Samples of a form that distances are computed from by lib/sampled_form.glsl: cheap enough to be
/// made anew in every frame, unlike a DistanceGrid.
struct SampledForm
{
    int side = 0; ///< samples along each axis of a map, ≥ 2
    /// Of a star: its radii [m] in an octahedral map, each > 0, side rows. Of heights: those of the
    /// upper surface [m], row 0 south, then those of the lower one; lower above upper where nothing
    /// is solid.
    Raster<float> values;
    glm::dvec3 centre{0.0};  ///< what the samples are about, in the mesh's frame [m]
    glm::dvec2 first{0.0};   ///< of heights: the first post, from the centre [m]
    glm::dvec2 spacing{1.0}; ///< likewise, between posts [m], each > 0
    glm::dvec2 range{0.0};   ///< of heights: lowest and highest; of a star: mean and greatest [m]
    glm::dvec3 low{0.0}, high{0.0}; ///< box of the form, from the centre [m]

    // Radii: 6 degrees apart in the mean. Heights: as many as a DistanceGrid of an object has
    // cells.
    static constexpr int starSide = 32, heightSide = 48;
};

/// The radii of a mesh about a place that sees all of its surface from inside, if there is one: the
/// farthest surface in each direction. Where there is none, the mean of the radii around. Null
/// where nothing is met at all, and for a mesh with a complaint.
std::shared_ptr<const SampledForm> sampleStar(const TriangleMesh& mesh,
                                              int side = SampledForm::starSide);

enum class HeightSurfaces
{
    Upper, ///< solid down to the bottom of the mesh's box
    Both   ///< solid between the highest and the lowest surface above a place
};
/// What is solid between surfaces of a mesh along z, at posts that cover its box. Null where no
/// triangle faces up or down, and for a mesh with a complaint.
std::shared_ptr<const SampledForm> sampleHeights(const TriangleMesh& mesh, HeightSurfaces surfaces,
                                                 int side = SampledForm::heightSide);

} // namespace osgTerrainLight
