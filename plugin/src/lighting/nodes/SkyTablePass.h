#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"
#include "gpu/GpuPass.h"

#include <osg/Texture2D>

#include <cstddef>

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

    /// The table of a sky of whichever kind; of a uniform one, too.
    Status dispatch(osg::State& state, const SkyLight& sky);

    /// RGBA32F, azimuths × 3 (rows + 1): lights.glsl says what of.
    osg::Texture2D* table() const { return _table; }

    /// RGBA32F, radiance: columns counter-clockwise from east, rows upwards from the horizontal.
    osg::Texture2D* picture() const { return _sky; }

    /// All textures [bytes].
    std::size_t bytes() const;

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~SkyTablePass() override = default;
    void setModel(const SkyLight& sky);

    int _azimuths;
    osg::ref_ptr<osg::Texture2D> _sky; ///< radiance by azimuth and elevation
    osg::ref_ptr<osg::Texture2D> _table;
    osg::ref_ptr<GpuPass> _harmonics, _environment, _model, _sum;
    osg::ref_ptr<osg::Texture2D> _panorama; ///< null without an environment
};

} // namespace osgTerrainLight
