#pragma once

#include "gpu/WorkGraph.h"
#include "lighting/TileInputs.h"

#include <osg/Uniform>

#include <vector>

namespace osgTerrainLight
{

/// `harmonics` of shaders: vec3[16], from 1, 4, 9 or 16 coefficients.
osg::ref_ptr<osg::Uniform> harmonicsUniform(const std::vector<Rgb>& harmonics);

/// The light of a sky of any radiance per slice of azimuth and zenith angle (sky_table.comp;
/// Timonen and Westerholm 2010, Eq. 6 and 7).
class SkyTableNode : public Node
{
public:
    /// azimuths: those of the horizon map. rows: of equal angles of elevation;
    /// docs/ARCHITECTURE.md has the error.
    SkyTableNode(const TileInputs& inputs, int azimuths, int rows = 128);

    /// The table of a sky of whichever kind; of a uniform one, too.
    Status run(osg::State& state) override;

    /// RGBA32F, azimuths × 3 (rows + 1): lights/sky.glsl says what of.
    Resource* table() const { return _table; }

    /// RGBA32F, radiance: columns counter-clockwise from east, rows upwards from the horizontal.
    Resource* picture() const { return _picture; }

private:
    ~SkyTableNode() override = default;
    GpuPass& choosePass();
    void setModel(const SkyLight& sky);

    osg::ref_ptr<const TileInputs> _inputs;
    int _azimuths;
    Resource *_picture, *_table;
    Resource* _panorama; ///< of the environment, which all tiles share
    GpuPass *_harmonics, *_environment, *_model, *_sum;
};

} // namespace osgTerrainLight
