#pragma once

#include "scene/TileRegistry.h"
#include <osgTerrainLight/LightProbe.h>

#include <map>
#include <memory>
#include <vector>

namespace osgTerrainLight
{

/// The light probes of a TerrainLighting, each on a tile that need not be there yet. In update
/// traversal.
class ProbeList
{
public:
    /// False where it is in the list. written: takes up the contexts in which its maps are there.
    bool add(LightProbe& probe, const TileHandle& tile,
             const std::shared_ptr<ContextSet>& written = {});
    void remove(const LightProbe* probe);
    bool empty() const { return _probes.empty(); }

    /// Hands on the places of probes that are new, have changed or are gone; whether there are any.
    bool follow(const TileRegistry& registry);

private:
    struct Entry
    {
        osg::ref_ptr<LightProbe> probe;
        TileHandle tile;
        std::shared_ptr<ContextSet> written;
        unsigned revision = 0;     ///< of the probe, when it was handed on
        osg::ref_ptr<LitTile> lit; ///< that it was handed on to
    };
    std::vector<Entry> _probes;
    std::map<osg::ref_ptr<LitTile>, std::vector<ProbePlace>> _places; ///< as handed on
    bool _changed = false;
};

} // namespace osgTerrainLight
