#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/ShadingTexture.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>

#include <osg/Group>
#include <osg/StateSet>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrain
{
class TerrainTile;
}

namespace osgTerrainLight
{

class DynamicTerrain;
class LightProbe;

/// Lights the terrain below it: every osgTerrain::TerrainTile, those that are added or paged in
/// later too, and what addTile() is given.
///
/// Heights are metres above the horizontal plane of the tile; x is east and y north (geocentric
/// tiles: of the place). Light is computed in the draw traversal, before the first tile is drawn,
/// and only where sun, sky, settings or heights have changed. Needs OpenGL 4.3; in an older context
/// one warning is given and the terrain is drawn as if this node were a plain group.
///
/// Methods are called where the scene graph may be changed: in update and event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT TerrainLighting : public osg::Group
{
public:
    TerrainLighting();
    TerrainLighting(const TerrainLighting& other,
                    const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, TerrainLighting)

        /// Values outside the ranges of ParameterRange are refused with one warning.
        void setSkyLight(const SkyLight& sky);
    const SkyLight& getSkyLight() const { return _sky; }

    /// Where the terrain lies on Earth; setTime() and the keys that run the day need it. Refused,
    /// with a warning, where a value is out of its range.
    void setPlace(const EarthPlace& place);
    const std::optional<EarthPlace>& getPlace() const { return _place; }
    /// Sets the sun's azimuth and elevation by time. Nothing, with a warning, where no place is
    /// set.
    void setTime(UtcTime time);
    /// Of the sun as it stands; none once setSkyLight() has moved it.
    const std::optional<UtcTime>& getTime() const { return _time; }

    /// Exposure takes effect in the default program only.
    void setSettings(const LightingSettings& settings);
    const LightingSettings& getSettings() const { return _settings; }

    /// Off: the terrain is drawn as if this node were a plain group. Default on.
    void setLightEnabled(bool enabled);
    bool getLightEnabled() const { return _lightEnabled; }

    /// Time per frame and graphics context in which tiles are computed [ms]; at least one tile is.
    /// 0: all of them in one frame. A tile that waits is drawn as if this node were a plain group,
    /// or with its light as it was. Default 50.
    void setTimeBudget(double milliseconds);
    double getTimeBudget() const;

    /// Of the shading texture, 0 … 31. Where the ground is glossy, ShadingTexture::glossUnit is
    /// refused with a warning. Tiles that are lit already keep theirs.
    void setTextureUnit(unsigned unit);
    unsigned getTextureUnit() const { return _textureUnit; }

    /// The colour layer of terrain tiles, 1 … 4, that holds gloss per texel instead of the
    /// settings': a picture over the tile's whole extent, its values linear, bytes too; red =
    /// gloss, 0 … 1, green = exponent / 64. Tiles that have no such layer keep the settings'.
    /// −1, the default: no layer. Others are refused with a warning.
    void setGlossLayer(int layer);
    int getGlossLayer() const { return _glossLayer; }

    /// Whether tiles below that have no shaders, neither of their own nor from above, get a program
    /// that multiplies their colour layer 0 (white where there is none), exposes and encodes to
    /// sRGB. Default true. Tiles that are lit already stay as they are.
    void setDefaultProgramEnabled(bool enabled) { _defaultProgramEnabled = enabled; }
    bool getDefaultProgramEnabled() const { return _defaultProgramEnabled; }

    /// Lights a host's own terrain, drawn below this node with `stateSet`. program: whether the
    /// default program is put on it as well; else the host's shaders read the texture. False, with
    /// a warning, where the tile has no post or the StateSet is taken. The StateSet is made
    /// osg::Object::DYNAMIC; one that was drawn in the last frame must have been so already.
    bool addTile(const DemTile& tile, osg::StateSet* stateSet,
                 const ShadingCoordinates& coordinates = {}, bool program = false);
    /// Lights terrain whose heights change, drawn below this node; anew when they have. Its
    /// StateSet is what removeTile() takes. Where a program was put on that, this one draws it.
    bool addTile(DynamicTerrain* terrain);
    /// Gloss, 0 … 1, and exponent, 1 … 64, per post of a tile that addTile() was given, row 0
    /// south, instead of the settings'; empty: theirs again. False, with a warning, where the
    /// StateSet is no tile's, or there are not as many values as posts or some beyond those ranges.
    bool setTileGloss(osg::StateSet* stateSet, const std::vector<std::array<float, 2>>& gloss);
    /// Leaves the StateSet as addTile() found it, a few updates later: frames that are still being
    /// drawn use it.
    void removeTile(osg::StateSet* stateSet);

    /// Computes the light at a probe's place on a tile: one that addTile() was given, by its
    /// StateSet, or one found below. It may not be there yet, and may go and come again. False,
    /// with a warning, where there is no probe or no tile, or the probe has been added.
    bool addProbe(LightProbe* probe, osg::StateSet* tile);
    bool addProbe(LightProbe* probe, osgTerrain::TerrainTile* tile);
    /// Its maps keep the light that they have.
    void removeProbe(LightProbe* probe);

    std::size_t getTileCount() const;

    /// Runs of each stage (heights that change, horizon, table, sky, sun, key, pyramid, shade,
    /// gloss, bounce, indirect, probe) since creation, all tiles and contexts. A still scene adds
    /// none.
    std::map<std::string, unsigned> getDispatchCounts() const;
    unsigned getDispatchCount() const;

    /// Why terrain is drawn unlit: the first tile's failure, else that of a context or the default
    /// program. Empty where nothing has failed; something may yet, until all is drawn.
    std::string getFailure() const;

    void traverse(osg::NodeVisitor& visitor) override;
    osg::BoundingSphere computeBound() const override;
    void releaseGLObjects(osg::State* state = nullptr) const override;
    void resizeGLObjectBuffers(unsigned size) override;

protected:
    ~TerrainLighting() override;

private:
    class Tiles;
    void applyUniforms();
    /// Whether some of the ground may be glossy.
    bool mayBeGlossy() const;
    /// After a change of that, or of settings.
    void followGloss();
    /// Empty where gloss may be switched on, else why not.
    std::string glossProblem() const;

    SkyLight _sky;
    std::optional<EarthPlace> _place;
    std::optional<UtcTime> _time;
    LightingSettings _settings;
    bool _lightEnabled = true;
    bool _defaultProgramEnabled = true;
    unsigned _textureUnit = ShadingTexture::defaultUnit;
    int _glossLayer = -1;
    bool _glossBound = false;   ///< `_uniforms` has a texture for tiles that send none
    bool _glossIgnored = false; ///< by the method, and that has been said
    std::unique_ptr<Tiles> _tiles;
    osg::ref_ptr<osg::StateSet> _uniforms; ///< on all below
};

} // namespace osgTerrainLight
