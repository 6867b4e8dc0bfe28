#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Light from all around, at infinity, as a picture of all directions, and the sun that was found
/// in it. It does not change once it is shared.
struct OSGTERRAINLIGHT_EXPORT Environment
{
    /// Texels around and from nadir to zenith, of equal angles: 1 … 16384 and 1 … 8192.
    int columns = 0;
    int rows = 0;
    /// Radiance, linear, of the primaries of Rec. 709 [W m⁻² sr⁻¹ or relative], columns · rows,
    /// 0 … 1e30, without the sun below. Column 0 begins in the east, columns run
    /// counter-clockwise seen from above (east, north, west, south); row 0 touches the nadir, the
    /// last row the zenith: the layout of reference::Illumination::importance.
    std::vector<Rgb> radiance;
    const Rgb& at(int column, int row) const
    {
        return radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(column)];
    }
    /// Of where it came from, for messages.
    std::string name;

    /// A bright, compact source, taken out of `radiance`, so that it gets a shadow of its own. Its
    /// place is as in SkyLight. hasSun false: none was found.
    bool hasSun = false;
    double sunAzimuth = 0.0;
    double sunElevation = 0.0;
    double sunAngularRadius = 0.2666;
    Rgb sunIrradiance = {0.0f, 0.0f, 0.0f};

    /// `radiance` in 16 coefficients, as in SkyLight::skyHarmonics.
    std::vector<Rgb> harmonics;
};

/// An environment from a picture of the layout above. A sun is looked for and taken out;
/// docs/methods/environments.md says when. Null where sizes or values are out of range; problem
/// then says what was found and what was needed.
OSGTERRAINLIGHT_EXPORT std::shared_ptr<const Environment>
createEnvironment(int columns, int rows, std::vector<Rgb> radiance, std::string& problem);

/// An environment from a file: OpenEXR, latitude-longitude or cube, and every other format that
/// OpenSceneGraph's plugins read as a latitude-longitude picture (.hdr); docs/CONVENTIONS.md has
/// the orientation. Null where it cannot be read; problem then names the file, what was found and
/// what was needed.
OSGTERRAINLIGHT_EXPORT std::shared_ptr<const Environment> readEnvironment(const std::string& path,
                                                                          std::string& problem);

} // namespace osgTerrainLight
