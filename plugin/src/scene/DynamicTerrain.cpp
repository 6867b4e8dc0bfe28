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

DynamicTerrain::DynamicTerrain()
{
    create();
}

DynamicTerrain::DynamicTerrain(const DemTile& tile) : _tile(tile)
{
    create();
}

DynamicTerrain::DynamicTerrain(const DynamicTerrain& other, const osg::CopyOp& copyop)
    : osg::Group(other, copyop), _tile(other._tile), _callback(other._callback),
      _rangeGiven(other._rangeGiven), _revision(other._revision)
{
    removeChildren(0, getNumChildren());
    if (getStateSet()) // the other's texture and program are not for this one
        setStateSet(new osg::StateSet(*getStateSet()));
    create();
    _box = other._box;
    if (other._own)
    {
        _heights = other._heights;
        static_cast<HeightTexture&>(*_own).set(_heights.data());
    }
    if (other._theirs)
        setHeightTexture(other._theirs);
}

DynamicTerrain::~DynamicTerrain() = default;

void DynamicTerrain::create()
{
    setNumChildrenRequiringUpdateTraversal(getNumChildrenRequiringUpdateTraversal() + 1);
    if (_tile.width() < 2 || _tile.height() < 2)
        return;
    _heights = _tile.heights();
    for (std::size_t i = 0; i < _heights.size(); ++i)
        if (!_tile.validity()[i])
            _heights[i] = std::numeric_limits<float>::quiet_NaN();
    osg::ref_ptr<HeightTexture> own = new HeightTexture(_tile.width(), _tile.height());
    const auto [lowest, highest] = own->set(_heights.data());
    _own = own;
    include(lowest, highest);
    addChild(createGrid(*this));

    osg::StateSet& stateSet = *getOrCreateStateSet();
    stateSet.setDataVariance(osg::Object::DYNAMIC); // its texture may change, and light be added
    stateSet.setTextureAttribute(heightUnit, _own); // no mode, as fixed function must not see it
    stateSet.addUniform(new osg::Uniform(heightSampler, static_cast<int>(heightUnit)));
    stateSet.setAttribute(new DisplacedProgram);
    stateSet.addUniform(new osg::Uniform("osgTerrainLight_colour", 0));
    _hasColour = new osg::Uniform("osgTerrainLight_hasColour", false);
    stateSet.addUniform(_hasColour);
}

void DynamicTerrain::setHeightCallback(HeightCallback callback)
{
    _callback = std::move(callback);
}

osg::Texture2D* DynamicTerrain::getHeightTexture() const
{
    return _theirs ? _theirs : _own;
}

bool DynamicTerrain::setHeightTexture(osg::Texture2D* texture)
{
    if (!_own)
        return false;
    if (texture)
    {
        const osg::Image* image = texture->getImage();
        const int width = image ? image->s() : texture->getTextureWidth();
        const int height = image ? image->t() : texture->getTextureHeight();
        const auto filter = texture->getFilter(osg::Texture::MIN_FILTER);
        std::string problem;
        if (width != _tile.width() || height != _tile.height())
            problem = "has " + std::to_string(width) + " x " + std::to_string(height) +
                      " texels, the tile " + std::to_string(_tile.width()) + " x " +
                      std::to_string(_tile.height()) + " posts";
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
    _theirs = texture;
    getOrCreateStateSet()->setTextureAttribute(heightUnit, getHeightTexture());
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
    _rangeGiven = false;
    _box.init();
    include(lowest, highest);
    _rangeGiven = true;
}

void DynamicTerrain::include(float lowest, float highest)
{
    if (_rangeGiven || lowest > highest ||
        (_box.valid() && lowest >= _box.zMin() && highest <= _box.zMax()))
        return;
    if (_box.valid())
    {
        // What grows may grow on: changed bounds cost a search for tiles.
        const float more = 0.1f * (std::max(highest, _box.zMax()) - std::min(lowest, _box.zMin()));
        lowest = lowest < _box.zMin() ? lowest - more : _box.zMin();
        highest = highest > _box.zMax() ? highest + more : _box.zMax();
    }
    const float east = static_cast<float>(0.5 * (_tile.width() - 1) * _tile.nominalEastSpacing());
    const float north = static_cast<float>(0.5 * (_tile.height() - 1) * _tile.northSpacing);
    _box.set(-east, -north, lowest, east, north, highest);
    for (unsigned i = 0; i < getNumChildren(); ++i)
        getChild(i)->dirtyBound();
}

void DynamicTerrain::follow(osg::NodeVisitor& visitor)
{
    const osg::FrameStamp* stamp = visitor.getFrameStamp();
    if (!_own)
        return;
    if (stamp)
    {
        const std::pair frame(stamp->getFrameNumber(), stamp->getReferenceTime());
        if (frame == _lastFrame)
            return; // it stands in several places
        _lastFrame = frame;
    }
    const bool colour = getStateSet() && getStateSet()->getTextureAttribute(
                                             0, osg::StateAttribute::TEXTURE) != nullptr;
    bool current = colour;
    if (_hasColour->get(current) && current != colour)
        _hasColour->set(colour);
    if (_theirs || !_callback ||
        !_callback(stamp ? stamp->getSimulationTime() : 0.0, _tile.width(), _tile.height(),
                   _heights.data()))
        return;
    const auto [lowest, highest] = static_cast<HeightTexture&>(*_own).set(_heights.data());
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
    if (_own)
        _own->releaseGLObjects(state);
}

void DynamicTerrain::resizeGLObjectBuffers(unsigned size)
{
    osg::Group::resizeGLObjectBuffers(size);
    if (_own)
        _own->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
