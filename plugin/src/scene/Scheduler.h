#pragma once

#include "lighting/ObjectLight.h"
#include "scene/LitTile.h"
#include "scene/WorkClock.h"

#include <osg/Referenced>
#include <osgUtil/CullVisitor>

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// The tiles of one TerrainLighting as its cull and draw traversals see them, and what of their
/// light is computed in a frame: within a budget, the tile that is seen best first. Thread-safe.
class Scheduler : public osg::Referenced
{
public:
    /// now: of its clocks.
    explicit Scheduler(WorkClock::Now now = {})
        : _now(std::move(now)), _light(std::make_shared<SceneLight>())
    {
    }

    void add(LitTile* tile);
    void remove(LitTile* tile);
    /// Once per update: warns, once, where several tiles have been lit alone for a while in which
    /// no tile came. Tiles that are still loading may touch them.
    void tellAlone();
    /// Half a second of frames, in which a loader that is at work brings another tile.
    static constexpr int updatesToTellAlone = 30;

    void setSettings(const LightingSettings& settings);
    void setSky(const SkyLight& sky);
    std::shared_ptr<const SceneLight> light() const;

    /// Of all placed objects: computed before the tiles that they stand on.
    ObjectLight& objects() const { return *_objects; }

    /// Something that tiles depend on has changed.
    void touch() { ++_revision; }
    void forget(unsigned context);

    std::atomic<bool> enabled{true};
    std::atomic<double> budget{50.0}; ///< [ms] per frame; 0: no limit

    /// Counts updates after which a tile's light sent by gloss may be in another texture.
    unsigned textureRevision() const { return _textureRevision; }

    /// Whether tile may be drawn with its shading.
    bool isLit(const LitTile& tile, unsigned context) const
    {
        return enabled && tile.isDrawable(context);
    }

    /// False where compute() would run a step.
    bool isDone(unsigned context) const;
    /// False where it would in some context.
    bool isDone() const;

    /// The first reason why a tile or a context draws unlit; empty where there is none.
    std::string failure() const;

    /// In cull traversal, in the frame of TerrainLighting: notes how large tiles are on the screen.
    /// Nothing is done where nothing waits.
    void see(const osgUtil::CullVisitor& cull);

    /// Computes what has changed within the budget (FramePace). Needs a current context.
    void compute(osg::State& state);
    /// In cull traversal: in this frame there is nothing to compute.
    void rest(unsigned context);
    /// Spent on light in the last frame of the context where it was most [ms].
    double milliseconds() const;

private:
    ~Scheduler() override = default;

    /// Large is first: pixels of radius where it is in view, minus the distance where it is not.
    struct Sight
    {
        unsigned frame = 0;
        double rank = 0.0;
    };
    struct Context
    {
        bool asked = false, supported = false;
        unsigned done = 0; ///< revision at which every tile was up to date
        std::map<const LitTile*, Sight> sights;
        const LitTile* begun = nullptr; ///< where the budget stopped the last frame: it is first
        std::shared_ptr<WorkClock> clock;
        double milliseconds = 0.0; ///< in the last frame
    };
    bool supports(osg::State& state, Context& context);
    std::vector<osg::ref_ptr<LitTile>> inOrder(const Context& context) const;
    /// Tiles among others that keep all that their light is computed from, so that the next change
    /// of light costs less: about 20 MiB each.
    static constexpr std::size_t mostAwake = 32;
    void restBehind(const std::vector<osg::ref_ptr<LitTile>>& inOrder,
                    const std::shared_ptr<const SceneLight>& light);
    bool update(LitTile& tile, osg::State& state, FramePace& pace);
    bool updateObjects(osg::State& state, FramePace& pace);
    bool isDone(const Context& context) const
    {
        return (context.asked && !context.supported) || context.done == _revision;
    }

    const WorkClock::Now _now;
    const osg::ref_ptr<ObjectLight> _objects{new ObjectLight};
    mutable std::mutex _mutex; ///< never held during a dispatch
    std::vector<osg::ref_ptr<LitTile>> _tiles;
    int _alone = 0;          ///< tiles that nothing surrounds
    int _updatesAlone = 0;   ///< with several of them, since a tile came
    bool _saidAlone = false; ///< that tiles do not light one another
    std::map<unsigned, Context> _contexts;
    std::shared_ptr<const SceneLight> _light;
    std::atomic<unsigned> _revision{1};
    std::atomic<unsigned> _textureRevision{0};
    std::string _unsupported;
    std::string _objectsFailure; ///< said; they are not computed any more
};

} // namespace osgTerrainLight
