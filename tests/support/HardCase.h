#pragma once

#include "core/AzimuthSet.h"
#include "reference/ReferenceLight.h"

#include <osgTerrainLight/DemTile.h>
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include <osg/State>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// What every file in tests/hard_cases asks of its terrain. Bounds follow from the method and from
/// the tile; none is tuned.
///
/// Notation: u = 2^-24, half a unit in the last place of a float. Of a tile: H the largest
/// |height|, V highest minus lowest, D the largest height difference of neighbouring posts, all in
/// metres. A ray walks s = 1, 2, ... posts along its major axis and drifts t posts per step along
/// its minor one; slopes g(s) = (z(s) - z0)/s are metres per step. R is the slope of the exhaustive
/// reference and S where it lies.
///
/// Rounding. A crossing's height takes three roundings (H, D, D) and its place two (2·s·D·u); minus
/// the receiver (V) and over s >= 1, g is off by u(H + V + 5D + 2|g|). The maximum inside a cell
/// moves by at most three times what its ends move: its derivative with respect to the product a is
/// at most (s2 - s1)/(s1·s2), and a is off by s1·s2/(s2 - s1) times both ends. The terms that
/// cancel in it are up to 2·D·s2 large, s2 <= 12, with 15 roundings: 360·u·D. With 6 more for a
/// quotient that GPUs round to 2.5 units and for the step's length in float,
///
///     rounding = u(3H + 3V + (15 + 30·I)D + 12|R|).
///
/// To it come 2.2e-19 m for heights of next to nothing: a product below the least normal float,
/// 1.2e-38, may be lost, and with it twice its root. Each pop of a hull rounds its products, which
/// lets a vertex go that stands up to 6uV above its neighbours' chord; on N samples that is below
/// 6·N·u·V, seen from `reach` + 1 steps.
///
/// Above: every slope found is one that the ray meets, so it never exceeds R + rounding. Where the
/// ray meets a void, the line beside it may speak, but not of more than the highest post, `reach` +
/// 1 steps away.
///
/// Below: nothing is lost where S <= reach. Else it is enough to take the ray as sampled
/// where it crosses columns (rows are crossed too, which can only raise what is found): at c, w =
/// |S - c| <= 1/2 steps from S (or the step before where the data ends between), the slope is lower
/// by at most w(Dmajor + t·Dminor + |R|)/c. Where c > reach, a line p posts beside the ray says
/// where to look. Its height at equal s differs from the ray's by at most p·Dminor; so where its
/// own highest slope is at s', g(s') >= g(c) - p·Dminor(1/c + 1/s'), s' > reach. p = 0 along the
/// axes and the diagonals of square cells, where lines run through posts; else 1/2, or 1/4 where
/// lines are twice as dense. That holds where the line stays in the data as long as the ray could:
/// rays that leave by the side, run along a border or meet a void are bounded from above only.
///
/// All that is in slopes; elevations follow by the arc tangent, plus half a code, 0.0014 degrees.
namespace osgTerrainLight::hard
{

struct HardCase
{
    std::string name;
    DemTile tile;
    int azimuths = 16;
    /// Lit by each in turn.
    std::vector<reference::Sun> suns = {reference::Sun{}};
    /// The sweep's hulls overflow: then far horizons are bounded from above only.
    bool hullOverflows = false;
};

/// For each quality:
/// (a) voids out are voids in; every other code, sky view and texel of the shading is finite and in
///     its range;
/// (b) horizons, sky view, the sun's visible fraction and the light against the double-precision
///     reference at every post, within the bounds above;
/// (c) the shared functions on this terrain in float against double;
/// (d) a second TileLight, and the first after touch(), give the same bits.
/// Prints what was measured, one line per quality.
void checkHardCase(osg::State& state, const HardCase& hardCase);

/// Slope (tangent, per metre) of the horizon; nothing where the form does not speak.
using HorizonForm =
    std::function<std::optional<double>(int column, int row, const MapDirection& direction)>;

/// Expects horizons of all qualities, clamped at 0, within rounding (see above) and `methodError`
/// degrees of the form, and the form to speak somewhere. Heights are to be exact in float, or their
/// rounding in methodError. Prints the worst difference.
void expectHorizons(osg::State& state, const HardCase& hardCase, const HorizonForm& form,
                    double methodError = 0.0);

/// The three qualities, for loops.
const std::vector<HorizonQuality>& allQualities();

/// Codes, sky view and shading of a tile as bits: to compare runs.
struct Bits
{
    std::vector<std::uint16_t> codes;
    std::vector<std::uint32_t> skyView;
    std::vector<std::uint32_t> shading;

    bool operator==(const Bits& other) const
    {
        return codes == other.codes && skyView == other.skyView && shading == other.shading;
    }
};

Bits lightingBits(osg::State& state, const DemTile& tile, HorizonQuality quality, int azimuths = 16,
                  const SkyLight& sky = {});

/// Expects all bits of two tiles' light to agree, in every quality.
void expectSameLight(osg::State& state, const DemTile& a, const DemTile& b);

/// A GeoTIFF in memory while the object lives: heights from a function of (column, row), row 0 the
/// southernmost, as GDT_Float64 unless told otherwise.
class MemoryDem
{
public:
    struct Frame
    {
        double west = 0.0, south = 0.0; ///< corner of the south-western pixel
        double stepX = 30.0, stepY = 30.0;
        std::string crs; ///< such as "EPSG:4326"; none where empty
        bool floatValues = false;
    };
    MemoryDem(int width, int height, const Frame& frame,
              const std::function<double(int column, int row)>& heightOf);
    ~MemoryDem();
    MemoryDem(const MemoryDem&) = delete;
    MemoryDem& operator=(const MemoryDem&) = delete;

    /// As readDem() reads it; a failure of the test where it does not.
    DemTile read() const;

private:
    std::string _path;
};

} // namespace osgTerrainLight::hard
