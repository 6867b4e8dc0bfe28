#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Light from all directions, at infinity, as a picture, and the sun that was found in it. An
/// environment does not change once it is shared.
struct OSGTERRAINLIGHT_EXPORT Environment
{
    /// Number of texels around, 1 … 16384, and from nadir to zenith, 1 … 8192. All texels have the
    /// same angles.
    int columns = 0;
    int rows = 0;
    /// Radiance of columns · rows texels, linear, with the primaries of Rec. 709 [W m⁻² sr⁻¹ or
    /// relative], 0 … 1e30. The sun is not in it. Column 0 begins in the east, and columns run
    /// counter-clockwise as seen from above (east, north, west, south). Row 0 touches the nadir,
    /// and the last row touches the zenith.
    std::vector<Rgb> radiance;
    const Rgb& at(int column, int row) const
    {
        return radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(column)];
    }
    /// Name of the source file, used in messages and in saved scenes. Empty where there is no file.
    std::string name;

    /// The sun: a bright, compact source that was taken out of `radiance`, so that it casts a sharp
    /// shadow. Its values are as in SkyLight. hasSun is false where none was found.
    bool hasSun = false;
    double sunAzimuth = 0.0;
    double sunElevation = 0.0;
    double sunAngularRadius = 0.2666;
    Rgb sunIrradiance = {0.0f, 0.0f, 0.0f};

    /// `radiance` in 16 coefficients, as in SkyLight::skyHarmonics.
    std::vector<Rgb> harmonics;
};

/// Makes an environment from a picture of the layout above. It looks for a sun and takes it out;
/// docs/methods/environments.md says when. Returns null where a size or value is out of its range;
/// problem then says what was found and what was needed.
OSGTERRAINLIGHT_EXPORT std::shared_ptr<const Environment>
createEnvironment(int columns, int rows, std::vector<Rgb> radiance, std::string& problem);

/// Reads an environment from a file: OpenEXR (latitude-longitude or cube), Radiance (.hdr), and
/// every other format that OpenSceneGraph's plugins read as a latitude-longitude picture.
/// docs/CONVENTIONS.md has the orientation. Returns null where the file cannot be read; problem
/// then names the file, what was found and what was needed.
OSGTERRAINLIGHT_EXPORT std::shared_ptr<const Environment> readEnvironment(const std::string& path,
                                                                          std::string& problem);

} // namespace osgTerrainLight
