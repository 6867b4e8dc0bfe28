#pragma once

#include "fields/ObjectShape.h"
#include "reference/RayScene.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// `terrainlight bench --objects`: scenes of placed objects, and where light is compared in them.
namespace osgTerrainLight::tool::bench
{

enum class Ground
{
    Plain,
    Valley, ///< two sides that rise by 0.4 to 0.8 from a straight bottom
    Rough   ///< mountains of generateTerrain(), with posts in 2 m
};
const std::vector<Ground>& allGrounds();
const char* toString(Ground ground);

enum class Surface
{
    Ground,
    Wall, ///< of an object, within 30 degrees of the vertical
    Roof  ///< all else of it, but for what faces down
};
const std::vector<Surface>& allSurfaces();
const char* toString(Surface surface);

struct ObjectPlace
{
    Surface surface = Surface::Ground;
    glm::dvec3 at{0.0};     ///< [m] from post (0, 0) of the terrain, a hair above the surface
    glm::dvec3 normal{0.0}; ///< unit
    /// Where the library has the light probe for it: in the middle of the object, above its
    /// foundation. On the ground the place itself.
    glm::dvec3 probe{0.0};
};

/// Objects on a ground. Each is there twice: as triangles, which rays meet, and as the shape that
/// the library would make a field of.
struct ObjectScene
{
    std::string name; ///< what kind of objects it has
    DemTile tile;
    std::vector<reference::Triangle> triangles;
    std::vector<ObjectShape> shapes;
    std::vector<ObjectPlace> places;
};

/// The number of kinds of scenes: those with numbers 0 ... kinds - 1 are of different kinds.
constexpr int objectSceneKinds = 4;

/// The same arguments give the same scene. number, seed: which. places: how many, half of them on
/// the ground. Objects have the same forms on every ground, but for foundations on slopes.
Result<ObjectScene> makeObjectScene(int number, std::uint32_t seed, Ground ground, int places);

} // namespace osgTerrainLight::tool::bench
