#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/HorizonMap.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"
#include "core/Result.h"
#include "core/SkyRadiance.h"
#include "gpu/GpuPass.h"
#include "gpu/HeightTexture.h"
#include "gpu/PassChain.h"
#include "lighting/nodes/AreaLights.h"
#include "lighting/nodes/Bounces.h"
#include "lighting/nodes/GlossPass.h"
#include "lighting/nodes/HeightPyramid.h"
#include "lighting/nodes/HorizonPass.h"
#include "lighting/nodes/LegendreDirectPass.h"
#include "lighting/nodes/ProbePass.h"
#include "lighting/nodes/SkyTablePass.h"

#include <osg/Referenced>
#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <OpenThreads/Mutex>

#include <array>
#include <functional>
#include <map>
#include <vector>

namespace osgTerrainLight
{

/// The three sky-view factors in use (docs/CONVENTIONS.md).
enum class SkyViewDefinition
{
    Surface,    ///< cosine to the surface normal: what lights the terrain
    Horizontal, ///< cosine to the zenith
    SolidAngle  ///< fraction of the upper hemisphere's solid angle
};

/// One tile's pass chain and textures: heights and light in, shading texture out.
///
/// Setters may be called from any thread; update() and the read functions need the current context
/// of their state. Stages: heights (they have been set), horizon (a sky or a bounce is on), table
/// (a sky in harmonics is on), sky (a sky is on), sun (a sun is on and not wholly below the
/// horizontal), key (a key light is above the horizontal and not black), pyramid (of heights:
/// bounces are on), shade, gloss (the ground is glossy, and there is light), bounce (bounces are
/// on, and there is what they would bounce), indirect (bounces are not computed in every update:
/// adds those that were), probe (there are probes). With a BounceMethod other than Slices, horizon,
/// table, sky, sun, key and gloss do not exist: where there is any light, shade takes it from the
/// pyramid.
class OSGTERRAINLIGHT_EXPORT TileLight : public osg::Referenced
{
public:
    TileLight(const DemTile& tile, const LightingSettings& settings, const SkyLight& sky,
              SkyViewDefinition definition = SkyViewDefinition::Surface);

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

    /// Places where light from all around is computed. Each has maps of its own. Whether that is a
    /// change.
    bool setProbes(std::vector<ProbePlace> probes);

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

    /// Runs the stages whose inputs have changed in this context. mayContinue is asked between two
    /// of them: where it returns false the tile stays dirty, and the next update goes on. With a
    /// bounceInterval above 1 the tile may be dirty afterwards: the next update, if nothing changes
    /// before, mends that.
    Status update(osg::State& state, const std::function<bool()>& mayContinue = {});
    bool isDirty(unsigned contextID) const;

    /// RGBA16F, a texel per post, row 0 south: rgb = irradiance / pi, a = visible fraction of the
    /// sun (1 where the sun is off). Void posts: all 0.
    osg::Texture2D* shading() const { return _shading; }

    /// RGBA16F, a texel per post, GlossPass::layers layers: light sent by gloss (ShadingTexture.h),
    /// without that of the sun. Null where nothing is glossy or there is no light.
    osg::ref_ptr<osg::Texture2DArray> glossLight() const;

    /// Read-back, all in tile order (row 0 south). Call after update().
    /// Of glossLight(), layer after layer, four values per post.
    std::vector<float> readGlossLight(osg::State& state) const;
    Raster<osg::Vec4f> readShading(osg::State& state) const;
    Raster<float>
    readSkyView(osg::State& state) const; ///< NaN where void; as readHorizons, the sky uniform
    /// Precondition: a sky is on, and the method is Slices.
    HorizonMap readHorizons(osg::State& state) const;
    /// Of the last bounce alone: rgb = irradiance / π, a = 1; 0 where void. Precondition: bounces
    /// are on.
    Raster<osg::Vec4f> readLastBounce(osg::State& state) const;
    unsigned readDroppedVertices(osg::State& state) const; ///< of all sweeps

    void setTimed(bool timed) { _chain.setTimed(timed); }
    std::vector<StageCost> costs() const;
    /// Bytes of all textures, heights and shading included.
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state = nullptr) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~TileLight() override = default;

    bool skyNeeded() const { return _sky.skyEnabled; }
    bool tableNeeded() const
    {
        return (bySlices() || !_probes.empty()) && skyNeeded() && skyHasTable(_sky);
    }
    bool sunNeeded() const { return needsSun(_sky); }
    bool keyNeeded() const { return keyAzimuths(_sky, _settings) > 0; }
    AreaLights areaLights() const;
    /// The light with the sun's irradiance at the ground.
    SkyLight lightAtGround() const;
    /// The same with every sky but the uniform one in harmonics, for what knows no other.
    SkyLight lightInHarmonics() const;
    bool bounceNeeded() const;
    bool bySlices() const { return _settings.bounceMethod == BounceMethod::Slices; }
    bool horizonNeeded() const { return bySlices() && (skyNeeded() || bounceNeeded()); }
    /// Whether direct light is the scheme's of Nowrouzezahrai and Snyder.
    bool legendreNeeded() const;
    int frame() const; ///< of the heights: void posts on every side
    void createHeights();
    bool glossNeeded() const
    {
        return bySlices() && (_gloss.empty() ? _settings.gloss > 0.0 : _hasGloss) &&
               (skyNeeded() || sunNeeded() || keyNeeded());
    }
    void followGloss();
    void forgetGloss();
    void createGlossPass();
    Raster<osg::Vec4f> coloursOf(const std::vector<float>& values) const;
    void setPosts(osg::Texture2D* posts);
    Status runHeights(osg::State& state);
    Status runHorizon(osg::State& state);
    Status runTable(osg::State& state);
    Status runSky(osg::State& state);
    Status runSun(osg::State& state);
    Status runKey(osg::State& state);
    Status runShade(osg::State& state);
    Status runGloss(osg::State& state);
    Status runPyramid(osg::State& state);
    Status runBounce(osg::State& state);
    Status runProbe(osg::State& state);
    /// Towards the left, the centre and the right of the sun's disc.
    std::array<MapDirection, 3> sunDirections() const;
    void createAlbedo();
    /// Gloss is computed with the bounces, so that these are then computed in every update.
    bool sumNeeded() const
    {
        return bounceNeeded() && _settings.bounceInterval > 1 && !glossNeeded();
    }
    PassChain::Turn bounceTurn(unsigned contextID);

    mutable OpenThreads::Mutex _mutex;
    DemTile _tile;
    LightingSettings _settings;
    SkyLight _sky;
    SkyViewDefinition _definition;

    mutable PassChain _chain;
    PassChain::Value _heightsValue, _settingsValue, _harmonicsValue, _sunPlaceValue, _keyPlaceValue,
        _lightValue, _bounceValue, _probeValue;
    PassChain::Value _shadeOutput;

    /// When bounces are computed in a context, where that is not in every update.
    struct Pace
    {
        unsigned updates = 0; ///< that changed light
        bool due = false;     ///< more than light has changed, or light stands still
        bool waits = false;   ///< the bounces are those of an earlier light
    };
    std::map<unsigned, Pace> _paces;
    const unsigned _turn; ///< so that tiles do not all compute theirs in the same update

    osg::ref_ptr<osg::Texture2D> _heights;
    osg::ref_ptr<osg::Texture2D> _posts; ///< where heights come from; null: from _tile, for good
    osg::ref_ptr<HeightTexture> _ownHeights; ///< of setHeights()
    osg::ref_ptr<GpuPass> _framePass;
    osg::ref_ptr<osg::Texture2D> _eastSpacings;
    osg::ref_ptr<HorizonPass> _horizon;
    osg::ref_ptr<HorizonPass> _sun;
    osg::ref_ptr<HorizonPass> _key;
    osg::ref_ptr<SkyTablePass> _table;
    osg::ref_ptr<osg::Texture2D> _skyView; ///< or its light, where it has a table
    osg::ref_ptr<osg::Texture2D> _shading;
    osg::ref_ptr<GpuPass> _skyPass;
    osg::ref_ptr<GpuPass> _shadePass;
    osg::ref_ptr<HeightPyramid> _pyramid;     ///< where the method is not Slices
    osg::ref_ptr<LegendreDirectPass> _direct; ///< ditto
    osg::ref_ptr<Bounces> _bounce;
    osg::ref_ptr<LightSum> _sum; ///< of the bounces, where they are not computed in every update
    Raster<Rgb> _albedo;         ///< empty: the settings'
    bool _albedoIsBlack = false;
    osg::ref_ptr<osg::Texture2D> _albedoTexture;
    Raster<std::array<float, 2>> _gloss; ///< empty: the settings'
    bool _hasGloss = false;              ///< some of it is not 0
    osg::ref_ptr<osg::Texture2D> _materialTexture;
    osg::ref_ptr<osg::Texture2DArray> _glossLight;
    osg::ref_ptr<GlossPass> _glossPass;
    std::vector<ProbePlace> _probes;
    osg::ref_ptr<ProbePass> _probePass;
    osg::ref_ptr<osg::Texture2D> _nothing; ///< one texel, stands for the texture of an absent stage
};

} // namespace osgTerrainLight
