#pragma once

#include "scene/FormerLight.h"
#include "scene/LitTile.h"
#include "scene/ShadingBinding.h"
#include "scene/TileNeighbours.h"
#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/TileHandle.h>

#include <osg/Image>
#include <osg/PagedLOD>
#include <osgTerrain/Terrain>
#include <osgTerrain/TerrainTile>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// What decides whether a terrain tile must be read again.
struct TileVersion
{
    const osgTerrain::Layer* layer = nullptr;
    unsigned modified = 0;
    float verticalScale = 1.0f;
    osg::Matrixd toScene;

    bool operator==(const TileVersion& other) const
    {
        return layer == other.layer && modified == other.modified &&
               verticalScale == other.verticalScale && toScene == other.toScene;
    }
};

/// A picture in a layer, as it was when it was read.
struct PictureVersion
{
    osg::ref_ptr<const osg::Image> image;
    unsigned modified = 0;

    /// Whether the picture is another one, or has changed; it is then noted.
    bool follow(const osg::Image* now)
    {
        const unsigned count = now ? now->getModifiedCount() : 0;
        if (image == now && modified == count)
            return false;
        image = now;
        modified = count;
        return true;
    }
};

/// What a host has given for a tile whose place on the map is known.
struct HostGround
{
    PlacedGround ground; ///< with the heights that it has now
    osg::ref_ptr<osg::StateSet> stateSet;
    ShadingCoordinates coordinates;
    bool program = false;
    std::vector<Rgb> albedo; ///< per post of the DEM; empty: that of the settings
    std::vector<std::array<float, 2>> gloss;
};

/// A tile of a TerrainLighting: its light, where it is bound, and what it is followed from.
struct SceneTile
{
    TileHandle handle;
    osg::ref_ptr<LitTile> lit; ///< null: a terrain tile that cannot be lit, or not yet
    std::shared_ptr<ShadingBinding> binding;
    std::string problem;   ///< why it cannot be lit
    bool hasGloss = false; ///< per post, of its host
    /// Of the post (0, 0) that is drawn, where its height with its DEM's heightOrigin is 0, in the
    /// frame of TerrainLighting [m]; none where that is not known, or the tile's axes are not its
    /// axes.
    std::optional<osg::Vec3d> corner;
    osg::Vec2d spacing; ///< between columns and rows as they are drawn [m], where corner is known
    bool saidObjects = false; ///< that their texture unit is taken

    std::unique_ptr<HostGround> host; ///< null: the tile was found, or its place is not known
    // Of a DynamicTerrain.
    osg::ref_ptr<DynamicTerrain> dynamic;
    osg::ref_ptr<osg::Texture2D> heights; ///< those that it has; null: still the first ones
    unsigned heightRevision = 0;

    // Of a terrain tile that was found.
    osg::ref_ptr<osgTerrain::TerrainTile> terrain; ///< null where a host added the tile
    TileVersion version;
    PictureVersion colours, glossPicture; ///< that albedo and gloss were read from
    bool ownStateSet = false;             ///< the terrain tile had none before
    /// Of a StateSet that has been made DYNAMIC and is bound at the next update.
    std::optional<osg::Object::DataVariance> theirVariance;
    bool isNew = false;        ///< it waits for its turn to be read and bound
    bool waitsForNext = false; ///< it is not looked at before the next update
    bool foundTaken = false;   ///< another TerrainLighting had it at the last look
    bool byTexCoord = false;
    bool withoutGeometry = false; ///< when it was bound: its technique makes it late
    std::optional<FormerLight> former;
    BorderParts borders;     ///< of the former light, where that is of a tile above
    bool lacksAbove = false; ///< the light of the tile above, which its borders wait for
    // Null where there is none.
    osg::ref_ptr<osg::PagedLOD> finer;   ///< that has it, and finer ones in its place
    osg::ref_ptr<osg::PagedLOD> coarser; ///< that has it among the finer ones
    std::array<osg::Vec3d, 3> corners;   ///< in its own frame, when it was bound
};

} // namespace osgTerrainLight
