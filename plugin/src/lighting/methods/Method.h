#pragma once

#include "core/SettingRow.h"
#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"
#include "lighting/TileSurface.h"
#include "lighting/nodes/HorizonNode.h"
#include "lighting/nodes/SkyTableNode.h"

#include <osg/Referenced>

#include <vector>

namespace osgTerrainLight
{

/// A way to compute direct light and bounces: declares the nodes of both. A method lives as long as
/// its surface, its azimuths and its quality; what depends on the other settings is declared anew
/// where they change.
class Method : public osg::Referenced
{
public:
    /// The nodes of the kinds of light, which are made once.
    virtual WorkGraph::Nodes sources() const = 0;
    /// Of the kinds of light, where the method has such.
    virtual std::vector<HorizonNode*> horizons() const { return {}; }
    /// Null where the method has none.
    virtual Resource* skyView() const { return nullptr; }
    /// Horizons all around, elevation codes, layer k towards 2πk/m from east; null where the method
    /// has none.
    virtual Resource* skyHorizon() const { return nullptr; }
    virtual bool readsSkyTable() const = 0;
    /// Whether the light of its bounces may lie below 0, as that of cut series does.
    virtual bool mayUndershoot() const = 0;

    /// Adds nodes that write direct light (RGBA16F, a texel per post), with which `bounces` bounces
    /// are to follow. light of gloss: written where ground is glossy.
    virtual void declareDirect(WorkGraph::Nodes& nodes, Resource* direct, int bounces,
                               Resource* lightOfGloss) = 0;
    /// Adds what writes the edges of shadows for host shaders, where the method knows them.
    virtual void declareEdges(WorkGraph::Nodes&, Resource*) {}
    /// Adds nodes of the next bounce. Returns what they write, RGBA16F, a texel per post: rgb =
    /// irradiance / π, a = 1; 0 where void.
    virtual osg::ref_ptr<Resource> declareBounce(WorkGraph::Nodes& nodes) = 0;

    /// Settings or light have changed, which makes this stale.
    virtual void follow(Invalidation) {}

protected:
    ~Method() override = default;
};

} // namespace osgTerrainLight
