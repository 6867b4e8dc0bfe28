#include "scene/ProbeList.h"

#include <algorithm>

namespace osgTerrainLight
{

namespace
{
ProbePlace placeOf(const LightProbe& probe, const LitTile& lit)
{
    const DemTile& tile = lit.lighting().tile();
    ProbePlace place;
    place.row = lit.margin().south +
                std::clamp(probe.getNorth() / tile.northSpacing, 0.0, lit.drawnHeight() - 1.0);
    const double spacing = tile.eastSpacing(static_cast<int>(place.row + 0.5));
    place.column =
        lit.margin().west + std::clamp(probe.getEast() / spacing, 0.0, lit.drawnWidth() - 1.0);
    place.height = probe.getHeight();
    place.aboveGround = probe.isAboveGround();
    place.exponent = probe.getExponent();
    place.diffuse = probe.getDiffuseMap();
    place.glossy = probe.getGlossyMap();
    return place;
}
} // namespace

bool ProbeList::add(LightProbe& probe, const TileHandle& tile,
                    const std::shared_ptr<ContextSet>& written)
{
    if (std::any_of(_probes.begin(), _probes.end(),
                    [&](const Entry& entry) { return entry.probe == &probe; }))
        return false;
    _probes.push_back({&probe, tile, written, 0, nullptr});
    _changed = true;
    return true;
}

void ProbeList::remove(const LightProbe* probe)
{
    const auto last = std::remove_if(_probes.begin(), _probes.end(),
                                     [&](const Entry& entry) { return entry.probe == probe; });
    _changed = _changed || last != _probes.end();
    _probes.erase(last, _probes.end());
}

bool ProbeList::follow(const TileRegistry& registry)
{
    for (Entry& entry : _probes)
    {
        const SceneTile* tile = registry.find(entry.tile);
        const osg::ref_ptr<LitTile> lit = tile ? tile->lit : nullptr;
        _changed = _changed || lit != entry.lit || entry.revision != entry.probe->getRevision();
        entry.lit = lit;
        entry.revision = entry.probe->getRevision();
    }
    if (!_changed)
        return false;
    _changed = false;
    for (auto& [tile, places] : _places)
        places.clear();
    for (const Entry& entry : _probes)
        if (entry.lit)
        {
            ProbePlace place = placeOf(*entry.probe, *entry.lit);
            place.written = entry.written;
            _places[entry.lit].push_back(std::move(place));
        }
    for (auto i = _places.begin(); i != _places.end();)
    {
        i->first->lighting().setProbes(i->second);
        i = i->second.empty() ? _places.erase(i) : std::next(i);
    }
    return true;
}

} // namespace osgTerrainLight
