#include <osgTerrainLight/DynamicTerrain.h>

#include <osgTerrainLight/ShadingTexture.h>

#include "gpu/GlConstants.h"
#include "gpu/HeightTexture.h"
#include "scene/DisplacedProgram.h"

#include <osg/FrameStamp>
#include <osg/Geometry>
#include <osg/Image>
#include <osg/NodeVisitor>
#include <osg/Notify>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace osgTerrainLight
{

namespace
{
void warn(const std::string& sentence)
{
    OSG_WARN << "osgTerrainLight: " << sentence << std::endl;
}

/// The grid, as large as its terrain says that it is: its vertices move on the GPU.
class Grid : public osg::Geometry
{
public:
    explicit Grid(const DynamicTerrain& terrain) : _terrain(terrain) {}
    osg::BoundingBox computeBoundingBox() const override { return _terrain.getBoundingBox(); }

private:
    ~Grid() override = default;
    const DynamicTerrain& _terrain; ///< owns this
};

osg::ref_ptr<osg::Geometry> createGrid(const DynamicTerrain& terrain)
{
    const DemTile& tile = terrain.getTile();
    const int width = tile.width();
    const int height = tile.height();
    osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array;
    osg::ref_ptr<osg::Vec2Array> coordinates = new osg::Vec2Array;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
        {
            const double east = (column - 0.5 * (width - 1)) * tile.nominalEastSpacing();
            const double north = (row - 0.5 * (height - 1)) * tile.northSpacing;
            vertices->push_back(osg::Vec3d(east, north, 0.0));
            vertices->back().z() = tile.heightAt(column, row);
            coordinates->push_back(osg::Vec2(static_cast<float>(column) / float(width - 1),
                                             static_cast<float>(row) / float(height - 1)));
        }
    osg::ref_ptr<osg::DrawElementsUInt> triangles = new osg::DrawElementsUInt(GL_TRIANGLES);
    triangles->reserve(6 * static_cast<std::size_t>(width - 1) *
                       static_cast<std::size_t>(height - 1));
    for (int row = 0; row + 1 < height; ++row)
        for (int column = 0; column + 1 < width; ++column)
        {
            const unsigned southWest = static_cast<unsigned>(row * width + column);
            const unsigned northWest = southWest + static_cast<unsigned>(width);
            for (unsigned corner :
                 {southWest, southWest + 1, northWest + 1, southWest, northWest + 1, northWest})
                triangles->push_back(corner);
        }
    osg::ref_ptr<osg::Geometry> grid = new Grid(terrain);
    grid->setVertexArray(vertices);
    grid->setTexCoordArray(ShadingTexture::coordinateSet, coordinates);
    grid->addPrimitiveSet(triangles);
    grid->setUseDisplayList(false);
    grid->setUseVertexBufferObjects(true);
    return grid;
}
} // namespace

struct DynamicTerrain::Implementation
{
    DemTile tile;
    HeightCallback callback;
    std::vector<float> heights;
    osg::ref_ptr<osg::Texture2D> own, theirs;
    unsigned unit = heightUnit;
    osg::ref_ptr<osg::Uniform> hasColour, sampler;
    osg::BoundingBox box;
    bool rangeGiven = false;
    unsigned revision = 0;
    std::pair<unsigned, double> lastFrame{~0u, 0.0}; ///< number and reference time
};

DynamicTerrain::DynamicTerrain() : _implementation(new Implementation)
{
    create();
}

DynamicTerrain::DynamicTerrain(const DemTile& tile) : _implementation(new Implementation)
{
    _implementation->tile = tile;
    create();
}

DynamicTerrain::DynamicTerrain(const DynamicTerrain& other, const osg::CopyOp& copyop)
    : osg::Group(other, copyop), _implementation(new Implementation)
{
    const Implementation& there = *other._implementation;
    _implementation->tile = there.tile;
    _implementation->callback = there.callback;
    _implementation->rangeGiven = there.rangeGiven;
    _implementation->revision = there.revision;
    _implementation->unit = there.unit;
    removeChildren(0, getNumChildren());
    if (getStateSet()) // the other's texture and program are not for this one
        setStateSet(new osg::StateSet(*getStateSet()));
    create();
    _implementation->box = there.box;
    if (there.own)
    {
        _implementation->heights = there.heights;
        static_cast<HeightTexture&>(*_implementation->own).set(_implementation->heights.data());
    }
    if (there.theirs)
        setHeightTexture(there.theirs);
}

DynamicTerrain::~DynamicTerrain() = default;

void DynamicTerrain::create()
{
    setNumChildrenRequiringUpdateTraversal(getNumChildrenRequiringUpdateTraversal() + 1);
    const DemTile& tile = _implementation->tile;
    const std::string problem = tile.postCount() > 0 ? tile.complaint() : "";
    if (!problem.empty())
        warn("dynamic terrain draws nothing: " + problem);
    if (!problem.empty() || tile.width() < 2 || tile.height() < 2)
        return;
    _implementation->heights = _implementation->tile.heights();
    for (std::size_t i = 0; i < _implementation->heights.size(); ++i)
        if (!_implementation->tile.validity()[i])
            _implementation->heights[i] = std::numeric_limits<float>::quiet_NaN();
    osg::ref_ptr<HeightTexture> own =
        new HeightTexture(_implementation->tile.width(), _implementation->tile.height());
    const auto [lowest, highest] = own->set(_implementation->heights.data());
    _implementation->own = own;
    include(lowest, highest);
    addChild(createGrid(*this));

    osg::StateSet& stateSet = *getOrCreateStateSet();
    stateSet.setDataVariance(osg::Object::DYNAMIC); // its texture may change, and light be added
    stateSet.setTextureAttribute(
        _implementation->unit, _implementation->own); // no mode, as fixed function must not see it
    _implementation->sampler =
        new osg::Uniform(heightSampler, static_cast<int>(_implementation->unit));
    stateSet.addUniform(_implementation->sampler);
    stateSet.setAttribute(new DisplacedProgram);
    stateSet.addUniform(new osg::Uniform("osgTerrainLight_colour", 0));
    _implementation->hasColour = new osg::Uniform("osgTerrainLight_hasColour", false);
    stateSet.addUniform(_implementation->hasColour);
}

void DynamicTerrain::setHeightCallback(HeightCallback callback)
{
    _implementation->callback = std::move(callback);
}

const DemTile& DynamicTerrain::getTile() const
{
    return _implementation->tile;
}

void DynamicTerrain::dirtyHeights()
{
    ++_implementation->revision;
}

unsigned DynamicTerrain::getHeightRevision() const
{
    return _implementation->revision;
}

osg::BoundingBox DynamicTerrain::getBoundingBox() const
{
    return _implementation->box;
}

void DynamicTerrain::setHeightUnit(unsigned unit)
{
    if (unit > 31)
    {
        warn("height unit not set: needs 0 ... 31");
        return;
    }
    if (unit == _implementation->unit)
        return;
    osg::StateSet* stateSet = getStateSet();
    if (stateSet && stateSet->getTextureAttribute(unit, osg::StateAttribute::TEXTURE))
    {
        warn("height unit not set: texture unit " + std::to_string(unit) +
             " has another texture: needs a free one");
        return;
    }
    if (stateSet && _implementation->own)
    {
        stateSet->removeTextureAttribute(_implementation->unit, osg::StateAttribute::TEXTURE);
        stateSet->setTextureAttribute(unit, getHeightTexture());
        _implementation->sampler->set(static_cast<int>(unit));
    }
    _implementation->unit = unit;
}

unsigned DynamicTerrain::getHeightUnit() const
{
    return _implementation->unit;
}

osg::Texture2D* DynamicTerrain::getHeightTexture() const
{
    return _implementation->theirs ? _implementation->theirs : _implementation->own;
}

bool DynamicTerrain::setHeightTexture(osg::Texture2D* texture)
{
    if (!_implementation->own)
        return false;
    if (texture)
    {
        const osg::Image* image = texture->getImage();
        const int width = image ? image->s() : texture->getTextureWidth();
        const int height = image ? image->t() : texture->getTextureHeight();
        const auto filter = texture->getFilter(osg::Texture::MIN_FILTER);
        std::string problem;
        if (width != _implementation->tile.width() || height != _implementation->tile.height())
            problem = "has " + std::to_string(width) + " x " + std::to_string(height) +
                      " texels, the tile " + std::to_string(_implementation->tile.width()) + " x " +
                      std::to_string(_implementation->tile.height()) + " posts";
        else if (texture->getInternalFormat() != GL_R32F)
            problem = "its internal format is not GL_R32F";
        else if (filter != osg::Texture::NEAREST && filter != osg::Texture::LINEAR)
            problem = "its minifying filter uses mipmaps";
        if (!problem.empty())
        {
            warn("height texture not set: " + problem);
            return false;
        }
    }
    _implementation->theirs = texture;
    getOrCreateStateSet()->setTextureAttribute(_implementation->unit, getHeightTexture());
    dirtyHeights();
    return true;
}

void DynamicTerrain::setHeightRange(float lowest, float highest)
{
    if (!(lowest <= highest))
    {
        warn("height range not set: needs lowest <= highest");
        return;
    }
    _implementation->rangeGiven = false;
    _implementation->box.init();
    include(lowest, highest);
    _implementation->rangeGiven = true;
}

void DynamicTerrain::include(float lowest, float highest)
{
    if (_implementation->rangeGiven || lowest > highest ||
        (_implementation->box.valid() && lowest >= _implementation->box.zMin() &&
         highest <= _implementation->box.zMax()))
        return;
    if (_implementation->box.valid())
    {
        // What grows may grow on: changed bounds cost a search for tiles.
        const float more = 0.1f * (std::max(highest, _implementation->box.zMax()) -
                                   std::min(lowest, _implementation->box.zMin()));
        lowest = lowest < _implementation->box.zMin() ? lowest - more : _implementation->box.zMin();
        highest =
            highest > _implementation->box.zMax() ? highest + more : _implementation->box.zMax();
    }
    const float east = static_cast<float>(0.5 * (_implementation->tile.width() - 1) *
                                          _implementation->tile.nominalEastSpacing());
    const float north = static_cast<float>(0.5 * (_implementation->tile.height() - 1) *
                                           _implementation->tile.northSpacing);
    _implementation->box.set(-east, -north, lowest, east, north, highest);
    for (unsigned i = 0; i < getNumChildren(); ++i)
        getChild(i)->dirtyBound();
}

void DynamicTerrain::follow(osg::NodeVisitor& visitor)
{
    const osg::FrameStamp* stamp = visitor.getFrameStamp();
    if (!_implementation->own)
        return;
    if (stamp)
    {
        const std::pair frame(stamp->getFrameNumber(), stamp->getReferenceTime());
        if (frame == _implementation->lastFrame)
            return; // it stands in several places
        _implementation->lastFrame = frame;
    }
    const bool colour = getStateSet() && getStateSet()->getTextureAttribute(
                                             0, osg::StateAttribute::TEXTURE) != nullptr;
    bool current = colour;
    if (_implementation->hasColour->get(current) && current != colour)
        _implementation->hasColour->set(colour);
    if (_implementation->theirs || !_implementation->callback ||
        !_implementation->callback(stamp ? stamp->getSimulationTime() : 0.0,
                                   _implementation->tile.width(), _implementation->tile.height(),
                                   _implementation->heights.data()))
        return;
    const auto [lowest, highest] =
        static_cast<HeightTexture&>(*_implementation->own).set(_implementation->heights.data());
    include(lowest, highest);
    dirtyHeights();
}

void DynamicTerrain::traverse(osg::NodeVisitor& visitor)
{
    if (visitor.getVisitorType() == osg::NodeVisitor::UPDATE_VISITOR)
        follow(visitor);
    osg::Group::traverse(visitor);
}

void DynamicTerrain::releaseGLObjects(osg::State* state) const
{
    osg::Group::releaseGLObjects(state);
    if (_implementation->own)
        _implementation->own->releaseGLObjects(state);
}

void DynamicTerrain::resizeGLObjectBuffers(unsigned size)
{
    osg::Group::resizeGLObjectBuffers(size);
    if (_implementation->own)
        _implementation->own->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
