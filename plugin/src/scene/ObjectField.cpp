#include "scene/ObjectField.h"

#include "fields/SampledForm.h"

#include <osg/ComputeBoundsVisitor>
#include <osg/Notify>
#include <osg/ShapeDrawable>
#include <osg/Texture>
#include <osg/TriangleFunctor>
#include <osg/TriangleIndexFunctor>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <utility>

namespace osgTerrainLight
{

namespace
{

glm::dvec3 vector(const osg::Vec3d& v)
{
    return {v.x(), v.y(), v.z()};
}

struct AddTriangle
{
    TriangleMesh* mesh = nullptr;
    osg::Matrixd toObject;

    void operator()(const osg::Vec3& a, const osg::Vec3& b, const osg::Vec3& c, bool = false)
    {
        const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
        for (const osg::Vec3& corner : {a, b, c})
        {
            const osg::Vec3d place = osg::Vec3d(corner) * toObject;
            mesh->vertices.emplace_back(place.x(), place.y(), place.z());
        }
        mesh->triangles.push_back({first, first + 1, first + 2});
    }
};

double linearOfSrgb(double code)
{
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

glm::dvec3 linear(const osg::Vec4& colour)
{
    return {linearOfSrgb(double(colour.r())), linearOfSrgb(double(colour.g())),
            linearOfSrgb(double(colour.b()))};
}

/// Mean of a picture at 16 x 16 of its places, weighed by alpha.
glm::dvec3 meanOf(const osg::Image& image)
{
    constexpr int count = 16;
    if (!image.data())
        return glm::dvec3(1.0);
    glm::dvec3 sum(0.0);
    double weight = 0.0;
    for (int y = 0; y < count; ++y)
        for (int x = 0; x < count; ++x)
        {
            const osg::Vec4 colour = image.getColor(
                osg::Vec2((float(x) + 0.5f) / float(count), (float(y) + 0.5f) / float(count)));
            sum += double(colour.a()) * linear(colour);
            weight += double(colour.a());
        }
    return weight > 0.0 ? sum / weight : glm::dvec3(1.0);
}

/// Colours of triangles, weighed by their areas.
struct AddColour
{
    const osg::Vec3Array* places = nullptr;
    const osg::Vec4Array* colours = nullptr; ///< one per vertex; null: `one` is all of them
    glm::dvec3 one{1.0};                     ///< linear
    osg::Matrixd toObject;
    glm::dvec3 sum{0.0};
    double area = 0.0;

    void operator()(unsigned a, unsigned b, unsigned c)
    {
        const osg::Vec3d first = osg::Vec3d((*places)[a]) * toObject;
        const double size = ((osg::Vec3d((*places)[b]) * toObject - first) ^
                             (osg::Vec3d((*places)[c]) * toObject - first))
                                .length();
        glm::dvec3 colour(0.0);
        for (const unsigned corner : {a, b, c})
            colour += (colours ? linear((*colours)[corner]) : one) / 3.0;
        sum += size * colour;
        area += size;
    }
};

/// Triangles of what is drawn below, in its frame, its drawables, and their mean colour.
class PartCollector : public osg::NodeVisitor
{
public:
    PartCollector(bool triangles, bool colours)
        : osg::NodeVisitor(TRAVERSE_ACTIVE_CHILDREN), _triangles(triangles), _wantsColours(colours)
    {
    }
    void apply(osg::Node& node) override
    {
        const Surface above = noteSurface(node);
        traverse(node);
        _surface = above;
    }
    void apply(osg::Drawable& drawable) override
    {
        const Surface above = noteSurface(drawable);
        // The object itself is first in the path.
        const osg::NodePath below(getNodePath().begin() + 1, getNodePath().end());
        toObject = osg::computeLocalToWorld(below);
        last = &drawable;
        ++count;
        if (const osg::Geometry* geometry = drawable.asGeometry(); geometry && _wantsColours)
            addColour(*geometry);
        _surface = above;
        if (!_triangles)
            return;
        osg::TriangleFunctor<AddTriangle> add;
        add.mesh = &mesh;
        add.toObject = toObject * osg::Matrixd::translate(-middle);
        drawable.accept(add);
    }
    TriangleMesh mesh;
    osg::Vec3d middle; ///< that the mesh is about
    const osg::Drawable* last = nullptr;
    osg::Matrixd toObject; ///< of the last
    int count = 0;
    bool hasMaterials = false, ownMaterials = false;

    /// Linear, by area; white where nothing has a colour.
    glm::dvec3 albedo() const
    {
        return _area > 0.0 ? glm::clamp(_colours / _area, 0.0, 1.0) : glm::dvec3(1.0);
    }

private:
    /// Of the nodes above a drawable.
    struct Surface
    {
        const osg::Material* material = nullptr;
        const osg::Image* picture = nullptr;
    };

    /// Gives what counted above the node.
    Surface noteSurface(const osg::Node& node)
    {
        const Surface above = _surface;
        const osg::StateSet* stateSet = node.getStateSet();
        if (!stateSet)
            return above;
        if (const auto* material = dynamic_cast<const osg::Material*>(
                stateSet->getAttribute(osg::StateAttribute::MATERIAL)))
        {
            _surface.material = material;
            hasMaterials = true;
            ownMaterials = ownMaterials || isOwnColour(*material);
        }
        if (const auto* texture = dynamic_cast<const osg::Texture*>(
                stateSet->getTextureAttribute(0, osg::StateAttribute::TEXTURE)))
            _surface.picture = texture->getImage(0);
        return above;
    }

    void addColour(const osg::Geometry& geometry)
    {
        osg::TriangleIndexFunctor<AddColour> add;
        add.places = dynamic_cast<const osg::Vec3Array*>(geometry.getVertexArray());
        if (!add.places)
            return;
        add.toObject = toObject;
        const auto* colours = dynamic_cast<const osg::Vec4Array*>(geometry.getColorArray());
        if (_surface.material && isOwnColour(*_surface.material))
            add.one = linear(_surface.material->getDiffuse(osg::Material::FRONT));
        else if (colours && !colours->empty())
        {
            add.one = linear(colours->front());
            if (geometry.getColorBinding() == osg::Geometry::BIND_PER_VERTEX &&
                colours->size() >= add.places->size())
                add.colours = colours;
        }
        geometry.accept(add);
        _colours += add.sum * (_surface.picture ? meanOf(*_surface.picture) : glm::dvec3(1.0));
        _area += add.area;
    }

    bool _triangles, _wantsColours;
    Surface _surface;
    glm::dvec3 _colours{0.0}; ///< times area
    double _area = 0.0;
};

ObjectShape about(ObjectShape::Kind kind, const osg::Vec3d& centre, const glm::dvec3& size,
                  const osg::Matrixd& toObject = {})
{
    ObjectShape shape;
    shape.kind = kind;
    shape.size = glm::max(size, glm::dvec3(1.0e-6));
    shape.toScene = glm::translate(toGlm(toObject), vector(centre));
    return shape;
}

/// Of a single drawable that is a solid of OSG whose own rotation is none.
std::optional<ObjectShape> simpleShape(const PartCollector& parts)
{
    const auto* drawn = dynamic_cast<const osg::ShapeDrawable*>(parts.last);
    if (parts.count != 1 || !drawn || !drawn->getShape())
        return std::nullopt;
    using Kind = ObjectShape::Kind;
    if (const auto* box = dynamic_cast<const osg::Box*>(drawn->getShape());
        box && box->zeroRotation())
        return about(Kind::Box, box->getCenter(), vector(box->getHalfLengths()), parts.toObject);
    if (const auto* sphere = dynamic_cast<const osg::Sphere*>(drawn->getShape()))
        return about(Kind::Ellipsoid, sphere->getCenter(), glm::dvec3(double(sphere->getRadius())),
                     parts.toObject);
    if (const auto* cylinder = dynamic_cast<const osg::Cylinder*>(drawn->getShape());
        cylinder && cylinder->zeroRotation())
    {
        const double radius = double(cylinder->getRadius());
        return about(Kind::Cylinder, cylinder->getCenter(),
                     {radius, radius, 0.5 * double(cylinder->getHeight())}, parts.toObject);
    }
    return std::nullopt;
}

/// A single drawable that is one of OSG's.
bool isHeightField(const PartCollector& parts)
{
    const auto* drawn = dynamic_cast<const osg::ShapeDrawable*>(parts.last);
    return parts.count == 1 && drawn &&
           dynamic_cast<const osg::HeightField*>(drawn->getShape()) != nullptr;
}

} // namespace

glm::dmat4 toGlm(const osg::Matrixd& matrix)
{
    glm::dmat4 result;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            result[row][column] = matrix(row, column); // OSG's rows are columns of GLM
    return result;
}

bool isOwnColour(const osg::Material& material)
{
    return material.getColorMode() != osg::Material::DIFFUSE &&
           material.getColorMode() != osg::Material::AMBIENT_AND_DIFFUSE;
}

std::optional<ObjectShape> ObjectField::shape(osg::Group& object)
{
    using Field = PlacedObject::Field;
    if (field == Field::Star || field == Field::HeightField || field == Field::TwoHeightFields)
        followForm(object);
    else
        followSolid(object);
    if (_shape)
    {
        _shape->albedo = albedo ? vector(osg::Vec3d(*albedo)) : _drawnAlbedo;
        _shape->emission = vector(osg::Vec3d(emission));
    }
    return _shape;
}

/// Of a solid, or of a mesh that stays as it is but for moving.
void ObjectField::followSolid(osg::Group& object)
{
    const osg::BoundingSphere& bound = object.getBound();
    if (_isDirty || bound.center() != _bound.center() || bound.radius() != _bound.radius())
    {
        _bound = bound;
        make(object);
        _still = 0;
    }
    else if (_isMesh && ++_still >= updatesToSample)
    {
        _isMesh = false;
        startSampling(object);
    }
    takeSampled();
}

void ObjectField::make(osg::Group& object)
{
    _isDirty = false;
    _shape.reset();
    _sampling = nullptr; // of a form that is gone
    _isMesh = false;
    using Field = PlacedObject::Field;
    PartCollector parts(false, true);
    object.accept(parts);
    _hasMaterials = parts.hasMaterials;
    _ownMaterials = parts.ownMaterials;
    _drawnAlbedo = parts.albedo();
    if (field == Field::None)
        return;
    if (parts.count == 0)
        return;
    if (field == Field::Automatic)
    {
        if ((_shape = simpleShape(parts)))
            return;
        if (isHeightField(parts))
        {
            _sampled.clear();
            sampleForm(object, Field::HeightField);
            _sampled = {}; // it is not followed
            return;
        }
    }

    osg::ComputeBoundsVisitor bounds;
    for (unsigned i = 0; i < object.getNumChildren(); ++i)
        object.getChild(i)->accept(bounds);
    const osg::BoundingBox& box = bounds.getBoundingBox();
    if (!box.valid())
        return;
    const glm::dvec3 half = 0.5 * (vector(osg::Vec3d(box._max)) - vector(osg::Vec3d(box._min)));
    const auto kind = field == Field::Ellipsoid  ? ObjectShape::Kind::Ellipsoid
                      : field == Field::Cylinder ? ObjectShape::Kind::Cylinder
                                                 : ObjectShape::Kind::Box;
    _shape = about(kind, box.center(),
                   kind == ObjectShape::Kind::Cylinder
                       ? glm::dvec3(0.5 * (half.x + half.y), 0.5 * (half.x + half.y), half.z)
                       : half);
    _isMesh = field == Field::Mesh || field == Field::Automatic;
}

/// Of a form that may change in every frame.
void ObjectField::followForm(osg::Group& object)
{
    if (_isDirty)
        _sampled.clear();
    _isDirty = _isMesh = false;
    _sampling = nullptr;
    sampleForm(object, field);
}

void ObjectField::sampleForm(osg::Group& object, PlacedObject::Field as)
{
    const bool isNew = _sampled.empty();
    PartCollector parts(true, isNew);
    // About the same place as long as it is within the object, so that triangles compare.
    const osg::BoundingSphere& bound = object.getBound();
    if (isNew || (osg::Vec3d(bound.center()) - _middle).length() > double(bound.radius()))
        _middle = bound.center();
    parts.middle = _middle;
    object.accept(parts);
    _hasMaterials = parts.hasMaterials;
    _ownMaterials = parts.ownMaterials;
    if (isNew)
        _drawnAlbedo = parts.albedo();
    else if (parts.mesh.vertices == _sampled)
        return;
    using Field = PlacedObject::Field;
    const std::shared_ptr<const SampledForm> form =
        as == Field::Star
            ? sampleStar(parts.mesh)
            : sampleHeights(parts.mesh, as == Field::HeightField ? HeightSurfaces::Upper
                                                                 : HeightSurfaces::Both);
    _sampled = std::move(parts.mesh.vertices);
    _shape.reset();
    if (!form)
        return;
    ObjectShape shape;
    shape.kind = as == Field::Star ? ObjectShape::Kind::Star : ObjectShape::Kind::Heights;
    shape.form = form;
    shape.toScene = glm::translate(glm::dmat4(1.0), vector(_middle) + form->centre);
    _shape = shape;
}

void ObjectField::startSampling(osg::Group& object)
{
    PartCollector parts(true, false);
    _middle = object.getBound().center();
    parts.middle = _middle;
    object.accept(parts);
    if (!parts.mesh.triangles.empty())
        _sampling = sampleMesh(std::move(parts.mesh), object.getName());
}

void ObjectField::takeSampled()
{
    if (!_sampling || !_sampling->isDone())
        return;
    const std::shared_ptr<const DistanceGrid> grid = _sampling->grid();
    _sampling = nullptr;
    if (!grid || !_shape)
        return;
    ObjectShape mesh;
    mesh.kind = ObjectShape::Kind::Mesh;
    mesh.grid = grid;
    mesh.toScene = glm::translate(glm::dmat4(1.0), vector(_middle));
    _shape = mesh;
}

} // namespace osgTerrainLight
