#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"

#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// The light of a sky of any radiance per slice of azimuth and zenith angle (sky_table.comp;
/// Timonen and Westerholm 2010, Eq. 6 and 7).
class OSGTERRAINLIGHT_EXPORT SkyTablePass : public osg::Referenced
{
public:
    /// azimuths: those of the horizon map. rows: of equal angles of elevation;
    /// docs/ARCHITECTURE.md has the error.
    explicit SkyTablePass(int azimuths, int rows = 128);

    /// The table of a sky in spherical harmonics: 1, 4, 9 or 16 coefficients.
    Status dispatch(osg::State& state, const std::vector<Rgb>& harmonics);

    /// RGBA32F, azimuths × (rows + 1), layers red, green, blue: lights.glsl says what of.
    osg::Texture2DArray* table() const { return _table; }

    /// All textures [bytes].
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~SkyTablePass() override = default;

    int _azimuths;
    osg::ref_ptr<osg::Texture2D> _sky; ///< radiance by azimuth and elevation
    osg::ref_ptr<osg::Texture2DArray> _table;
    osg::ref_ptr<GpuPass> _harmonics, _sum;
};

} // namespace osgTerrainLight
