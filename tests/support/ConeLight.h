#pragma once

#include "core/ConeSet.h"
#include "support/Precisions.h"

namespace osgTerrainLight
{

/// A place on level ground or on what stands there, and the way it faces.
struct Receiver
{
    glm::dvec3 place, normal;
};

/// Irradiance / pi by a sky of 1 above the horizontal, by the library's cones. The ground is level,
/// so the part of a tilted face's light that the horizontal leaves is known: (1 + cos) / 2.
template <class Real>
double skyByCones(const Volume<Real>& volume, const typename Glsl<Real>::DistanceField& field,
                  const Receiver& receiver, const ConeSet& set)
{
    CheckedGlsl<Real> glsl;
    using G = CheckedGlsl<Real>;
    typename CheckedGlsl<Real>::DistanceField own;
    own.size = field.size;
    own.voxel = field.voxel;
    own.reach = field.reach;
    own.low = field.low;
    own.high = field.high;
    const typename G::vec3 place(receiver.place), normal(receiver.normal);
    typename G::vec4 axes[32] = {};
    unsigned around[32] = {};
    Real weights[32] = {};
    const int count = int(set.cones.size());
    for (int i = 0; i < count; ++i)
    {
        const ConeSet::Cone& cone = set.cones[std::size_t(i)];
        const auto axis =
            glsl.aboutNormal(typename G::vec3(cone.axis[0], cone.axis[1], cone.axis[2]), normal);
        axes[i] = typename G::vec4(axis, Real(cone.sine));
        around[i] = cone.around;
        weights[i] = glsl.coneAboveHorizon(axis, Real(cone.sine), Real(0));
    }
    const typename G::vec4 fit(set.fit[0], set.fit[1], set.fit[2], set.fit[3]);
    const auto cones = glsl.conesAmongObjects(volume, own, place, normal, axes, around, weights,
                                              count, Real(set.stride), fit);
    double light = 0.0, all = 0.0;
    for (int i = 0; i < count; ++i)
    {
        light += double(weights[i]) * double(cones.light[i]);
        all += double(weights[i]);
    }
    return light / all * 0.5 * (1.0 + receiver.normal.z);
}

} // namespace osgTerrainLight
