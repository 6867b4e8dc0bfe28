#pragma once

#include <osgTerrainLight/DemTile.h>

#include <osg/Vec3d>

#include <memory>
#include <random>
#include <string>
#include <vector>

/// What moves the ground of this sample.
class Heights
{
public:
    virtual ~Heights() = default;

    osgTerrainLight::DemTile tile; ///< as it begins

    /// As DynamicTerrain::HeightCallback.
    virtual bool update(double time, int width, int height, float* heights) = 0;

    /// place: column and row. Only some ground can be dug in.
    virtual void dig(double, double) {}
};

/// "waves", "dunes" or "craters"; null for another name. dem: of craters; one is made up where it
/// is empty.
std::unique_ptr<Heights> createHeights(const std::string& name, int posts,
                                       const osgTerrainLight::DemTile& dem);
