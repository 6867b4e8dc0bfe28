#include "BenchObjectScenes.h"

#include "core/SyntheticTerrain.h"
#include "fields/MeshField.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <utility>

namespace osgTerrainLight::tool::bench
{
namespace
{

constexpr double pi = 3.14159265358979323846;

// Of the terrain: far beyond what objects reach.
constexpr int posts = 65;
constexpr double spacing = 2.0;                           // [m]
constexpr glm::dvec2 middle(0.5 * (posts - 1) * spacing); // [m]
constexpr double town = 8.0;       // objects stand within this of the middle [m], and ...
constexpr double around = 12.0;    // ... ground is looked at within this
constexpr double foundation = 3.0; // below objects, on slopes [m]
constexpr double hair = 1.0e-4;    // of places above their surface [m]

/// mt19937 and the bits, unlike the standard distributions, are the same everywhere.
class Random
{
public:
    explicit Random(std::uint32_t seed) : _bits(seed) {}
    double between(double a, double b)
    {
        return a + (b - a) * (double(_bits() >> 5) / double(1u << 27));
    }
    int upTo(int count) { return int(_bits() % std::uint32_t(count)); }

private:
    std::mt19937 _bits;
};

/// An object about its own origin, on z = 0: a union of parts.
struct Form
{
    TriangleMesh mesh;
    std::vector<std::size_t> partOf; ///< of each triangle
    std::vector<std::function<bool(const glm::dvec3&)>> isInPart;
    bool isBox = false;
    glm::dvec3 low{0.0}, high{0.0}; ///< of a box

    void startPart(std::function<bool(const glm::dvec3&)> isIn)
    {
        isInPart.push_back(std::move(isIn));
    }
    std::uint32_t add(const glm::dvec3& vertex)
    {
        mesh.vertices.emplace_back(vertex);
        return std::uint32_t(mesh.vertices.size() - 1);
    }
    void add(std::uint32_t a, std::uint32_t b, std::uint32_t c)
    {
        mesh.triangles.push_back({a, b, c});
        partOf.push_back(isInPart.size() - 1);
    }
};

void addBox(Form& form, const glm::dvec3& low, const glm::dvec3& high)
{
    form.startPart(
        [low, high](const glm::dvec3& p)
        { return glm::all(glm::greaterThan(p, low)) && glm::all(glm::lessThan(p, high)); });
    std::uint32_t corners[8];
    for (int i = 0; i < 8; ++i)
        corners[i] =
            form.add({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    // Seen from outside, counter-clockwise.
    constexpr int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : faces)
    {
        form.add(corners[face[0]], corners[face[1]], corners[face[2]]);
        form.add(corners[face[0]], corners[face[2]], corners[face[3]]);
    }
}

Form box(const glm::dvec3& half, double depth)
{
    Form form;
    form.isBox = true;
    form.low = {-half.x, -half.y, -depth};
    form.high = {half.x, half.y, 2.0 * half.z};
    addBox(form, form.low, form.high);
    return form;
}

/// A prism along x over the triangle (+-half.y, base), (0, top).
void addGable(Form& form, const glm::dvec2& half, double base, double top)
{
    const double fall = (top - base) / half.y;
    form.startPart(
        [half, base, top, fall](const glm::dvec3& p)
        { return std::abs(p.x) < half.x && p.z > base && p.z < top - fall * std::abs(p.y); });
    std::uint32_t ends[2][3];
    for (int end = 0; end < 2; ++end)
    {
        const double x = end ? half.x : -half.x;
        ends[end][0] = form.add({x, -half.y, base});
        ends[end][1] = form.add({x, half.y, base});
        ends[end][2] = form.add({x, 0.0, top});
    }
    form.add(ends[0][0], ends[0][2], ends[0][1]);
    form.add(ends[1][0], ends[1][1], ends[1][2]);
    constexpr int sides[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    for (const auto& [a, b] : sides)
    {
        form.add(ends[0][a], ends[0][b], ends[1][b]);
        form.add(ends[0][a], ends[1][b], ends[1][a]);
    }
}

/// Walls, a gabled roof with eaves, a chimney through it.
Form house(Random& random, double depth)
{
    const glm::dvec2 half(random.between(3.0, 5.0), random.between(2.2, 3.5));
    const double eaves = random.between(0.4, 1.0), height = random.between(2.5, 4.5);
    const double rise = half.y * random.between(0.6, 1.0);
    Form form;
    addBox(form, {-half.x, -half.y, -depth}, {half.x, half.y, height});
    addGable(form, half + eaves, height - 0.2, height + rise);
    const double chimney = random.between(-0.6, 0.6) * half.x;
    addBox(form, {chimney - 0.4, 0.5, height - 0.5}, {chimney + 0.4, 1.3, height + rise + 0.8});
    return form;
}

/// A closed ring standing on its side or lying, on the ground.
Form torus(Random& random, double depth)
{
    const double major = random.between(1.5, 2.8), minor = random.between(0.45, 0.9);
    const bool stands = random.upTo(2) == 0;
    const double lift = (stands ? major + minor : minor) - 0.25 * depth;
    const auto turned = [stands](const glm::dvec3& p)
    { return stands ? glm::dvec3(p.x, -p.z, p.y) : p; };
    const auto back = [stands](const glm::dvec3& p)
    { return stands ? glm::dvec3(p.x, p.z, -p.y) : p; };
    Form form;
    form.startPart(
        [=](const glm::dvec3& p)
        {
            const glm::dvec3 own = back(p - glm::dvec3(0.0, 0.0, lift));
            return std::hypot(std::hypot(own.x, own.y) - major, own.z) < minor;
        });
    constexpr int turns = 32, across = 16;
    for (int i = 0; i < turns; ++i)
        for (int j = 0; j < across; ++j)
        {
            const double u = 2.0 * pi * i / turns, v = 2.0 * pi * j / across;
            const double r = major + minor * std::cos(v);
            form.add(turned({r * std::cos(u), r * std::sin(u), minor * std::sin(v)}) +
                     glm::dvec3(0.0, 0.0, lift));
        }
    const auto at = [](int i, int j) { return std::uint32_t((i % turns) * across + j % across); };
    for (int i = 0; i < turns; ++i)
        for (int j = 0; j < across; ++j)
        {
            form.add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            form.add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    return form;
}

void addBlob(Form& form, const glm::dvec3& centre, const glm::dvec3& radii)
{
    form.startPart(
        [centre, radii](const glm::dvec3& p)
        {
            const glm::dvec3 own = (p - centre) / radii;
            return glm::dot(own, own) < 1.0;
        });
    constexpr int rows = 10, columns = 16;
    const std::uint32_t first = form.add(centre - glm::dvec3(0.0, 0.0, radii.z));
    for (int row = 1; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
        {
            const double polar = pi * row / rows, turn = 2.0 * pi * column / columns;
            form.add(centre + radii * glm::dvec3(std::sin(polar) * std::cos(turn),
                                                 std::sin(polar) * std::sin(turn),
                                                 -std::cos(polar)));
        }
    const std::uint32_t last = form.add(centre + glm::dvec3(0.0, 0.0, radii.z));
    const auto at = [&](int row, int column)
    { return first + 1 + std::uint32_t((row - 1) * columns + column % columns); };
    for (int column = 0; column < columns; ++column)
    {
        form.add(first, at(1, column + 1), at(1, column));
        form.add(last, at(rows - 1, column), at(rows - 1, column + 1));
        for (int row = 1; row + 1 < rows; ++row)
        {
            form.add(at(row, column), at(row, column + 1), at(row + 1, column + 1));
            form.add(at(row, column), at(row + 1, column + 1), at(row + 1, column));
        }
    }
}

/// A trunk and a crown of blobs that overlap.
Form tree(Random& random, double depth)
{
    Form form;
    const double trunk = random.between(1.5, 2.5), wide = random.between(0.25, 0.4);
    addBox(form, {-wide, -wide, -depth}, {wide, wide, trunk + 1.0});
    const double size = random.between(0.9, 1.4);
    addBlob(form, {0.0, 0.0, trunk + 1.6 * size}, glm::dvec3(1.3, 1.2, 1.4) * size);
    for (int i = 0; i < 4; ++i)
    {
        const double turn = 0.5 * pi * i + random.between(-0.5, 0.5);
        addBlob(
            form,
            {size * std::cos(turn), size * std::sin(turn), trunk + size * random.between(0.7, 2.2)},
            glm::dvec3(random.between(0.6, 1.0), random.between(0.6, 1.0),
                       random.between(0.6, 0.9)) *
                size);
    }
    return form;
}

/// A form where it stands.
struct Standing
{
    Form form;
    glm::dmat4 toScene{1.0};

    glm::dvec3 inScene(const glm::dvec3& own) const { return toScene * glm::dvec4(own, 1.0); }
    /// In another part than `but`.
    bool contains(const glm::dvec3& place, std::size_t but) const
    {
        const glm::dvec3 own = glm::inverse(toScene) * glm::dvec4(place, 1.0);
        for (std::size_t part = 0; part < form.isInPart.size(); ++part)
            if (part != but && form.isInPart[part](own))
                return true;
        return false;
    }
};

Form formOf(int kind, int index, Random& random, double depth)
{
    switch (kind)
    {
    case 0: // a village of boxes
        return box({random.between(1.0, 3.0), random.between(1.0, 3.0), random.between(0.75, 3.0)},
                   depth);
    case 1: // a house among sheds
        return index == 0 ? house(random, depth)
                          : box({random.between(0.5, 1.5), random.between(0.5, 2.0),
                                 random.between(0.5, 1.5)},
                                depth);
    case 2: // trees and a ring
        return index == 0 ? torus(random, depth) : tree(random, depth);
    default: // thin walls; a tree
        return index == 0 ? tree(random, depth)
                          : box({random.between(2.0, 5.0), random.between(0.13, 0.3),
                                 random.between(0.75, 2.0)},
                                depth);
    }
}

const char* nameOf(int kind)
{
    constexpr const char* names[objectSceneKinds] = {"boxes", "gabled house", "torus and trees",
                                                     "thin walls"};
    return names[kind];
}

Result<DemTile> tileOf(Ground ground, std::uint32_t seed, Random& random)
{
    if (ground == Ground::Rough)
        return generateTerrain(TerrainKind::Fractal, posts, posts, spacing, seed);
    DemTile tile(posts, posts, spacing);
    const double rise = random.between(0.4, 0.8);
    const int bottom = posts / 2 + random.upTo(5) - 2;
    for (int row = 0; row < posts; ++row)
        for (int column = 0; column < posts; ++column)
            tile.setHeight(column, row,
                           ground == Ground::Valley
                               ? float(rise * spacing * std::abs(column - bottom))
                               : 0.0f);
    return tile;
}

/// The bilinear surface at a place [m], and its normal.
struct OnGround
{
    double height;
    glm::dvec3 normal;
};
OnGround onGround(const DemTile& tile, const glm::dvec2& place)
{
    const glm::dvec2 at = glm::clamp(place / spacing, glm::dvec2(0.0), glm::dvec2(posts - 1.001));
    const glm::ivec2 low(at);
    const glm::dvec2 part = at - glm::dvec2(low);
    const auto height = [&](int dx, int dy)
    { return double(tile.heightAt(low.x + dx, low.y + dy)); };
    const double south = glm::mix(height(0, 0), height(1, 0), part.x);
    const double north = glm::mix(height(0, 1), height(1, 1), part.x);
    const double east =
        glm::mix(height(1, 0) - height(0, 0), height(1, 1) - height(0, 1), part.y) / spacing;
    return {glm::mix(south, north, part.y),
            glm::normalize(glm::dvec3(-east, -(north - south) / spacing, 1.0))};
}

/// Fields are as large as the library's own.
Result<ObjectShape> shapeOf(const Standing& object)
{
    ObjectShape shape;
    if (object.form.isBox)
    {
        shape.size = 0.5 * (object.form.high - object.form.low);
        shape.toScene = glm::translate(object.toScene, 0.5 * (object.form.high + object.form.low));
        return shape;
    }
    BakeOptions options;
    options.cells = 48;
    Result<BakedField> field = bakeMesh(object.form.mesh, options);
    if (!field)
        return field.error();
    shape.kind = ObjectShape::Kind::Mesh;
    shape.size = glm::dvec3(1.0);
    shape.grid = std::make_shared<DistanceGrid>(std::move(field->grid));
    shape.toScene = object.toScene;
    return shape;
}

bool isOpen(const DemTile& tile, const std::vector<Standing>& objects, const glm::dvec3& place,
            const Standing* own, std::size_t part)
{
    constexpr std::size_t none = ~std::size_t(0);
    return (!own || place.z > onGround(tile, place).height + 0.02) &&
           std::none_of(objects.begin(), objects.end(),
                        [&](const Standing& object)
                        { return object.contains(place, &object == own ? part : none); });
}

/// A random point of an object's triangles, by area.
ObjectPlace placeOn(const Standing& object, Random& random, std::size_t& part)
{
    const TriangleMesh& mesh = object.form.mesh;
    const auto corner = [&](std::size_t triangle, std::size_t i)
    { return object.inScene(glm::dvec3(mesh.vertices[mesh.triangles[triangle][i]])); };
    std::vector<double> areas;
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    {
        sum += glm::length(glm::cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0)));
        areas.push_back(sum);
    }
    const double wanted = random.between(0.0, sum);
    const auto chosen = std::min<std::size_t>(
        std::size_t(std::lower_bound(areas.begin(), areas.end(), wanted) - areas.begin()),
        areas.size() - 1);
    const double s = std::sqrt(random.between(0.0, 1.0)), t = random.between(0.0, 1.0);
    const glm::dvec3 a = corner(chosen, 0), b = corner(chosen, 1), c = corner(chosen, 2);
    ObjectPlace place;
    place.normal = glm::normalize(glm::cross(b - a, c - a));
    place.at = a + s * ((1.0 - t) * (b - a) + t * (c - a)) + hair * place.normal;
    place.surface = std::abs(place.normal.z) <= 0.5 ? Surface::Wall : Surface::Roof;
    double top = 0.0;
    for (const glm::vec3& vertex : mesh.vertices)
        top = std::max(top, double(vertex.z));
    place.probe = object.inScene({0.0, 0.0, 0.5 * top});
    part = object.form.partOf[chosen];
    return place;
}

std::vector<ObjectPlace> findPlaces(const DemTile& tile, const std::vector<Standing>& objects,
                                    Random& random, int count)
{
    std::vector<ObjectPlace> places;
    // Surface by surface, so that each has its share; where an object is all but buried, what it
    // has not goes to the ground.
    const std::map<Surface, int> wanted = {{Surface::Wall, count / 4}, {Surface::Roof, count / 4}};
    for (const auto& [surface, number] : wanted)
    {
        int found = 0;
        for (int attempt = 0; attempt < 1000 * number && found < number; ++attempt)
        {
            const Standing& object = objects[std::size_t(random.upTo(int(objects.size())))];
            std::size_t part = 0;
            const ObjectPlace place = placeOn(object, random, part);
            if (place.surface != surface || place.normal.z < -0.5 ||
                !isOpen(tile, objects, place.at, &object, part))
                continue;
            places.push_back(place);
            ++found;
        }
    }
    while (int(places.size()) < count)
    {
        ObjectPlace place;
        place.at = glm::dvec3(middle, 0.0) + glm::dvec3(random.between(-around, around),
                                                        random.between(-around, around), 0.0);
        const OnGround ground = onGround(tile, place.at);
        place.normal = ground.normal;
        place.at.z = ground.height;
        place.at += hair * place.normal;
        place.probe = place.at;
        if (isOpen(tile, objects, place.at, nullptr, 0))
            places.push_back(place);
    }
    return places;
}

} // namespace

const std::vector<Ground>& allGrounds()
{
    static const std::vector<Ground> all = {Ground::Plain, Ground::Valley, Ground::Rough};
    return all;
}

const char* toString(Ground ground)
{
    return ground == Ground::Plain ? "plain" : ground == Ground::Valley ? "valley" : "rough";
}

const std::vector<Surface>& allSurfaces()
{
    static const std::vector<Surface> all = {Surface::Ground, Surface::Wall, Surface::Roof};
    return all;
}

const char* toString(Surface surface)
{
    return surface == Surface::Ground ? "ground" : surface == Surface::Wall ? "wall" : "roof";
}

Result<ObjectScene> makeObjectScene(int number, std::uint32_t seed, Ground ground, int places)
{
    const std::uint32_t own = 7919u * seed + std::uint32_t(number);
    const int kind = number % objectSceneKinds;
    const double depth = ground == Ground::Plain ? 0.0 : foundation;
    Random ofGround(own + 0x10000u), ofForms(own), ofPlaces(own + 0x20000u);
    ObjectScene scene;
    scene.name = nameOf(kind);
    Result<DemTile> tile = tileOf(ground, own, ofGround);
    if (!tile)
        return tile.error();
    scene.tile = std::move(*tile);
    std::vector<Standing> objects;
    const int count = 3 + ofForms.upTo(4);
    for (int i = 0; i < count; ++i)
    {
        Standing object;
        object.form = formOf(kind, i, ofForms, depth);
        const double reach = i == 0 ? 0.5 * town : town;
        const glm::dvec2 at =
            middle + glm::dvec2(ofForms.between(-reach, reach), ofForms.between(-reach, reach));
        object.toScene =
            glm::rotate(glm::translate(glm::dmat4(1.0), {at, onGround(scene.tile, at).height}),
                        ofForms.between(0.0, pi), {0.0, 0.0, 1.0});
        objects.push_back(std::move(object));
    }
    for (const Standing& object : objects)
    {
        Result<ObjectShape> shape = shapeOf(object);
        if (!shape)
            return shape.error();
        scene.shapes.push_back(std::move(*shape));
        for (const auto& corners : object.form.mesh.triangles)
        {
            reference::Triangle triangle;
            for (std::size_t i = 0; i < 3; ++i)
            {
                const glm::dvec3 corner =
                    object.inScene(glm::dvec3(object.form.mesh.vertices[corners[i]]));
                triangle.corners[i] = {corner.x, corner.y, corner.z};
            }
            scene.triangles.push_back(triangle);
        }
    }
    scene.places = findPlaces(scene.tile, objects, ofPlaces, places);
    return scene;
}

} // namespace osgTerrainLight::tool::bench
