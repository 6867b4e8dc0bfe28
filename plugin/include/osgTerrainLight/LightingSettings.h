#pragma once

#include <osgTerrainLight/Export.h>

#include <array>
#include <string>
#include <vector>

namespace osgTerrainLight
{
class DemTile;
struct SettingsChoice;
struct SkyLight;

/// How exactly horizons are computed; docs/measurements/ACCURACY.md has each one's error and cost.
enum class HorizonQuality
{
    Draft,
    Normal,
    Best
};

OSGTERRAINLIGHT_EXPORT const char* toString(HorizonQuality quality);
/// False where the text is none of draft, normal, best; quality is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, HorizonQuality& quality);

/// How bounces are computed and, with Legendre, direct light too; docs/methods/legendre.md compares
/// them.
enum class BounceMethod
{
    Slices, ///< each segment of terrain exactly: the cheapest way to a given error
    /// All light as Nowrouzezahrai and Snyder 2009, also with no bounces: spherical harmonics of
    /// order 4 from a pyramid of heights. No horizon map and no sweep; the sun is a key light.
    Legendre,
    LegendreBSpline ///< the same, azimuths joined by B-splines instead of linearly
};

OSGTERRAINLIGHT_EXPORT const char* toString(BounceMethod method);
/// False where the text is none of slices, legendre, legendre-bspline; method is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, BounceMethod& method);

/// How glossy light gets from terrain to terrain (Nowrouzezahrai and Snyder 2009, section 5.3);
/// docs/methods/gloss.md compares the two.
enum class GlossTransfer
{
    Vector, ///< as a function of direction, within spherical harmonics of order 4
    Scalar  ///< what one viewer would see of it: less work, and right for that direction alone
};

OSGTERRAINLIGHT_EXPORT const char* toString(GlossTransfer transfer);
/// False where the text is none of vector, scalar; transfer is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, GlossTransfer& transfer);

/// Every parameter of the lighting computation that is not the light itself: plain data.
struct OSGTERRAINLIGHT_EXPORT LightingSettings
{
    /// Azimuths of the horizon map: a multiple of 4, 4 … 256.
    int azimuths = 32;
    HorizonQuality quality = HorizonQuality::Normal;
    /// Diffuse bounces of light from terrain to terrain: 0 … 8.
    int bounces = 0;
    BounceMethod bounceMethod = BounceMethod::Slices;
    /// Terrain farther than two posts is looked at from every 1st, 2nd or 4th post in both
    /// directions; what is nearer, normals and horizons are each post's own. A bounce then takes a
    /// third or a sixth of the time (docs/methods/bounces.md has errors and memory). With Legendre
    /// all light, direct light too, is gathered there and shaded with all posts' normals. Gloss is
    /// not thinned out.
    int subsampling = 1;
    /// While only light changes, bounces are computed in every n-th update, 1 … 16, and those of
    /// the last time are added to new direct light in between (Nowrouzezahrai and Snyder 2009,
    /// section 7). Anything else that changes brings new ones at once, and so does light that
    /// stands still for one update: what stays is exact.
    int bounceInterval = 1;
    /// What the ground reflects of the light it receives, 0 … 1 per channel, where a tile has no
    /// albedo of its own.
    std::array<float, 3> albedo = {0.5f, 0.5f, 0.5f};
    /// What the ground mirrors, 0 … 1: it sends towards a viewer gloss · ∫ lobe · light besides
    /// albedo · irradiance / π, with the Phong lobe (s + 1) / 2π cosˢ about the mirror direction, s
    /// = glossExponent, 1 … 64. 0: nothing is computed and nothing kept for it. With a BounceMethod
    /// other than Slices it has no effect. Neither it nor albedo is cut where their sum is more
    /// than 1: such ground sends more than it receives, and bounces need not converge. Per post:
    /// TerrainLighting::setGlossLayer(). docs/methods/gloss.md has memory and errors.
    double gloss = 0.0;
    double glossExponent = 8.0;
    GlossTransfer glossTransfer = GlossTransfer::Vector;
    /// Direction of the viewer for GlossTransfer::Scalar: east, north, up, any length but 0.
    std::array<double, 3> glossViewer = {0.0, 0.0, 1.0};
    /// Radius of the planet [m], 1e3 … 1e12; 0: terrain is flat. Over a distance d from the middle
    /// of the tile its ground sinks by d² / 2 radius below the plane there, and with it what is
    /// seen and shadowed. Earth: 6 371 000; light in its air bends as if it had 7 323 000 (R / (1 −
    /// 0.13)).
    double bodyRadius = 0.0;
    /// Multiplies the colour before it is encoded to sRGB, in the default program and in PNG
    /// output: 2^exposure. Stops, −20 … 20.
    double exposure = 0.0;

    /// The cheapest settings whose error on this terrain, under this light, is measured to be at
    /// most maxError (> 0), and the most exact ones within a time per lighting of the whole tile
    /// (milliseconds > 0). SettingsChoice says what is measured and promised.
    ///
    /// They measure in an OpenGL context of their own, which they make current on the calling
    /// thread: call them where none is current. It takes about as long as lighting the tile a few
    /// times, so choose once for a kind of terrain, not per tile or frame.
    static SettingsChoice forMaxError(double maxError, const DemTile& tile, const SkyLight& sky);
    static SettingsChoice forFrameTime(double milliseconds, const DemTile& tile,
                                       const SkyLight& sky);
};

OSGTERRAINLIGHT_EXPORT bool operator==(const LightingSettings& a, const LightingSettings& b);
inline bool operator!=(const LightingSettings& a, const LightingSettings& b)
{
    return !(a == b);
}

/// Settings chosen by measurement.
///
/// Error is the root mean square, over posts, of the difference in luminance between the shading
/// and that of exhaustive horizons, over the root mean square of the shading: 0.01 is one per cent.
/// It is measured at random posts; `error` is the upper end of its one-sided 95 % confidence
/// interval. So of many terrains, at least 95 % keep what forMaxError was asked for (tests/scene/
/// settings_choice_test.cpp holds it on terrain that the choice never saw).
struct OSGTERRAINLIGHT_EXPORT SettingsChoice
{
    LightingSettings settings;
    double error = 0.0;
    /// GPU time of one lighting of the tile, median of 3.
    double milliseconds = 0.0;
    /// False: nothing reaches what was asked; the settings are the ones that come closest.
    bool met = false;
    /// Not empty: why nothing could be measured; the settings are then the defaults.
    std::string failure;
};

/// One numeric parameter's name, unit and legal range, from the table that parser, setters and
/// documentation share.
struct OSGTERRAINLIGHT_EXPORT ParameterRange
{
    std::string name;
    std::string unit;
    double minimum = 0.0;
    double maximum = 0.0;
    std::string meaning;

    /// By the name that docs/TOOL.md has after "--", such as "sun-elevation"; all() has every name.
    /// Null where there is no such parameter.
    static const ParameterRange* find(const std::string& name);
    static const std::vector<ParameterRange>& all();

    /// Empty where the value is legal; else a sentence that names the parameter, the value and the
    /// range.
    std::string complaint(double value) const;
};

/// Something wrong with settings and light.
struct SettingsProblem
{
    std::string sentence;
    /// True: they are refused. False: they are taken, and do not do all that they seem to ask for.
    bool refused = true;
};

/// What settings are meant for.
enum class SettingsUse
{
    Lighting,
    Choice ///< other settings are chosen from them by a budget: forMaxError(), forFrameTime()
};

/// All that is wrong with settings and light, each by itself and together: values beyond their
/// range, and combinations that are refused or without effect. Empty where nothing is. The tool,
/// maps and TerrainLighting's setters say the same.
OSGTERRAINLIGHT_EXPORT std::vector<SettingsProblem>
problems(const LightingSettings& settings, const SkyLight& sky,
         SettingsUse use = SettingsUse::Lighting);

} // namespace osgTerrainLight
