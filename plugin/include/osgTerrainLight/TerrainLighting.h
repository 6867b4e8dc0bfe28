#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/ShadingTexture.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>
#include <osgTerrainLight/TileHandle.h>

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
    /// A copy has the same light, place, time, settings, budget, texture units, gloss layer and
    /// switches, and the children that copyop gives it. Tiles that it finds below get light of its
    /// own. Tiles of addTile(), probes and counts are not copied, nor, as of any node, event
    /// callbacks.
    TerrainLighting(const TerrainLighting& other,
                    const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, TerrainLighting);

    /// Values outside the ranges of ParameterRange are refused with one warning.
    void setSkyLight(const SkyLight& sky);
    const SkyLight& getSkyLight() const;

    /// Where the terrain lies on Earth; setTime() and the keys that run the day need it. Refused,
    /// with a warning, where a value is out of its range.
    void setPlace(const EarthPlace& place);
    const std::optional<EarthPlace>& getPlace() const;
    /// Sets the sun's azimuth and elevation by time. Nothing, with a warning, where no place is
    /// set.
    void setTime(UtcTime time);
    /// Of the sun as it stands; none once setSkyLight() has moved it.
    const std::optional<UtcTime>& getTime() const;

    /// Exposure takes effect in the default program only.
    void setSettings(const LightingSettings& settings);
    const LightingSettings& getSettings() const;

    /// Off: the terrain is drawn as if this node were a plain group. Default on.
    void setLightEnabled(bool enabled);
    bool getLightEnabled() const;

    /// Time per frame and graphics context in which tiles are computed [ms]. The tile that is
    /// largest on the screen comes first. A frame exceeds its time by one step of a tile's work at
    /// most (a horizon map, a bounce), and does one at least; on hardware, times of earlier steps
    /// tell what to expect of the next. 0: everything in one frame. A tile that waits is drawn as
    /// if this node were a plain group, or with its light as it was. Default 50.
    void setTimeBudget(double milliseconds);
    double getTimeBudget() const;

    /// Of the shading texture, 0 … 31. Where the ground is glossy, that of gloss is refused with a
    /// warning. Tiles that are lit already keep theirs.
    void setTextureUnit(unsigned unit);
    unsigned getTextureUnit() const;
    /// Of light sent by gloss, 0 … 31. Default ShadingTexture::glossUnit. Refused, with a warning,
    /// where some of the ground may be glossy already.
    void setGlossUnit(unsigned unit);
    unsigned getGlossUnit() const;

    /// The colour layer of terrain tiles, 1 … 4, that holds gloss per texel instead of the
    /// settings': a picture over the tile's whole extent, its values linear, bytes too; red =
    /// gloss, 0 … 1, green = exponent / 64. Tiles that have no such layer keep the settings'.
    /// −1, the default: no layer. Others are refused with a warning.
    void setGlossLayer(int layer);
    int getGlossLayer() const;

    /// Whether tiles below that have no shaders, neither of their own nor from above, get a program
    /// that multiplies their colour layer 0 (white where there is none), exposes and encodes to
    /// sRGB. Default true. Tiles that are lit already stay as they are.
    void setDefaultProgramEnabled(bool enabled);
    bool getDefaultProgramEnabled() const;

    /// Lights a host's own terrain, drawn below this node with `stateSet`. program: whether the
    /// default program is put on it as well; else the host's shaders read the texture. name: the
    /// handle that it gets, of a level, x and y; by default a number. No handle, with a warning,
    /// where the tile has no post, the StateSet is another tile's or the name is taken. The
    /// StateSet is made osg::Object::DYNAMIC; one that was drawn in the last frame must have been
    /// so already.
    TileHandle addTile(const DemTile& tile, osg::StateSet* stateSet,
                       const ShadingCoordinates& coordinates = {}, bool program = false,
                       const TileHandle& name = {});
    /// Lights terrain whose heights change, drawn below this node; anew when they have. Where a
    /// program was put on its StateSet, that one draws it.
    TileHandle addTile(DynamicTerrain* terrain, const TileHandle& name = {});
    /// Leaves the StateSet as addTile() found it, a few updates later: frames that are still being
    /// drawn use it. False where the tile was not added.
    bool removeTile(const TileHandle& tile);

    // Of tiles that addTile() was given: a value per post, row 0 south. False, with a warning,
    // where the tile was not added, there are not as many values as posts, or some are beyond their
    // range.

    /// All heights anew [m above the heightOrigin of its DemTile]; not finite or beyond ±1e6 m:
    /// void. Not of a DynamicTerrain, which has a callback.
    bool setTileHeights(const TileHandle& tile, const std::vector<float>& heights);
    /// 0 … 1 per channel, instead of the settings'; empty: theirs again.
    bool setTileAlbedo(const TileHandle& tile, const std::vector<Rgb>& albedo);
    /// Gloss, 0 … 1, and exponent, 1 … 64, instead of the settings'; empty: theirs again.
    bool setTileGloss(const TileHandle& tile, const std::vector<std::array<float, 2>>& gloss);

    /// The handle of a terrain tile that is or will be found below: by its TileID, that is
    /// TileHandle::at(level, x, y), unless another tile has that; else by a number, the same as
    /// long as the terrain tile lives. None for null.
    TileHandle getTileHandle(osgTerrain::TerrainTile* tile);
    /// Of all tiles that have been added or found.
    std::vector<TileHandle> getTileHandles() const;
    TileState getTileState(const TileHandle& tile) const;

    /// Computes the light at a probe's place on a tile, which may not be there yet, and may go and
    /// come again. False, with a warning, where the handle names none, or the probe has been added.
    bool addProbe(LightProbe* probe, const TileHandle& tile);
    /// Its maps keep the light that they have.
    void removeProbe(LightProbe* probe);

    /// Of those that can be lit.
    std::size_t getTileCount() const;

    /// Runs of each stage (heights that change, horizon, table, sky, key, sun, pyramid, shade,
    /// gloss, sent, bounce, compose, probe) since creation, all tiles and contexts; of sent, bounce
    /// and gloss one per bounce; stages that no tile has are left out. A still scene adds none.
    std::map<std::string, unsigned> getDispatchCounts() const;
    unsigned getDispatchCount() const;

    /// Nodes that were looked at to find tiles, since creation. A still scene adds none.
    unsigned getVisitCount() const;

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
    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

} // namespace osgTerrainLight
