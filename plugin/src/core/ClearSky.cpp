#include "core/ClearSky.h"

#include "core/Quadrature.h"

#include <algorithm>
#include <cmath>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double radiansPerDegree = pi / 180.0;
using Colour = std::array<double, 3>;

/// Of 10 nm, from 380 to 750 nm: the sun outside the air [W m-2 nm-1] (means of ASTM G173),
/// absorption of ozone at 233 K [1e-26 m2] (means of Serdyuchenko et al. 2014), and the CIE 1931
/// observer at the band's lower edge.
struct Band
{
    double sun, ozone, x, y, z;
};
constexpr double firstEdge = 0.38, bandWidth = 0.01; // micrometres
constexpr std::array<Band, 38> bands = {{
    {1.01249, 0.02818, 0.0014, 0.0000, 0.0065}, {1.14716, 0.06636, 0.0042, 0.0001, 0.0201},
    {1.72765, 0.1527, 0.0143, 0.0004, 0.0679},  {1.73054, 0.2763, 0.0435, 0.0012, 0.2074},
    {1.6887, 0.552, 0.1344, 0.0040, 0.6456},    {1.61253, 0.8451, 0.2839, 0.0116, 1.3856},
    {1.91198, 1.582, 0.3483, 0.0230, 1.7471},   {2.03474, 2.316, 0.3362, 0.0380, 1.7721},
    {2.02042, 3.669, 0.2908, 0.0600, 1.6692},   {2.02212, 4.924, 0.1954, 0.0910, 1.2876},
    {1.93377, 7.752, 0.0956, 0.1390, 0.8130},   {1.95809, 9.016, 0.0320, 0.2080, 0.4652},
    {1.91686, 14.8, 0.0049, 0.3230, 0.2720},    {1.8298, 16.02, 0.0093, 0.5030, 0.1582},
    {1.8685, 21.39, 0.0633, 0.7100, 0.0782},    {1.8931, 27.55, 0.1655, 0.8620, 0.0422},
    {1.85149, 30.91, 0.2904, 0.9540, 0.0203},   {1.8504, 35.0, 0.4334, 0.9950, 0.0087},
    {1.8341, 42.66, 0.5945, 0.9950, 0.0039},    {1.8345, 46.72, 0.7621, 0.9520, 0.0021},
    {1.8147, 43.98, 0.9163, 0.8700, 0.0017},    {1.78158, 47.01, 1.0263, 0.7570, 0.0011},
    {1.7533, 50.19, 1.0622, 0.6310, 0.0008},    {1.6965, 43.05, 1.0026, 0.5030, 0.0003},
    {1.68194, 37.4, 0.8544, 0.3810, 0.0002},    {1.64654, 32.15, 0.6424, 0.2650, 0.0000},
    {1.6048, 26.62, 0.4479, 0.1750, 0.0000},    {1.52143, 22.38, 0.2835, 0.1070, 0.0000},
    {1.55622, 18.52, 0.1649, 0.0610, 0.0000},   {1.5113, 14.73, 0.0874, 0.0320, 0.0000},
    {1.474, 12.09, 0.0468, 0.0170, 0.0000},     {1.4482, 9.423, 0.0227, 0.0082, 0.0000},
    {1.41018, 7.455, 0.0114, 0.0041, 0.0000},   {1.36775, 6.566, 0.0058, 0.0021, 0.0000},
    {1.34188, 5.105, 0.0029, 0.0010, 0.0000},   {1.31429, 4.15, 0.0014, 0.0005, 0.0000},
    {1.28303, 4.228, 0.0007, 0.0003, 0.0000},   {0.0, 0.0, 0.0003, 0.0001, 0.0000},
}};

/// A band's part of linear red, green, blue [klx].
Colour colourOf(std::size_t i)
{
    const Band& low = bands[i];
    const Band& high = bands[i + 1];
    const double size = 0.683 * low.sun * 10.0 / 2.0; // lm/W, nm, mean of two edges
    const double x = size * (low.x + high.x);
    const double y = size * (low.y + high.y);
    const double z = size * (low.z + high.z);
    return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
            -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

double luminanceOf(const Colour& c)
{
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

/// Path through a layer of ozone at 22 km, over its thickness (Bird and Riordan 1986,
/// Robinson's formula).
double ozoneMass(double sine)
{
    constexpr double height = 22.0 / 6370.0;
    return (1.0 + height) / std::sqrt(sine * sine + 2.0 * height);
}

/// Illuminance of level ground by twilight, over that of a surface that faces the sun outside the
/// air (Janiczek and DeYoung 1987, ATMOS); at most that of a sun at the horizontal.
double twilight(double elevation)
{
    const double sine = std::sin(std::min(elevation, 0.0) * radiansPerDegree);
    constexpr double radius = 753.66156; // of the earth, in heights of the air
    const double side = radius / (radius + 1.0) * std::sqrt(1.0 - sine * sine);
    const double bend = std::sqrt(1.0 - side * side);
    const double mass = radius * (bend - sine) + bend;
    return 0.0289 * std::exp(-0.042 * mass) *
           (1.0 + (std::min(elevation, 0.0) + 90.0) * radiansPerDegree * sine);
}
} // namespace

double relativeAirMass(double elevation)
{
    const double above = std::max(elevation, 0.0);
    return 1.0 /
           (std::sin(above * radiansPerDegree) + 0.50572 * std::pow(above + 6.07995, -1.6364));
}

double rayleighDepth(double wavelength)
{
    const double inverse = 1.0 / (wavelength * wavelength);
    return 0.008569 * inverse * inverse * (1.0 + 0.0113 * inverse + 0.00013 * inverse * inverse);
}

double solarIlluminance()
{
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < bands.size(); ++i)
        sum += luminanceOf(colourOf(i));
    return sum;
}

Daylight daylightOf(double turbidity, double elevation)
{
    // Single scattering of aerosol, its asymmetry 0.65: the part that goes on downwards.
    constexpr double logarithm = -1.0498221244986778; // ln(1 - 0.65)
    constexpr double first = logarithm * (1.459 + logarithm * (0.1595 + logarithm * 0.4129));
    constexpr double second = logarithm * (0.0783 + logarithm * (-0.3824 - logarithm * 0.5874));
    const double sine = std::sin(std::max(elevation, 0.0) * radiansPerDegree);
    const double mass = relativeAirMass(elevation);
    const double ozonePath = 300.0 * 2.687e20 * ozoneMass(sine); // molecules per m2
    const double forward = 1.0 - 0.5 * std::exp((first + second * sine) * sine);
    // Angstrom's, by turbidity: Preetham, Shirley and Smits 1999, appendix A.1.
    const double beta = 0.04608 * turbidity - 0.04586;

    Colour outside = {}, sun = {}, sky = {};
    for (std::size_t i = 0; i + 1 < bands.size(); ++i)
    {
        const double wavelength = firstEdge + (static_cast<double>(i) + 0.5) * bandWidth;
        const double haze = beta * std::pow(wavelength, -1.3);
        const double albedo = 0.945 * std::exp(-0.095 * std::pow(std::log(wavelength / 0.4), 2.0));
        const double throughOzone = std::exp(-1e-26 * bands[i].ozone * ozonePath);
        const double throughAir = std::exp(-rayleighDepth(wavelength) * mass);
        const double unabsorbed = std::exp(-(1.0 - albedo) * haze * mass);
        const double unscattered = std::exp(-albedo * haze * mass);
        const double direct = throughOzone * throughAir * unabsorbed * unscattered;
        // Over the sun's irradiance of level ground outside the air.
        const double diffuse = throughOzone * unabsorbed *
                               (0.5 * (1.0 - std::pow(throughAir, 0.95)) +
                                forward * std::pow(throughAir, 1.5) * (1.0 - unscattered));
        const Colour colour = colourOf(i);
        for (std::size_t c = 0; c < 3; ++c)
        {
            outside[c] += colour[c];
            sun[c] += direct * colour[c];
            sky[c] += diffuse * colour[c];
        }
    }
    // A flat earth has no twilight, which is added, in the flat sky's colour.
    const double dusk = twilight(elevation) * luminanceOf(outside) / luminanceOf(sky);
    Daylight found = {};
    for (std::size_t c = 0; c < 3; ++c)
    {
        // A red sun's blue is less than none: it lies outside of Rec. 709.
        found.sun[c] = std::max(sun[c], 0.0) / outside[c];
        found.sky[c] = (sine + dusk) * sky[c] / outside[c];
    }
    return found;
}

Glsl<double>::ClearSky clearSky(const SkyLight& light)
{
    const double t = light.turbidity;
    const std::array<double, 3> towards = light.sunDirection();
    Glsl<double>::ClearSky sky;
    sky.sun = {towards[0], towards[1], towards[2]};
    // Appendix A.2.
    sky.luminance = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                     0.1206 * t - 2.5771};
    sky.x = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
             -0.0641 * t - 0.8989};
    sky.y = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
             -0.0441 * t - 1.6537};
    sky.e = {-0.0670 * t + 0.3703, -0.0033 * t + 0.0452, -0.0109 * t + 0.0529};
    // The picture of a sun at the horizontal serves those below, too, about the sun's own place.
    const double s = (90.0 - std::clamp(light.sunElevation, 0.0, 90.0)) * radiansPerDegree;
    const double x = t * t * (((0.00166 * s - 0.00375) * s + 0.00209) * s) +
                     t * (((-0.02903 * s + 0.06377) * s - 0.03202) * s + 0.00394) +
                     (((0.11693 * s - 0.21196) * s + 0.06052) * s + 0.25886);
    const double y = t * t * (((0.00275 * s - 0.00610) * s + 0.00317) * s) +
                     t * (((-0.04214 * s + 0.08970) * s - 0.04153) * s + 0.00516) +
                     (((0.15346 * s - 0.26756) * s + 0.06670) * s + 0.26688);
    Glsl<double> glsl;
    const double c = std::cos(s);
    sky.zenith = {1.0 / glsl.perez(sky.luminance, sky.e.x, 1.0, s, c),
                  x / glsl.perez(sky.x, sky.e.y, 1.0, s, c),
                  y / glsl.perez(sky.y, sky.e.z, 1.0, s, c)};

    // Its irradiance of level ground, which shall be daylightOf()'s. In z = u u, finer towards the
    // horizontal, and in azimuth from the sun's, half the way round.
    sky.gain = {1.0, 1.0, 1.0};
    constexpr int turns = 32;
    const double heading = std::atan2(towards[1], towards[0]);
    const GaussRule& rule = gaussRule();
    Glsl<double>::vec3 sum = {0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < rule.places.size(); ++i)
        for (int turn = 0; turn < turns; ++turn)
        {
            const double u = rule.places[i];
            const double z = u * u;
            const double side = std::sqrt(1.0 - z * z);
            const double azimuth = heading + pi * (turn + 0.5) / turns;
            sum +=
                rule.weights[i] * 2.0 * u * z * 2.0 * pi / turns *
                glsl.clearSkyRadiance(sky, {side * std::cos(azimuth), side * std::sin(azimuth), z});
        }
    const Daylight wanted = daylightOf(t, light.sunElevation);
    for (int k = 0; k < 3; ++k)
        sky.gain[k] = wanted.sky[static_cast<std::size_t>(k)] *
                      static_cast<double>(light.sunIrradiance[static_cast<std::size_t>(k)]) /
                      sum[k];
    return sky;
}

} // namespace osgTerrainLight
