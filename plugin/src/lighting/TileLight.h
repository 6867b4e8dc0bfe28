#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/HorizonMap.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "core/Result.h"
#include "core/SettingRow.h"
#include "gpu/HeightTexture.h"
#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/methods/Method.h"
#include "lighting/nodes/ObjectRadiosityNode.h"

#include <osg/Referenced>
#include <osg/Texture2D>
#include <osg/Texture2DArray>
#include <osg/Vec4f>

#include <OpenThreads/Mutex>

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace osgTerrainLight
{

struct TileWindows;

/// One tile's work: heights and light in, shading texture out.
///
/// Setters may be called from any thread, and never wait for what is computed: the next update()
/// takes up what they set. update() and the read functions need the current context of their state.
/// Stages: heights (they have been set), horizon (a sky or a bounce is on), table (a sky in
/// harmonics is on), sky (a sky is on), key (a key light is above the horizontal and not black),
/// sun (a sun is on and not wholly below the horizontal), shadow (there is such a sun, and bounces
/// or shadow edges), edges (the same, and shadow edges), pyramid (of heights: bounces of gloss),
/// shade (direct light), gloss (the ground is glossy, and there is light), sent and bounce (bounces
/// are on, and there is what they would bounce: each once per bounce), compose (there are bounces:
/// adds them to direct light), probe (there are probes). With a BounceMethod other than Slices,
/// horizon, sky, key, sun and gloss do not exist: where there is any light, shade takes it from the
/// pyramid.
class TileLight : public osg::Referenced
{
public:
    TileLight(const DemTile& tile, const LightingSettings& settings, const SkyLight& sky,
              SkyViewDefinition definition = SkyViewDefinition::Surface);
    /// A tile lit by what surrounds it, too. Its heights stay as they are. The Legendre method and
    /// gloss see nothing beyond the tile.
    TileLight(std::shared_ptr<const TileWindows> windows, const LightingSettings& settings,
              const SkyLight& sky, SkyViewDefinition definition = SkyViewDefinition::Surface);

    /// Horizons that the sun's stage computes per post: across its disc.
    static constexpr int sunAzimuths = 3;

    /// Whether a light has a sun stage: a sun that is on and not wholly below the horizontal.
    static bool needsSun(const SkyLight& sky);

    /// Horizons that the key lights' stage computes per post.
    static int keyAzimuths(const SkyLight& sky, const LightingSettings& settings);

    int width() const { return _tile.width(); }
    int height() const { return _tile.height(); }
    const DemTile& tile() const { return _tile; }

    void setSettings(const LightingSettings& settings);
    void setSky(const SkyLight& sky);

    /// Albedo per post, 0 … 1, row 0 south, instead of the settings'; empty: theirs again.
    void setAlbedo(Raster<Rgb> albedo);

    /// Gloss (0 … 1) and exponent (1 … 64) per post, row 0 south, instead of the settings'; empty:
    /// theirs again.
    void setGloss(Raster<std::array<float, 2>> gloss);

    /// For bounces from beyond the tile, whose windows it has. Null: nothing.
    void setFarLight(std::shared_ptr<const FarLight> light);

    /// Places where light from all around is computed. Each has maps of its own. Whether that is a
    /// change.
    bool setProbes(std::vector<ProbePlace> probes);

    /// Volumes of distances to placed objects that change the light of the ground. Whether that is
    /// a change. What is in a volume may change at any time.
    bool setObjects(TileObjects objects);

    /// Replaces all heights: width() x height() values [m above the tile's heightOrigin], row 0
    /// south. What is not finite or beyond 1e6 m is void. tile() keeps those it was made with.
    void setHeights(const std::vector<float>& heights);
    /// The same from a texture, R32F, a texel per post, whose minifying filter has no mipmaps. It
    /// is read in each context that updates, at the next update, and again after touchHeights().
    void setHeightTexture(osg::Texture2D* posts);
    void touchHeights();

    /// Every stage runs again at the next update: for measurements, and after a shader was edited.
    void touch();

    /// Every stage runs again, in every context: its shader may be another.
    void recompute();

    /// Runs the stages whose inputs have changed in this context. Where the pace stops them, also
    /// within one, the tile stays dirty, and the next update goes on from there with the same
    /// values, before it takes up what setters have set since: where light changes in every
    /// frame and a budget is short, it would come to no end otherwise. With a
    /// bounceInterval above 1 the tile may be dirty afterwards: the next update, if nothing changes
    /// before, mends that.
    Status update(osg::State& state, WorkPace* pace = nullptr);
    bool isDirty(unsigned contextID) const;

    /// Lets go of all that light is computed from and by: what stays is the light, its parts by
    /// bounce, and the heights on the CPU. The next change computes everything anew. Nothing
    /// happens where the light of a context is not whole, or where something else reads what would
    /// go (gloss, probes, edges of shadows, heights that change).
    void rest();
    bool isResting() const;

    /// RGBA16F, a texel per post, row 0 south: rgb = irradiance / pi, a = visible fraction of the
    /// sun (1 where the sun is off). Void posts: all 0.
    osg::Texture2D* shading() const;

    /// RGBA16F, a texel per post, GlossWork::layers layers: light sent by gloss (ShadingTexture.h),
    /// without that of the sun, as of the last update. Null where nothing is glossy or there is no
    /// light.
    osg::ref_ptr<osg::Texture2DArray> glossLight() const;

    /// RGBA16F, a texel per post: the edges of the sun's shadow (ShadingTexture.h), as of the last
    /// update. Null where they are off or there is no sun.
    osg::ref_ptr<osg::Texture2D> shadowEdges() const;

    /// What objects leave of the light of the shading texture and, in a, of the visible fraction of
    /// the sun: RGBA16F, texels of TileObject; and the objects that it is of. Null: there are none.
    struct DrawnObjects
    {
        osg::ref_ptr<osg::Texture2D> factor;
        TileObjects objects;
    };
    /// Nothing where it is not computed yet in one of the contexts: what was drawn before stays.
    std::optional<DrawnObjects> drawnObjects(const std::set<unsigned>& contexts) const;
    /// What the objects of a volume send in the light of this tile, and what they leave of the
    /// ground's (ObjectRadiosityNode). Null where nothing bounces, or where it is not computed yet
    /// in one of the contexts.
    struct ObjectRadiosity
    {
        osg::ref_ptr<osg::Texture> sent, groundShare;
        bool operator==(const ObjectRadiosity& other) const
        {
            return sent == other.sent && groundShare == other.groundShare;
        }
    };
    ObjectRadiosity objectRadiosity(const Resource& volume,
                                    const std::set<unsigned>& contexts) const;
    /// Grows where drawnObjects() may give something else.
    unsigned objectsRevision() const;

    /// Read-back, all in tile order (row 0 south). Call after update().
    /// Of glossLight(), layer after layer, four values per post.
    std::vector<float> readGlossLight(osg::State& state) const;
    Raster<osg::Vec4f> readShading(osg::State& state) const;
    /// Of direct light alone, as readShading.
    Raster<osg::Vec4f> readDirect(osg::State& state) const;
    Raster<float>
    readSkyView(osg::State& state) const; ///< NaN where void; as readHorizons, the sky uniform
    /// Precondition: a sky is on, and the method is Slices.
    HorizonMap readHorizons(osg::State& state) const;
    /// Of one bounce alone, 1 … settings' bounces: rgb = irradiance / π, a = 1; 0 where void.
    /// Precondition: bounces are on, and there is what they would bounce.
    Raster<osg::Vec4f> readBounce(osg::State& state, int bounce) const;
    /// Bounces that there are: of the settings, or none where there is nothing to bounce.
    int bounces() const { return static_cast<int>(_bounces.size()); }
    unsigned readDroppedVertices(osg::State& state) const; ///< of all sweeps

    void setTimed(bool timed) { _graph.setTimed(timed); }
    std::vector<StageCost> costs() const;
    /// Bytes of all textures, heights and shading included.
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state = nullptr) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~TileLight() override = default;

    Status apply();
    void followValues(Invalidation stale);
    void declareMethod();
    void declareTransport();
    WorkGraph::Nodes nodes();
    void declareObjects();

    /// What setters have changed since the last update.
    struct Changes
    {
        bool settings = false, sky = false, albedo = false, gloss = false, probes = false,
             objects = false, posts = false, touched = false, recompute = false, farLight = false;
        bool any() const
        {
            return settings || sky || albedo || gloss || probes || objects || posts || touched ||
                   recompute || farLight;
        }
    };

    TileLight(const DemTile& tile, std::shared_ptr<const TileWindows> windows,
              const LightingSettings& settings, const SkyLight& sky, SkyViewDefinition definition);

    const DemTile _tile;
    const std::shared_ptr<const TileWindows> _windows; ///< null: nothing surrounds the tile
    mutable OpenThreads::Mutex _computing; ///< held while the graph runs; taken before _mutex
    mutable OpenThreads::Mutex _mutex;     ///< of _latest, _changes, and of writing _inputs
    TileValues _latest;
    mutable Changes _changes;
    mutable std::set<unsigned> _unfinished; ///< contexts of stopped updates; guarded by _computing
    osg::ref_ptr<HeightTexture> _ownPosts;  ///< of setHeights()

    osg::ref_ptr<TileInputs> _inputs; ///< what the nodes are for
    osg::ref_ptr<TileSurface> _surface;
    osg::ref_ptr<Node> _heights; ///< writes the surface's; null where they stay
    osg::ref_ptr<SkyTableNode> _table;
    osg::ref_ptr<Method> _method;
    WorkGraph::Nodes _transport;
    osg::ref_ptr<Node> _probe;        ///< null where there are no probes
    osg::ref_ptr<Node> _objectFactor; ///< null where there are no objects
    /// What objects send, of each volume; none where nothing bounces.
    std::vector<osg::ref_ptr<ObjectRadiosityNode>> _objectRadiosities;
    osg::ref_ptr<Resource> _shading, _glossLight, _edges, _factor;
    osg::ref_ptr<Resource> _direct;               ///< light; the shading where there are no bounces
    std::vector<osg::ref_ptr<Resource>> _bounces; ///< light of each
    mutable std::set<unsigned>
        _factorContexts; ///< that have it as it is; guarded by _mutex, as the next
    unsigned _objectsRevision = 0;
    mutable WorkGraph _graph;
    Status _declared = Nothing{};
    bool _resting = false; ///< there are no nodes, and there is no surface

    unsigned _lightChanges = 0;
    const unsigned _turn; ///< so that tiles do not all bounce light in the same update
};

} // namespace osgTerrainLight
