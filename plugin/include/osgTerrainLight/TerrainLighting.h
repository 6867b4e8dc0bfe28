#pragma once

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/ShadingTexture.h>
#include <osgTerrainLight/SkyLight.h>
#include <osgTerrainLight/SunPosition.h>
#include <osgTerrainLight/Surroundings.h>
#include <osgTerrainLight/TileHandle.h>

#include <osg/Group>
#include <osg/Matrixd>
#include <osg/StateSet>

#include <array>
#include <limits>
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
class PlacedObject;

/// The tiles of a TerrainLighting, and what its light costs.
struct LightingStatistics
{
    /// Tiles that have been found or added, and how many of them are lit in every graphics context
    /// that draws them, wait for their light, and draw unlit because of a failure.
    std::size_t tiles = 0, lit = 0, waiting = 0, failed = 0;
    /// Time that was spent on light in the last frame [ms]; of several graphics contexts the
    /// longest. It is measured on the CPU, or what the GPU is expected to take where that is more.
    /// 0 in a still scene.
    double milliseconds = 0.0;
    /// Size of the textures of all tiles' light on the GPU, with what their computation holds.
    std::size_t bytes = 0;
};

/// Lights the terrain below it: every osgTerrain::TerrainTile, also those that are added or paged
/// in later, and the terrain that addTile() is given.
///
/// Heights are metres above the horizontal plane of the tile; x is east and y is north (for a
/// geocentric tile, east and north at its place). The node computes light in the draw traversal,
/// before the first tile is drawn, and only where the sun, the sky, the settings or the heights
/// have changed. It needs OpenGL 4.3. In an older context it gives one warning, and the terrain is
/// drawn as if this node were a plain group.
///
/// Call all methods where the scene graph may be changed: in the update or event traversal, or
/// between frames.
class OSGTERRAINLIGHT_EXPORT TerrainLighting : public osg::Group
{
public:
    TerrainLighting();
    /// A copy has the same light, place, time, settings, budget, fade, texture units, gloss layer
    /// and switches, and the children that copyop gives it. Terrain tiles that are copied with it
    /// get light of their own. A terrain tile that stands below both lightings (SHALLOW_COPY) keeps
    /// the light of the original; the copy gives a warning, and lights the tile once the original
    /// has let it go. Tiles of addTile(), surroundings, probes, counts and event callbacks are not
    /// copied.
    TerrainLighting(const TerrainLighting& other,
                    const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Node(osgTerrainLight, TerrainLighting);

    /// Sets the light above the terrain. Values outside the ranges of ParameterRange are refused
    /// with one warning. What has no effect is taken with one warning: see problems().
    void setSkyLight(const SkyLight& sky);
    const SkyLight& getSkyLight() const;

    /// Sets where the terrain lies on Earth. setTime() and the keys that run the day need it. A
    /// value outside its range is refused with a warning.
    void setPlace(const EarthPlace& place);
    const std::optional<EarthPlace>& getPlace() const;
    /// Sets the sun's azimuth and elevation by time. Without a place it gives a warning and changes
    /// nothing.
    void setTime(UtcTime time);
    /// The time that setTime() has set. It is empty once setSkyLight() has moved the sun.
    const std::optional<UtcTime>& getTime() const;

    /// Sets how light is computed. Values are refused, or taken with a warning, as in
    /// setSkyLight(). The exposure has an effect in the default program only.
    void setSettings(const LightingSettings& settings);
    const LightingSettings& getSettings() const;

    /// Switches the light. While it is off, the terrain is drawn as if this node were a plain
    /// group. The default is on.
    void setLightEnabled(bool enabled);
    bool getLightEnabled() const;

    /// Sets the time that is spent on light per frame and graphics context [ms], 0 … 1e9. The
    /// default is 50; 0 computes everything in one frame. The tile that is largest on the screen
    /// comes first; one that is begun is ended before. Work is cut into pieces, of which a frame
    /// does as many as are expected to fit, and at least one. A frame exceeds its time by up to a
    /// fifth; by more only where it does a single piece: where shaders are compiled, and where the
    /// smallest piece takes longer. A tile that waits is drawn with the light that it has, or as if
    /// this node were a plain group.
    void setTimeBudget(double milliseconds);
    double getTimeBudget() const;

    /// Sets how long the light of an osgTerrain tile takes to fade in [s], 0 … 3600. The default is
    /// 0.5; 0 shows new light as soon as it is there. A tile that is lit anew keeps the light that
    /// it had, and a new tile below a lit one (by level, x and y of its TileID) has the light of
    /// that, until its own has been computed; then it fades. A placed tile of addTile() that is
    /// lit anew fades too. Other tiles are lit at once. The
    /// frames' simulation time counts, or their reference time where that stands still. Changes of
    /// the sun, the sky and the settings are shown at once. Other values are refused with a
    /// warning.
    void setFadeSeconds(double seconds);
    double getFadeSeconds() const;

    /// Sets the texture unit of the shading texture, 0 … 31; the default is
    /// ShadingTexture::defaultUnit. Tiles that are lit already keep theirs. Other units are refused
    /// with a warning, and so is the unit of gloss where some of the ground may be glossy.
    void setTextureUnit(unsigned unit);
    unsigned getTextureUnit() const;
    /// Sets the texture unit of the light sent by gloss, 0 … 31; the default is
    /// ShadingTexture::glossUnit. Other units are refused with a warning, and so is a unit that has
    /// shading or heights, and every change where some of the ground may be glossy already.
    void setGlossUnit(unsigned unit);
    unsigned getGlossUnit() const;

    /// Sets which colour layer of terrain tiles holds gloss per texel, 1 … 4; −1, the default, is
    /// none. Other numbers are refused with a warning. The layer is a picture over the tile's whole
    /// extent with linear values, also where they are bytes: red is the gloss, 0 … 1, and green is
    /// the exponent / 64. Tiles without such a layer have the gloss of the settings.
    void setGlossLayer(int layer);
    int getGlossLayer() const;

    /// Sets whether tiles without shaders, of their own or from above, get the default program. It
    /// multiplies the light by colour layer 0 (by white where there is none) and by the exposure,
    /// and encodes the result to sRGB. The default is true. Tiles that are lit already stay as they
    /// are.
    void setDefaultProgramEnabled(bool enabled);
    bool getDefaultProgramEnabled() const;

    /// Lights an application's own terrain, which is drawn below this node with `stateSet`.
    /// program: true puts the default program on the StateSet as well; else the application's
    /// shaders read the texture. name: the handle that the tile gets, with level, x and y; by
    /// default it gets a number. Returns no handle, with a warning, where DemTile::complaint()
    /// finds something wrong, the StateSet is another tile's, or another tile has the name. The
    /// StateSet becomes osg::Object::DYNAMIC. If it was drawn in the last frame, it must have been
    /// so before.
    ///
    /// Tiles whose place on the map is known light one another, as osgTerrain tiles do: a tile that
    /// touches another one of its map is lit by all tiles of that map, of any spacing, as they are
    /// added, edited and removed. Where several cover the same ground, as a parent and its children
    /// do, the one with the lit tile's own spacing counts, then coarser ones, then finer ones. The
    /// place is that of the DemTile: mapOriginX, mapOriginY, mapStepX and mapStepY, in units of its
    /// CRS. The step between posts says which tile is finer; heightOrigin and the spacings in
    /// metres count as ever. Tiles are of one map where their `crs` is the same text.
    ///
    /// Placed is a tile that has a CRS, or a name with a level, and whose map coordinates are not
    /// all left at DemTile's defaults, origin (0, 0) and steps of 1; steps are > 0. The defaults
    /// count where spacings are 1 m and the tile has a CRS, or x and y of its name are 0. All other
    /// tiles are lit alone. A placed tile is lit from the next update on, and several of them
    /// within the time budget.
    TileHandle addTile(const DemTile& tile, osg::StateSet* stateSet,
                       const ShadingCoordinates& coordinates = {}, bool program = false,
                       const TileHandle& name = {});
    /// Lights terrain whose heights change, which is drawn below this node, and lights it anew when
    /// they have changed. A program that was put on its StateSet draws it instead of the default
    /// one. Returns no handle, with a warning, as above, and where the heights are in a texture
    /// unit that the light needs.
    TileHandle addTile(DynamicTerrain* terrain, const TileHandle& name = {});
    /// Sets ground that is no tile, and that surrounds the placed tiles of its map: it counts where
    /// no tile is. It takes the place of surroundings that were set before. Returns false, with a
    /// warning, where Surroundings::complaint() finds something wrong; nothing changes then.
    bool setSurroundings(const Surroundings& surroundings);
    void removeSurroundings();
    /// Says that heights of the surroundings have changed in a rectangle, in units of their CRS,
    /// edges included. Tiles that may see it are lit again, one per update. highest: the greatest
    /// height in the rectangle, before or after the change [m above the vertical datum]; tiles
    /// above whose ground it does not rise, as seen from them, are left alone. By default all tiles
    /// of the map are lit again. Wrong values are refused with a warning.
    void surroundingsChanged(double west, double south, double east, double north,
                             double highest = std::numeric_limits<double>::infinity());
    /// Takes the light off a tile that addTile() was given. Its StateSet becomes what it was
    /// before, a few updates later, since frames that are still being drawn use it. Returns false
    /// where there is no such tile.
    bool removeTile(const TileHandle& tile);

    // The next three set a value per post of a tile that addTile() was given, row 0 in the south.
    // They return false, with a warning, where there is no such tile, the number of values is not
    // that of the posts, or a value is beyond its range.

    /// Sets all heights [m above the heightOrigin of the DemTile]. A height that is not finite or
    /// beyond ±1e6 m is void. A DynamicTerrain is refused: it has a callback.
    bool setTileHeights(const TileHandle& tile, const std::vector<float>& heights);
    /// Sets the albedo, 0 … 1 per channel, which takes the place of the settings' albedo. An empty
    /// vector gives that one back.
    bool setTileAlbedo(const TileHandle& tile, const std::vector<Rgb>& albedo);
    /// Sets gloss, 0 … 1, and exponent, 1 … 64, which take the place of the settings' values. An
    /// empty vector gives those back.
    bool setTileGloss(const TileHandle& tile, const std::vector<std::array<float, 2>>& gloss);

    /// The handle of a terrain tile that is found below, or will be. It is made from the TileID, as
    /// TileHandle::at(level, x, y), unless another tile has that name; then it is a number. It is
    /// the same as long as the terrain tile lives, and addTile() gives it to no other tile. Null
    /// has no handle.
    TileHandle getTileHandle(osgTerrain::TerrainTile* tile);
    /// The handles of all tiles that have been added or found.
    std::vector<TileHandle> getTileHandles() const;
    TileState getTileState(const TileHandle& tile) const;

    /// Computes the light at a probe's place on a tile. The tile need not be there yet, and may go
    /// and come again. Returns false, with a warning, where the handle names no tile, or the probe
    /// has been added already.
    bool addProbe(LightProbe* probe, const TileHandle& tile);
    /// Computes the light at the probe no longer. Its maps keep the light that they have.
    void removeProbe(LightProbe* probe);

    /// Takes an object into account that does not stand below this node: what it does to the light
    /// of the ground. Those below are found. Returns false, with a warning, where it was added
    /// before, or stands below.
    bool addObject(PlacedObject* object);
    /// Returns false where addObject() was not given it.
    bool removeObject(PlacedObject* object);
    /// The number of objects that change the light, found and added.
    std::size_t getObjectCount() const;

    /// The number of tiles that can be lit.
    std::size_t getTileCount() const;

    /// How often each stage has run since the node was created, for all tiles and contexts
    /// together. The stages are heights that change, horizon, table, sky, key, sun, pyramid, shade,
    /// gloss, sent, bounce, compose and probe; sent, bounce and gloss run once per bounce. A stage
    /// that has not run is listed with 0 or is left out. In a still scene nothing runs.
    std::map<std::string, unsigned> getDispatchCounts() const;
    /// The sum of getDispatchCounts().
    unsigned getDispatchCount() const;

    /// The tiles, and the time and memory of their light: for a display on the screen.
    LightingStatistics getStatistics() const;

    /// The number of nodes that were looked at to find tiles since this node was created. In a
    /// still scene none are.
    unsigned getVisitCount() const;

    /// Says why terrain is drawn unlit: the failure of the first tile that has one, else that of a
    /// context or of the default program. It is empty where nothing has failed so far.
    std::string getFailure() const;

    void traverse(osg::NodeVisitor& visitor) override;
    osg::BoundingSphere computeBound() const override;
    void releaseGLObjects(osg::State* state = nullptr) const override;
    void resizeGLObjectBuffers(unsigned size) override;

protected:
    ~TerrainLighting() override;

private:
    friend class PlacedObject;
    /// The update traversal has met an object below. toScene: from its frame to this node's.
    void see(PlacedObject& object, const osg::Matrixd& toScene);

    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

} // namespace osgTerrainLight
