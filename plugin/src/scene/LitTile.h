#pragma once

#include "core/Result.h"
#include "lighting/TileLight.h"
#include <osgTerrainLight/TileHandle.h>

#include <osg/BoundingSphere>
#include <osg/Referenced>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace osgTerrainLight
{

/// What lights all tiles of a scene. It does not change once it is shared.
struct SceneLight
{
    LightingSettings settings;
    SkyLight sky;
    /// Grow where the members change.
    unsigned settingsVersion = 0, skyVersion = 0;
};

/// A tile's lighting and, per graphics context, how far it has come.
class LitTile : public osg::Referenced
{
public:
    LitTile(std::string name, const DemTile& dem, std::shared_ptr<const SceneLight> light);

    const std::string& name() const { return _name; }
    TileLight& lighting() const { return *_lighting; }

    /// Where it is drawn, in the frame of TerrainLighting; invalid where that is not known.
    void setBound(const osg::BoundingSphere& bound) { _bound = bound; }
    const osg::BoundingSphere& bound() const { return _bound; }

    /// Hands the scene's light on and computes what has changed, in draw traversal, as far as the
    /// pace lets it.
    Status update(osg::State& state, const std::shared_ptr<const SceneLight>& light,
                  WorkPace* pace);
    /// Whether update() would compute something.
    bool isBehind(unsigned context, const std::shared_ptr<const SceneLight>& light) const;

    enum class Stage
    {
        Waiting, ///< never computed: the host scene draws unlit
        Lit,
        Failed ///< said once, not tried again
    };
    Stage stage(unsigned context) const;
    void setStage(unsigned context, Stage stage);
    void fail(unsigned context, const std::string& message);
    /// Of the first context where it failed; empty where there is none.
    std::string failure() const;
    /// Of all contexts that have drawn it.
    TileState state() const;
    /// ~0u: all contexts.
    void forget(unsigned context);
    /// What failed may be tried again.
    void retry();

    /// It is bound to the tile's StateSet, so that programs may read it.
    std::atomic<bool> glossy{false};

private:
    ~LitTile() override = default;
    bool isNewer(const SceneLight& light) const;

    std::string _name;
    osg::ref_ptr<TileLight> _lighting;
    osg::BoundingSphere _bound;

    mutable std::mutex _mutex;                ///< never held during a dispatch
    std::shared_ptr<const SceneLight> _light; ///< the newest that was handed on
    std::map<unsigned, Stage> _stages;
    std::map<unsigned, std::string> _failures; ///< where the stage is Failed, or was
};

} // namespace osgTerrainLight
