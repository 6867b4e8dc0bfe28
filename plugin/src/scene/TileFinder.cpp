#include "scene/TileFinder.h"

#include "scene/TilePrograms.h"

#include <osg/Camera>
#include <osg/Transform>

#include <algorithm>
#include <typeinfo>

namespace osgTerrainLight
{

namespace
{
/// Whether a node's bound is up to date, which osg::Node tells only to what derives from it.
class BoundState : public osg::Node
{
public:
    static bool isComputed(const osg::Node& node)
    {
        return node.*(&BoundState::_boundingSphereComputed);
    }
};

/// A plain program without shaders is none: copies of a TileProgram are such, and so are those that
/// are read from the file of a lit scene.
bool bringsProgram(const osg::Node& node)
{
    const osg::StateSet* stateSet = node.getStateSet();
    const osg::StateAttribute* program =
        stateSet ? stateSet->getAttribute(osg::StateAttribute::PROGRAM) : nullptr;
    if (!program || dynamic_cast<const TileProgram*>(program))
        return false;
    const osg::StateAttribute& attribute = *program;
    return typeid(attribute) != typeid(osg::Program) ||
           static_cast<const osg::Program&>(attribute).getNumShaders() > 0;
}

bool hasProgramAbove(const osg::Group& root)
{
    for (const osg::NodePath& path : root.getParentalNodePaths())
        for (const osg::Node* node : path)
            if (bringsProgram(*node))
                return true;
    return false;
}
} // namespace

osg::BoundingSphere inFrame(const osg::BoundingSphere& bound, const osg::Matrixd& matrix)
{
    if (!bound.valid())
        return bound;
    double scale = 0.0;
    for (int row = 0; row < 3; ++row)
        scale =
            std::max(scale, osg::Vec3d(matrix(row, 0), matrix(row, 1), matrix(row, 2)).length());
    return {osg::Vec3d(bound.center()) * matrix, bound.radius() * static_cast<float>(scale)};
}

/// A node as it stands in one place of the graph. It keeps the node, so that no other one can take
/// its address before the two are compared.
struct TileFinder::Branch
{
    Branch(osg::Node* which, Branch* above)
        : node(which), kept(above ? which : nullptr), parent(above)
    {
    }

    osg::Node* node;
    osg::ref_ptr<osg::Node> kept; ///< the node; null at the root, which owns the finder
    Branch* parent;
    osg::Matrixd toScene; ///< from the frame of its children
    bool hasProgram = false;
    bool fresh = true;                          ///< has not been visited
    bool dirty = true;                          ///< its bound was, since it was visited last
    osg::ref_ptr<osgTerrain::TerrainTile> tile; ///< the node, where it is one
    std::vector<std::unique_ptr<Branch>> children;
};

TileFinder::TileFinder() = default;
TileFinder::~TileFinder() = default;

void TileFinder::noteDirtyBounds()
{
    const std::lock_guard<std::recursive_mutex> lock(_mutex);
    if (_root)
        note(*_root);
    _dirty = true;
}

void TileFinder::note(Branch& branch)
{
    branch.dirty = true;
    for (const auto& child : branch.children)
        if (!BoundState::isComputed(*child->node))
            note(*child);
}

bool TileFinder::follow(osg::Group& root, Listener& listener)
{
    if (!_dirty.exchange(false))
        return false;
    const std::lock_guard<std::recursive_mutex> lock(_mutex);
    if (!_root)
        _root = std::make_unique<Branch>(&root, nullptr);
    visit(*_root, false, listener);
    return true;
}

/// Sets matrix and program; whether they have changed.
bool TileFinder::place(Branch& branch)
{
    osg::Matrixd toScene = branch.parent ? branch.parent->toScene : osg::Matrixd();
    if (const osg::Transform* transform = branch.node->asTransform())
    {
        const osg::Camera* camera = transform->asCamera();
        if (camera && camera->getReferenceFrame() != osg::Transform::RELATIVE_RF)
            toScene.makeIdentity();
        else
            transform->computeLocalToWorldMatrix(toScene, nullptr);
    }
    branch.hasProgram = branch.parent ? branch.parent->hasProgram || bringsProgram(*branch.node)
                                      : hasProgramAbove(*branch.node->asGroup());
    const bool moved = !(toScene == branch.toScene);
    branch.toScene = toScene;
    return moved;
}

/// Takes over the node's list of children; whether it has changed.
bool TileFinder::match(Branch& branch, Listener& listener)
{
    const osg::Group* group = branch.node->asGroup();
    const unsigned count = group ? group->getNumChildren() : 0;
    bool same = branch.children.size() == count;
    for (unsigned i = 0; same && i < count; ++i)
        same = branch.children[i]->node == group->getChild(i);
    if (same)
        return false;
    std::multimap<const osg::Node*, std::unique_ptr<Branch>> before;
    for (auto& child : branch.children)
    {
        const osg::Node* node = child->node;
        before.emplace(node, std::move(child));
    }
    branch.children.clear();
    for (unsigned i = 0; i < count; ++i)
    {
        osg::Node* node = const_cast<osg::Node*>(group->getChild(i));
        const auto known = before.find(node);
        if (known == before.end())
            branch.children.push_back(std::make_unique<Branch>(node, &branch));
        else
        {
            branch.children.push_back(std::move(known->second));
            before.erase(known);
        }
    }
    for (const auto& [node, gone] : before)
        drop(*gone, listener);
    return true;
}

/// whole: everything below is looked at, not only what was dirty.
void TileFinder::visit(Branch& branch, bool whole, Listener& listener)
{
    ++_visits;
    const bool moved = place(branch);
    const bool fresh = std::exchange(branch.fresh, false);
    branch.dirty = false;
    if (fresh)
        branch.tile = dynamic_cast<osgTerrain::TerrainTile*>(branch.node);
    if (branch.tile)
    {
        if (fresh)
        {
            auto& places = _places[branch.tile];
            places.push_back(&branch);
            if (places.size() == 1)
                listener.came(found(branch));
        }
        else if (_places[branch.tile].front() == &branch)
            listener.changed(found(branch));
    }
    else
    {
        const bool explained =
            match(branch, listener) || std::any_of(branch.children.begin(), branch.children.end(),
                                                   [](const auto& child) { return child->dirty; });
        // Where no reason is seen, a bound in between has been asked for before that of the root.
        whole = whole || moved || !explained;
        for (const auto& child : branch.children)
            if (whole || child->dirty)
                visit(*child, whole, listener);
    }
    // Only a node whose bound is up to date tells those above it that it has changed.
    if (branch.parent)
        branch.node->getBound();
}

void TileFinder::drop(Branch& branch, Listener& listener)
{
    for (const auto& child : branch.children)
        drop(*child, listener);
    const auto places = branch.tile ? _places.find(branch.tile) : _places.end();
    if (places == _places.end())
        return;
    auto& branches = places->second;
    const bool first = branches.front() == &branch;
    branches.erase(std::find(branches.begin(), branches.end(), &branch));
    if (branches.empty())
    {
        _places.erase(places);
        listener.went(*branch.tile);
    }
    else if (first)
        listener.changed(found(*branches.front()));
}

FoundTile TileFinder::found(const Branch& branch)
{
    FoundTile found{branch.tile, branch.toScene, branch.hasProgram, {}};
    for (const Branch* above = branch.parent; above; above = above->parent)
        found.above.insert(found.above.begin(), above->node);
    return found;
}

std::optional<FoundTile> TileFinder::find(const osgTerrain::TerrainTile* tile) const
{
    const auto places = _places.find(tile);
    if (places == _places.end())
        return std::nullopt;
    return found(*places->second.front());
}

} // namespace osgTerrainLight
