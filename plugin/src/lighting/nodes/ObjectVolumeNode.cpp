#include "lighting/nodes/ObjectVolumeNode.h"

#include "fields/DistanceGrid.h"
#include "fields/SampledForm.h"
#include "gpu/GlConstants.h"
#include "gpu/Textures.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace osgTerrainLight
{

namespace
{

constexpr int shapeVectors = 9; ///< vec4 per shape of object_volume.comp

osg::Vec4f vector(const glm::dvec3& xyz, double w)
{
    return {static_cast<float>(xyz.x), static_cast<float>(xyz.y), static_cast<float>(xyz.z),
            static_cast<float>(w)};
}

/// The bits of an integer where the shader reads one.
float asFloat(int value)
{
    float bits;
    static_assert(sizeof(bits) == sizeof(value));
    std::memcpy(&bits, &value, sizeof(bits));
    return bits;
}

} // namespace

ObjectVolumeNode::ObjectVolumeNode(const ObjectCluster& cluster)
    : Node("objects"), _cluster(cluster), _shapesValue(own(new Resource("shapes of objects"))),
      _volume(own(new Resource("distances to objects", {cluster.voxels.x, cluster.voxels.y, 0,
                                                        GL_R8_SNORM, cluster.voxels.z}))),
      _albedo(own(new Resource("albedo of objects",
                               {cluster.voxels.x / ObjectCluster::cell,
                                cluster.voxels.y / ObjectCluster::cell, 0, GL_RGBA16F_ARB,
                                cluster.voxels.z / ObjectCluster::cell}))),
      _formsTexture(own(new Resource("samples of forms"))), _pass(own(new GpuPass("object_volume")))
{
    // It is drawn with, and what has moved is seen in it as a whole.
    _volume->keepWhole();
    _albedo->keepWhole();
    reads(_shapesValue);
    writes(_volume);
    writes(_albedo);
    _pass->reads("forms", _formsTexture);
    _pass->writes(0, _volume);
    _pass->writes(1, _albedo);
    _pass->set("voxel", static_cast<float>(cluster.voxel));
    _pass->set("reach", static_cast<float>(cluster.voxel * ObjectCluster::reach));
}

void ObjectVolumeNode::set(const ObjectCluster& cluster)
{
    assert(_cluster.sameVolume(cluster));
    if (_cluster.shapes != cluster.shapes)
        _shapesValue->touch();
    _cluster = cluster;
}

void ObjectVolumeNode::mark(Bricks& bricks, const ObjectShape& shape) const
{
    const ObjectBounds bounds = boundsOf(shape);
    const double size = _cluster.voxel * ObjectCluster::brick;
    const double reach = _cluster.voxel * ObjectCluster::reach;
    const glm::ivec3 count = _cluster.voxels / ObjectCluster::brick;
    glm::ivec3 first, last;
    for (int axis = 0; axis < 3; ++axis)
    {
        const auto place = [&](double at)
        {
            return static_cast<int>(std::clamp(std::floor((at - _cluster.origin[axis]) / size),
                                               -1.0, double(count[axis])));
        };
        first[axis] = std::max(place(bounds.low[axis] - reach), 0);
        last[axis] = std::min(place(bounds.high[axis] + reach), count[axis] - 1);
    }
    for (int z = first.z; z <= last.z; ++z)
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x)
                bricks[static_cast<std::size_t>(x + count.x * (y + count.y * z))] = true;
}

/// Puts the samples of all forms into the texture that the shader reads. A form that deforms has
/// others in every frame; the texture stays while their number does.
void ObjectVolumeNode::setForms()
{
    _formRows.clear();
    int rows = 0, width = 1;
    for (const ObjectShape& shape : _cluster.shapes)
        if (shape.form && _formRows.insert({shape.form.get(), rows}).second)
        {
            rows += shape.form->values.height();
            width = std::max(width, shape.form->values.width());
        }
    rows = std::max(rows, 1);
    if (!_forms || _forms->s() != width || _forms->t() != rows)
    {
        const osg::ref_ptr<osg::Texture2D> texture =
            createFloatTexture(Raster<float>(width, rows, 0.0f));
        _forms = texture->getImage();
        _formsTexture->set(texture);
    }
    if (_formRows.empty())
        return;
    for (const auto& [form, row] : _formRows)
        for (int y = 0; y < form->values.height(); ++y)
            std::copy_n(&form->values.at(0, y), form->values.width(),
                        reinterpret_cast<float*>(_forms->data(0u, static_cast<unsigned>(row + y))));
    _forms->dirty();
}

/// Gives the pass what the shader reads of the shapes.
void ObjectVolumeNode::setShapes()
{
    if (_isSet && _shapesSet == _cluster.shapes)
        return;
    osg::ref_ptr<osg::Vec4Array> values = new osg::Vec4Array;
    osg::ref_ptr<osg::FloatArray> distances = new osg::FloatArray;
    std::map<const DistanceGrid*, int> places;
    setForms();
    for (const ObjectShape& shape : _cluster.shapes)
    {
        const RigidShape own = rigid(shape);
        const glm::dmat4 toOwn = own.fromScene * glm::translate(glm::dmat4(1.0), _cluster.origin);
        for (int row = 0; row < 3; ++row)
            values->push_back(vector({toOwn[0][row], toOwn[1][row], toOwn[2][row]}, toOwn[3][row]));
        const glm::dvec3 size = shape.form ? glm::dvec3(shape.form->range, 0.0) : own.size;
        values->push_back(vector(size, static_cast<double>(shape.kind)));
        const ObjectBounds bounds = boundsOf(shape);
        values->push_back(vector(bounds.low - _cluster.origin, own.scale));
        values->push_back(vector(bounds.high - _cluster.origin, 0.0));
        values->push_back(vector(shape.albedo, 1.0));
        if (shape.form)
        {
            const SampledForm& form = *shape.form;
            values->push_back(vector({form.first, form.spacing.x}, form.spacing.y));
            values->push_back(
                osg::Vec4f(asFloat(form.side), asFloat(_formRows.at(&form)), 0.0f, 0.0f));
            continue;
        }
        if (!shape.grid)
        {
            values->push_back(osg::Vec4f());
            values->push_back(osg::Vec4f());
            continue;
        }
        const DistanceGrid& grid = *shape.grid;
        const auto [place, isNew] = places.insert({&grid, static_cast<int>(distances->size())});
        if (isNew)
            distances->insert(distances->end(), grid.distances.begin(), grid.distances.end());
        values->push_back(vector(glm::dvec3(grid.first), double(grid.spacing)));
        values->push_back(osg::Vec4f(asFloat(grid.size.x), asFloat(grid.size.y),
                                     asFloat(grid.size.z), asFloat(place->second)));
    }
    assert(values->size() == shapeVectors * _cluster.shapes.size());
    if (values->empty())
        values->resize(shapeVectors);
    if (distances->empty())
        distances->push_back(0.0f);
    _pass->set("shapeCount", static_cast<int>(_cluster.shapes.size()));
    _pass->setStorage(0, values);
    if (_grids != places || !_isSet)
        _pass->setStorage(2, distances);
    _grids = std::move(places);
    _shapesSet = _cluster.shapes;
    _isSet = true;
}

void ObjectVolumeNode::forget(unsigned context)
{
    _complete.remove(context);
}

Status ObjectVolumeNode::run(osg::State& state)
{
    const glm::ivec3 count = _cluster.voxels / ObjectCluster::brick;
    const auto all = static_cast<std::size_t>(count.x * count.y * count.z);
    Written& written = _written[state.getContextID()];
    // Nothing is in a texture that has been released, or made anew.
    if (!_volume->texture()->getTextureObject(state.getContextID()))
        written = {};
    Bricks bricks = written.unfinished;
    bricks.resize(all, !written.any);
    const auto differs = [](const ObjectShape& shape, const std::vector<ObjectShape>& others)
    { return std::find(others.begin(), others.end(), shape) == others.end(); };
    if (written.any)
    {
        for (const ObjectShape& shape : written.shapes)
            if (differs(shape, _cluster.shapes))
                mark(bricks, shape);
        for (const ObjectShape& shape : _cluster.shapes)
            if (differs(shape, written.shapes))
                mark(bricks, shape);
    }
    written = {_cluster.shapes, bricks, true};

    osg::ref_ptr<osg::Vec4iArray> list = new osg::Vec4iArray;
    for (int z = 0; z < count.z; ++z)
        for (int y = 0; y < count.y; ++y)
            for (int x = 0; x < count.x; ++x)
                if (bricks[static_cast<std::size_t>(x + count.x * (y + count.y * z))])
                    list->push_back(osg::Vec4i(x, y, z, 0));
    _lastBricks = list->size();
    if (!list->empty())
    {
        setShapes();
        _pass->setStorage(1, list);
        if (Status done = _pass->dispatch(state, {static_cast<unsigned>(list->size()), 1, 1});
            !done)
            return done;
    }
    written.unfinished.clear();
    _complete.add(state.getContextID());
    return Nothing{};
}

} // namespace osgTerrainLight
