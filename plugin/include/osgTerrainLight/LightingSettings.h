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

/// How exactly horizons are computed. docs/measurements/ACCURACY.md has the error and cost of each.
enum class HorizonQuality
{
    Draft,
    Normal,
    Best
};

OSGTERRAINLIGHT_EXPORT const char* toString(HorizonQuality quality);
/// Returns false where the text is none of draft, normal, best; quality is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, HorizonQuality& quality);

/// How bounces are computed. The Legendre methods compute direct light, too.
/// docs/methods/legendre.md compares the methods.
enum class BounceMethod
{
    Slices, ///< Each segment of terrain counts exactly: the cheapest way to a given error.
    /// All light is computed as by Nowrouzezahrai and Snyder 2009, also without bounces: in
    /// spherical harmonics of order 4 from a pyramid of heights. There is no horizon map, and the
    /// sun is a key light.
    Legendre,
    LegendreBSpline ///< The same, with azimuths joined by B-splines instead of linearly.
};

OSGTERRAINLIGHT_EXPORT const char* toString(BounceMethod method);
/// Returns false where the text is none of slices, legendre, legendre-bspline; method is then
/// unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, BounceMethod& method);

/// How mirrored light reaches other slopes (Nowrouzezahrai and Snyder 2009, section 5.3).
/// docs/methods/gloss.md compares the two.
enum class GlossTransfer
{
    Vector, ///< As a function of the direction, in spherical harmonics of order 4.
    Scalar  ///< As one viewer sees it: this is less work, and right for one direction only.
};

OSGTERRAINLIGHT_EXPORT const char* toString(GlossTransfer transfer);
/// Returns false where the text is none of vector, scalar; transfer is then unchanged.
OSGTERRAINLIGHT_EXPORT bool fromString(const std::string& text, GlossTransfer& transfer);

/// All parameters of the computation, without the light itself, as plain values.
struct OSGTERRAINLIGHT_EXPORT LightingSettings
{
    /// Number of azimuths of the horizon map: a multiple of 4, 4 … 256.
    int azimuths = 32;
    HorizonQuality quality = HorizonQuality::Normal;
    /// Number of bounces of diffuse light between slopes, 0 … 8.
    int bounces = 0;
    BounceMethod bounceMethod = BounceMethod::Slices;
    /// The Legendre methods compute all light, direct light too, at every 1st, 2nd or 4th post in
    /// both directions only, and shade it with the normals of all posts. Slices does not use it.
    int subsampling = 1;
    /// While only the light changes, bounces are computed in every n-th update, 1 … 16; between
    /// these, the last bounces are added to new direct light (Nowrouzezahrai and Snyder 2009,
    /// section 7). If anything else changes, or if the light stands still for one update, bounces
    /// are computed at once: the result of a still scene is exact.
    int bounceInterval = 1;
    /// Part of the light that the ground reflects, 0 … 1 per channel, where a tile has no albedo of
    /// its own.
    std::array<float, 3> albedo = {0.5f, 0.5f, 0.5f};
    /// Part of the light that the ground mirrors, 0 … 1. The ground sends gloss · ∫ lobe · light
    /// towards a viewer, besides albedo · irradiance / π. The lobe is the Phong lobe (s + 1) / 2π
    /// cosˢ about the mirror direction, with s = glossExponent, 1 … 64. With 0, gloss costs neither
    /// time nor memory. It has no effect with a BounceMethod other than Slices. Where gloss and
    /// albedo add up to more than 1, the ground sends more light than it receives, and bounces may
    /// not converge. TerrainLighting::setGlossLayer() sets gloss per post. docs/methods/gloss.md
    /// has memory and errors.
    double gloss = 0.0;
    double glossExponent = 8.0;
    GlossTransfer glossTransfer = GlossTransfer::Vector;
    /// Direction towards the viewer of GlossTransfer::Scalar: east, north, up, of any length but 0.
    std::array<double, 3> glossViewer = {0.0, 0.0, 1.0};
    /// Whether terrain_shading.glsl, and with it the default program, finds the edge of the sun's
    /// shadow between posts: crisp near the crest that casts it, soft far away. Costs 8 bytes per
    /// post, and 12 more where nothing bounces. The shading texture and all rasters stay as they
    /// are. It has no effect with a BounceMethod other than Slices.
    bool shadowEdges = false;
    /// Cones by which the light among placed objects is gathered, 4 … 32: 4, 6, 9, 12, 16 or 32, or
    /// the next of these above. More err less and take longer (docs/methods/objects.md).
    int objectCones = 16;
    /// Radius of the planet [m], 1e3 … 1e12; 0 is a flat world. Distant terrain is lowered by the
    /// curvature: at a distance d from the middle of the tile, by d² / 2 radius. The radius of the
    /// Earth is 6 371 000; 7 323 000 (R / (1 − 0.13)) includes the refraction of its air.
    double bodyRadius = 0.0;
    /// Brightness in stops, −20 … 20: the default program and pictures of the tool multiply colours
    /// by 2^exposure before they encode them to sRGB.
    double exposure = 0.0;

    /// Finds the cheapest settings whose error on this terrain, under this light, is measured to be
    /// at most maxError (> 0), or the most exact settings that light the whole tile within a time
    /// (milliseconds > 0). SettingsChoice says what is measured and promised.
    ///
    /// Both functions measure in an OpenGL context of their own, which they make current on the
    /// calling thread. Call them where no context is current. They take as long as lighting the
    /// tile a few times, so choose once for a kind of terrain, not per tile or frame.
    static SettingsChoice forMaxError(double maxError, const DemTile& tile, const SkyLight& sky);
    static SettingsChoice forFrameTime(double milliseconds, const DemTile& tile,
                                       const SkyLight& sky);
};

OSGTERRAINLIGHT_EXPORT bool operator==(const LightingSettings& a, const LightingSettings& b);
inline bool operator!=(const LightingSettings& a, const LightingSettings& b)
{
    return !(a == b);
}

/// Settings that were chosen by measurement.
///
/// The error is the root mean square, over posts, of the difference in luminance between the
/// shading and that of exhaustive horizons, divided by the root mean square of the shading: 0.01 is
/// one per cent. It is measured at posts that are drawn where errors are likely. `error` is an
/// upper bound, so that at least 95 % of many terrains keep the error that forMaxError() was asked
/// for (tests/scene/settings_bound_test.cpp counts this). forMaxError() gives the same choice for
/// the same tile and light each time; forFrameTime() rests on measured times.
struct OSGTERRAINLIGHT_EXPORT SettingsChoice
{
    LightingSettings settings;
    double error = 0.0;
    /// GPU time of lighting the tile once [ms]: of forFrameTime() the median of 3, of forMaxError()
    /// one run.
    double milliseconds = 0.0;
    /// False where no settings reach what was asked; the settings are then those that come closest.
    bool met = false;
    /// Says why nothing could be measured; the settings are then the defaults. Else it is empty.
    std::string failure;
};

/// The name, unit and legal range of a numeric parameter, from the table that the parsers, the
/// setters and the documentation share.
struct OSGTERRAINLIGHT_EXPORT ParameterRange
{
    std::string name;
    std::string unit;
    double minimum = 0.0;
    double maximum = 0.0;
    std::string meaning;

    /// Finds a parameter by its name, such as "sun-elevation": the key of a map
    /// (docs/EARTH_FILE.md) with '-' for '_'. all() has every name. Null where there is no such
    /// parameter.
    static const ParameterRange* find(const std::string& name);
    static const std::vector<ParameterRange>& all();

    /// Empty where the value is legal; else a sentence that names the parameter, the value and the
    /// range.
    std::string complaint(double value) const;
};

/// Something that is wrong with settings and light.
struct SettingsProblem
{
    std::string sentence;
    /// True where the values are refused. False where they are taken, but do not do all that they
    /// seem to ask for.
    bool refused = true;
    /// Name of the setting that the sentence is about, as in ParameterRange; empty where a value is
    /// beyond its range.
    std::string setting;
};

/// What settings are meant for.
enum class SettingsUse
{
    Lighting,
    Choice ///< A budget chooses other settings from them: forMaxError(), forFrameTime().
};

/// Finds all that is wrong with settings and light, each by itself and together: values beyond
/// their range, settings that have no effect beside the others, and combinations that are refused.
/// Empty where nothing is wrong. TerrainLighting's setters give these sentences as warnings, each
/// once as long as it holds; so do maps, saved scenes and the tool. The tool refuses an option that
/// has no effect.
OSGTERRAINLIGHT_EXPORT std::vector<SettingsProblem>
problems(const LightingSettings& settings, const SkyLight& sky,
         SettingsUse use = SettingsUse::Lighting);

} // namespace osgTerrainLight
