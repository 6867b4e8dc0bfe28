#pragma once

#include "Options.h"
#include "core/Result.h"
#include "io/DemReader.h"
#include "lighting/TileLight.h"
#include "lighting/TileWindows.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

/// The terrain that a run lights, and what that sees.
namespace osgTerrainLight::tool
{

/// INPUT, of any size, with what surrounds it.
class Terrain
{
public:
    /// info: of the part that is lit. progress: of coarse levels that are made, 0 … 1.
    static Result<std::unique_ptr<Terrain>> open(const RasterOptions& options, const DemInfo& info,
                                                 std::function<void(double)> progress);

    /// Whether a part of INPUT sees more than itself.
    static bool isSeen(const RasterOptions& options, const DemInfo& info);

    /// A tile of what is lit, with the terrain around it.
    Result<std::shared_ptr<const TileWindows>> read(const PixelWindow& pixels);

    /// What was assumed of the input and found in it, one sentence each.
    const std::vector<std::string>& notes() const { return _notes; }

private:
    Terrain(const RasterOptions& options, const DemInfo& info) : _options(options), _info(info) {}

    const RasterOptions& _options;
    DemInfo _info;
    std::vector<std::string> _notes;
};

/// A tile by itself: all that there is.
std::shared_ptr<const TileWindows> aloneOf(DemTile tile);

/// The light of a tile with all that it sees.
osg::ref_ptr<TileLight> newLight(const std::shared_ptr<const TileWindows>& terrain,
                                 const LightingSettings& settings, const SkyLight& sky,
                                 SkyViewDefinition definition);

} // namespace osgTerrainLight::tool
