#include "fields/ObjectShape.h"

#include "fields/DistanceGrid.h"
#include "fields/SampledForm.h"

#include <algorithm>

namespace osgTerrainLight
{

namespace
{

/// Half sides of the box about the shape in own units, and its middle.
struct OwnBox
{
    glm::dvec3 middle{0.0}, half;
};

OwnBox ownBox(const ObjectShape& shape)
{
    switch (shape.kind)
    {
    case ObjectShape::Kind::Cylinder:
        return {glm::dvec3(0.0), {shape.size.x, shape.size.x, shape.size.z}};
    case ObjectShape::Kind::Capsule:
        return {glm::dvec3(0.0), {shape.size.x, shape.size.x, shape.size.z + shape.size.x}};
    case ObjectShape::Kind::Mesh:
    {
        // The grid reaches beyond the surface.
        const DistanceGrid& grid = *shape.grid;
        const glm::dvec3 half = 0.5 * double(grid.spacing) * glm::dvec3(grid.size - 1);
        return {glm::dvec3(grid.first) + half, half};
    }
    case ObjectShape::Kind::Star:
    case ObjectShape::Kind::Heights:
        return {0.5 * (shape.form->low + shape.form->high),
                0.5 * (shape.form->high - shape.form->low)};
    default:
        return {glm::dvec3(0.0), shape.size};
    }
}

} // namespace

ObjectBounds boundsOf(const ObjectShape& shape)
{
    const OwnBox box = ownBox(shape);
    ObjectBounds bounds;
    for (int corner = 0; corner < 8; ++corner)
    {
        const glm::dvec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const glm::dvec3 place(shape.toScene * glm::dvec4(box.middle + box.half * side, 1.0));
        bounds.include({place, place});
    }
    return bounds;
}

RigidShape rigid(const ObjectShape& shape)
{
    glm::dvec3 scales;
    glm::dmat4 toScene = shape.toScene;
    for (int axis = 0; axis < 3; ++axis)
        scales[axis] = std::max(glm::length(glm::dvec3(toScene[axis])), 1.0e-12);
    if (shape.grid || shape.form)
        return {shape.size, glm::inverse(toScene), std::min({scales.x, scales.y, scales.z})};
    RigidShape result{shape.size * scales, {}, 1.0};
    if (shape.kind == ObjectShape::Kind::Cylinder || shape.kind == ObjectShape::Kind::Capsule)
        result.size.x = shape.size.x * 0.5 * (scales.x + scales.y);
    for (int axis = 0; axis < 3; ++axis)
        toScene[axis] /= scales[axis];
    result.fromScene = glm::inverse(toScene);
    return result;
}

} // namespace osgTerrainLight
