#pragma once

#include <osg/Group>
#include <osg/Matrixd>
#include <osgTerrain/TerrainTile>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace osgTerrainLight
{

/// A bound in the frame that the matrix leads to.
osg::BoundingSphere inFrame(const osg::BoundingSphere& bound, const osg::Matrixd& matrix);

/// A terrain tile below TerrainLighting.
struct FoundTile
{
    osgTerrain::TerrainTile* tile = nullptr;
    osg::Matrixd toScene;    ///< from the tile's frame to that of TerrainLighting
    bool hasProgram = false; ///< of its own or from above
    osg::NodePath above;     ///< from TerrainLighting to the tile's parent
};

/// Finds the osgTerrain tiles below a node, those that are added or paged in later too.
///
/// What comes, goes or moves below dirties the bounds above it. When the node's own bound is about
/// to be computed anew, which is before any of those, the finder notes the dirty ones: it keeps a
/// picture of the graph and afterwards compares only along their paths. A scene that stands still
/// costs nothing.
class TileFinder
{
public:
    TileFinder();
    ~TileFinder();

    /// What has become of tiles. A tile that stands in several places counts where it was found
    /// first.
    class Listener
    {
    public:
        virtual void came(const FoundTile& tile) = 0;
        /// It is somewhere else, or its bound has changed.
        virtual void changed(const FoundTile& tile) = 0;
        virtual void went(osgTerrain::TerrainTile& tile) = 0;

    protected:
        ~Listener() = default;
    };

    /// In the node's computeBound(), before its children's bounds are computed; in any thread.
    void noteDirtyBounds();

    /// In update traversal, once the node's bound has been computed. False where nothing below has
    /// changed since the last call.
    bool follow(osg::Group& root, Listener& listener);

    /// A tile that was found, where it stands.
    std::optional<FoundTile> find(const osgTerrain::TerrainTile* tile) const;

    /// Nodes that follow() has looked at so far.
    unsigned visits() const { return _visits; }

private:
    struct Branch;
    void note(Branch& branch);
    void visit(Branch& branch, bool whole, Listener& listener);
    bool place(Branch& branch);
    bool match(Branch& branch, Listener& listener);
    void drop(Branch& branch, Listener& listener);
    static FoundTile found(const Branch& branch);

    /// Of the branches' marks. Recursive: listeners may have bounds computed.
    std::recursive_mutex _mutex;
    std::unique_ptr<Branch> _root;
    std::atomic<bool> _dirty{true};
    std::map<const osgTerrain::TerrainTile*, std::vector<Branch*>> _places;
    unsigned _visits = 0;
};

} // namespace osgTerrainLight
