#pragma once

#include "fields/DistanceGrid.h"
#include "fields/TriangleMesh.h"

#include <functional>
#include <vector>

namespace osgTerrainLight
{

/// A mesh, and what is inside of it by an independent rule: a union of convex parts, each the
/// points that are behind all of its planes.
struct TestMesh
{
    struct Plane
    {
        glm::dvec3 normal; ///< unit, outwards
        double offset;     ///< of the plane along the normal [m]
    };

    TriangleMesh mesh;
    std::vector<std::vector<Plane>> parts;

    bool isInside(const glm::dvec3& point) const;

    /// Adds a closed convex part: faces are planar polygons over corners, in either direction.
    void addConvex(const std::vector<glm::dvec3>& corners,
                   const std::vector<std::vector<int>>& faces);
    void addBox(const glm::dvec3& low, const glm::dvec3& high);
    /// A prism or, with topRadius 0, a cone about a vertical axis.
    void addFrustum(const glm::dvec3& base, double height, double radius, double topRadius,
                    int sides);
};

/// Overlapping boxes (house, annexe, chimney) under a gabled roof with eaves: 12 m long.
TestMesh makeHouse();
/// A trunk and three cones that overlap: 8 m high. About 8 · sides triangles.
TestMesh makeTree(int sides);
/// The mesh without the triangles that lie at z = 0.
TriangleMesh withoutBottom(const TriangleMesh& mesh);

/// A sphere of icosahedron faces, each cut into 4^subdivisions: 20 · 4^subdivisions triangles with
/// their corners on the sphere.
TriangleMesh makeSphere(double radius, int subdivisions);
/// The least distance of a triangle's plane from the origin: between that and the radius lie all
/// points of a sphere's mesh.
double leastPlaneDistance(const TriangleMesh& mesh);
/// A torus about z, of around × across · 2 triangles.
TriangleMesh makeTorus(double majorRadius, double minorRadius, int around, int across);

/// Distance to the nearest triangle, over all of them [m], >= 0. It shares no formula with the
/// library: a foot within the triangle by its edges' planes, else the nearest of three edges.
double bruteDistance(const TriangleMesh& mesh, const glm::dvec3& point);

/// How a grid compares with a true signed distance.
struct FieldErrors
{
    double voxels = 0.0;       ///< RMS over centres [voxels]
    double greatest = 0.0;     ///< over centres [voxels]
    double interpolated = 0.0; ///< RMS over random points between centres [voxels]
    double wrongSigns = 0.0;   ///< share of centres
};

/// truth: signed distance at a point [m]. Of centres every stride-th is looked at; as many random
/// points.
FieldErrors compareField(const DistanceGrid& grid,
                         const std::function<double(const glm::dvec3&)>& truth, int stride = 1);

} // namespace osgTerrainLight
