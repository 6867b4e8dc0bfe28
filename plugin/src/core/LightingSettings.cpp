#include <osgTerrainLight/LightingSettings.h>

#include "core/AzimuthSet.h"

#include <cmath>
#include <sstream>

namespace osgTerrainLight
{

const char* toString(HorizonQuality quality)
{
    switch (quality)
    {
    case HorizonQuality::Draft:
        return "draft";
    case HorizonQuality::Best:
        return "best";
    default:
        return "normal";
    }
}

bool fromString(const std::string& text, HorizonQuality& quality)
{
    for (HorizonQuality q : {HorizonQuality::Draft, HorizonQuality::Normal, HorizonQuality::Best})
        if (text == toString(q))
        {
            quality = q;
            return true;
        }
    return false;
}

const char* toString(BounceMethod method)
{
    switch (method)
    {
    case BounceMethod::Legendre:
        return "legendre";
    case BounceMethod::LegendreBSpline:
        return "legendre-bspline";
    default:
        return "slices";
    }
}

bool fromString(const std::string& text, BounceMethod& method)
{
    for (BounceMethod m :
         {BounceMethod::Slices, BounceMethod::Legendre, BounceMethod::LegendreBSpline})
        if (text == toString(m))
        {
            method = m;
            return true;
        }
    return false;
}

const char* toString(GlossTransfer transfer)
{
    return transfer == GlossTransfer::Scalar ? "scalar" : "vector";
}

bool fromString(const std::string& text, GlossTransfer& transfer)
{
    for (GlossTransfer t : {GlossTransfer::Vector, GlossTransfer::Scalar})
        if (text == toString(t))
        {
            transfer = t;
            return true;
        }
    return false;
}

const std::vector<ParameterRange>& ParameterRange::all()
{
    static const std::vector<ParameterRange> table = {
        {"azimuths", "", 4, 256, "azimuths of the horizon map, a multiple of 4"},
        {"bounces", "", 0, 8, "diffuse bounces of light from terrain to terrain"},
        {"subsampling", "", 1, 4, "posts from one that gathers bounces to the next: 1, 2 or 4"},
        {"bounce-interval", "", 1, 16,
         "updates of light alone from one with new bounces to the next"},
        {"albedo", "", 0, 1, "part of the light that the ground reflects, per channel"},
        {"gloss", "", 0, 1, "part of the light that the ground mirrors"},
        {"gloss-exponent", "", 1, 64, "how sharply it mirrors: exponent of the Phong lobe"},
        {"exposure", "stops", -20, 20, "brightness of the displayed picture"},
        {"sun-azimuth", "degrees", -360, 720, "clockwise from north"},
        {"sun-elevation", "degrees", -90, 90, "above the horizontal"},
        {"sun-radius", "degrees", 0.01, 10, "angular radius of the sun's disc"},
        {"sun-irradiance", "", 0, 1e6, "on a surface that faces the sun, per channel"},
        {"turbidity", "", 2, 10, "of a clear sky's air: 2 clear ... 10 haze"},
        {"sky-heading", "degrees", -360, 720, "by which a sky from a file is turned clockwise"},
        {"sky-gain", "", 0, 1e6, "what the radiance of a sky from a file is multiplied by"},
        {"body-radius", "m", 0, 1e12, "of the planet, below whose horizon terrain sinks; 0: flat"},
        {"max-error", "", 1e-5, 1, "greatest relative error of the shading, root mean square"},
        {"max-ms", "ms", 0.01, 1e6, "longest time for the light of the whole tile"},
        {"sky-radiance", "", 0, 1e6, "of the uniform sky, per channel"},
    };
    return table;
}

const ParameterRange* ParameterRange::find(const std::string& name)
{
    for (const ParameterRange& range : all())
        if (range.name == name)
            return &range;
    return nullptr;
}

std::string ParameterRange::complaint(double value) const
{
    bool inRange = value >= minimum && value <= maximum; // false for NaN
    if (name == "body-radius") // none smaller is a planet, and terrain on it no tile
        inRange = inRange && (value == 0.0 || value >= 1e3);
    const bool isCount = name == "azimuths";
    const bool isPower = name == "subsampling";
    const bool isWhole = isCount || isPower || name == "bounces" || name == "bounce-interval";
    if (inRange && (!isWhole || value == std::floor(value)) && (!isPower || value != 3.0) &&
        (!isCount || AzimuthSet::isValidCount(static_cast<int>(value))))
        return {};
    std::ostringstream text;
    text << name << " = " << value << (unit.empty() ? "" : " ") << unit << ": needs "
         << (isCount   ? "a multiple of 4, "
             : isPower ? "a power of 2, "
             : isWhole ? "a whole number, "
                       : "")
         << (name == "body-radius" ? "0, or 1000" : "");
    if (name != "body-radius")
        text << minimum;
    text << " ... " << maximum;
    return text.str();
}

} // namespace osgTerrainLight
