#pragma once

#include "core/Raster.h"
#include "core/Result.h"
#include "lighting/TileLight.h"
#include <osgTerrainLight/TileHandle.h>

#include <osg/BoundingSphere>
#include <osg/Referenced>

#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What lights all tiles of a scene. It does not change once it is shared.
struct SceneLight
{
    LightingSettings settings;
    SkyLight sky;
    /// Differ where the members do.
    unsigned settingsVersion = 0, skyVersion = 0;
};

/// A tile's lighting and, per graphics context, how far it has come.
///
/// Setters are called in update traversal and never wait for a dispatch: they note what has
/// changed, and the next update() in a draw traversal takes it over.
class LitTile : public osg::Referenced
{
public:
    LitTile(std::string name, const DemTile& dem, std::shared_ptr<const SceneLight> light);

    const std::string& name() const { return _name; }
    TileLight& lighting() const { return *_lighting; }

    void setHeights(std::vector<float> heights);
    void setHeightTexture(osg::Texture2D* texture);
    void touchHeights();
    void setAlbedo(Raster<Rgb> albedo);
    void setGloss(Raster<std::array<float, 2>> gloss);
    void setProbes(std::vector<ProbePlace> probes);
    /// Every stage runs again: its shader may be another.
    void recompute();

    /// Where it is drawn, in the frame of TerrainLighting; invalid where that is not known.
    void setBound(const osg::BoundingSphere& bound) { _bound = bound; }
    const osg::BoundingSphere& bound() const { return _bound; }

    /// Computes what has changed, in draw traversal; mayContinue is asked between steps. What it
    /// stops in between is gone on with first, and later changes are taken over only then: where
    /// light changes in every frame and a budget is short, it would come to no end otherwise.
    Status update(osg::State& state, const std::shared_ptr<const SceneLight>& light,
                  const std::function<bool()>& mayContinue);
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

    /// Light sent by gloss as of the last update(); null: none.
    osg::ref_ptr<osg::Texture2DArray> glossLight() const;
    /// It is bound to the tile's StateSet, so that programs may read it.
    std::atomic<bool> glossy{false};

private:
    ~LitTile() override = default;

    struct Changes
    {
        std::optional<std::vector<float>> heights;
        osg::ref_ptr<osg::Texture2D> heightTexture;
        bool heightsTouched = false;
        std::optional<Raster<Rgb>> albedo;
        std::optional<Raster<std::array<float, 2>>> gloss;
        std::optional<std::vector<ProbePlace>> probes;
        bool recompute = false;
    };
    template <class F>
    void note(F&& change);
    void apply(const SceneLight& light);

    std::string _name;
    osg::ref_ptr<TileLight> _lighting;
    osg::BoundingSphere _bound;

    mutable std::mutex _mutex; ///< never held during a dispatch
    Changes _changes;
    bool _changed = false;
    std::shared_ptr<const SceneLight> _applied;
    osg::ref_ptr<osg::Texture2DArray> _glossLight;
    std::set<unsigned> _unfinished; ///< contexts where an update was stopped
    std::map<unsigned, Stage> _stages;
    std::map<unsigned, std::string> _failures; ///< where the stage is Failed, or was

    std::mutex _applying; ///< one context's thread at a time hands changes on
};

} // namespace osgTerrainLight
