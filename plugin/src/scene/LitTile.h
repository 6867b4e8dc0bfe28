#pragma once

#include "core/Result.h"
#include "lighting/TileLight.h"
#include <osgTerrainLight/TileHandle.h>

#include <osg/BoundingSphere>
#include <osg/Matrixd>
#include <osg/Referenced>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace osgTerrainLight
{

struct TileWindows;

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
    /// A tile and what surrounds it. Where there are bounces it is lit with a margin of posts
    /// around it, which is not drawn, so that they find their neighbours' light.
    /// turn: the rotation from the light's axes to the tile's, where they are not the same.
    LitTile(std::string name, const std::shared_ptr<const TileWindows>& windows,
            std::shared_ptr<const SceneLight> light, const std::optional<osg::Matrixd>& turn = {});

    /// Of posts on each side that are lit and not drawn.
    struct Margin
    {
        int west = 0, south = 0, east = 0, north = 0;
    };
    const Margin& margin() const { return _margin; }
    /// From tile coordinates of what is drawn to those of what is lit: (0, 0) to (1, 1).
    osg::Matrixd fromDrawn() const;
    int drawnWidth() const { return _lighting->width() - _margin.west - _margin.east; }
    int drawnHeight() const { return _lighting->height() - _margin.south - _margin.north; }
    /// A value per post that is lit, from those of posts that are drawn: the nearest one's.
    template <class T>
    Raster<T> withMargin(const Raster<T>& drawn) const
    {
        if (drawn.empty() ||
            (drawn.width() == _lighting->width() && drawn.height() == _lighting->height()))
            return drawn;
        Raster<T> lit(_lighting->width(), _lighting->height());
        for (int row = 0; row < lit.height(); ++row)
            for (int column = 0; column < lit.width(); ++column)
                lit.at(column, row) =
                    drawn.at(std::clamp(column - _margin.west, 0, drawn.width() - 1),
                             std::clamp(row - _margin.south, 0, drawn.height() - 1));
        return lit;
    }
    bool isSurrounded() const { return _surrounded; }
    /// Whether the light is such that it should have another margin.
    bool needsOtherMargin(const LightingSettings& settings) const
    {
        return _surrounded && _hasMargin != (settings.bounces > 0);
    }

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
    /// The context draws it, and it waits there where it is in no other stage.
    void meet(unsigned context);
    std::set<unsigned> litContexts() const;
    /// Of the first context where it failed; empty where there is none.
    std::string failure() const;
    /// Of all contexts that have drawn it.
    TileState state() const;
    /// ~0u: all contexts.
    void forget(unsigned context);
    /// What failed may be tried again.
    void retry();

    /// Contexts that have other light to draw it with until its own is there (TileFades.h); none:
    /// there is no such light. fades: its own is drawn besides.
    void setFormer(std::optional<std::set<unsigned>> contexts, bool fades = false);
    /// False where a context draws it that has no such light.
    bool isFormerEverywhere() const;
    /// The context has released its textures.
    void forgetFormer(unsigned context);
    /// Whether there is light to draw it with.
    bool isDrawable(unsigned context) const;

    /// It is bound to the tile's StateSet, so that programs may read it.
    std::atomic<bool> glossy{false};

private:
    ~LitTile() override = default;
    bool isNewer(const SceneLight& light) const;
    SkyLight turned(const SkyLight& sky) const;

    const std::string _name;
    const bool _surrounded = false, _hasMargin = false;
    Margin _margin;
    const std::optional<osg::Matrixd> _turn;
    osg::ref_ptr<TileLight> _lighting;
    osg::BoundingSphere _bound;

    mutable std::mutex _mutex;                ///< never held during a dispatch
    std::shared_ptr<const SceneLight> _light; ///< the newest that was handed on
    std::map<unsigned, Stage> _stages;
    std::map<unsigned, std::string> _failures; ///< where the stage is Failed, or was
    std::optional<std::set<unsigned>> _former;
    bool _fades = false;
};

} // namespace osgTerrainLight
