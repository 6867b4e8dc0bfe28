#pragma once

#include "fields/ObjectLamps.h"
#include "gpu/Resource.h"

#include <glm/glm.hpp>

#include <osg/ref_ptr>

#include <vector>

namespace osgTerrainLight
{

/// A volume of distances to objects on or beside a tile, and the ground of the tile that they may
/// change the light of. Frame: metres east and north of post (0, 0), above the tile's heightOrigin,
/// as the tile is drawn.
struct TileObject
{
    /// Between columns and rows as they are drawn [m]: where rows are those of a map in degrees,
    /// columns of all of them are drawn as far apart as those of one.
    glm::dvec2 spacing{1.0};
    osg::ref_ptr<Resource> volume;  ///< ObjectVolumeNode::volume()
    osg::ref_ptr<Resource> albedo;  ///< ObjectVolumeNode::albedo()
    std::vector<ObjectLamp> lamps;  ///< in the frame of the volume
    glm::dvec3 corner{0.0};         ///< of the volume
    glm::ivec3 voxels{0};           ///< along its axes
    double voxel = 1.0;             ///< [m]
    glm::dvec3 low{0.0}, high{0.0}; ///< of what is in it
    glm::dvec2 first{0.0};          ///< centre of the south-western texel of the factor
    double pitch = 1.0;             ///< between its texels [m]
    glm::ivec2 texels{0};           ///< of the factor
    int row = 0;                    ///< of the factor's texture that it begins in

    bool operator==(const TileObject& other) const
    {
        return spacing == other.spacing && volume == other.volume && albedo == other.albedo &&
               lamps == other.lamps && corner == other.corner && voxels == other.voxels &&
               voxel == other.voxel && low == other.low && high == other.high &&
               first == other.first && pitch == other.pitch && texels == other.texels &&
               row == other.row;
    }
};
using TileObjects = std::vector<TileObject>;

} // namespace osgTerrainLight
