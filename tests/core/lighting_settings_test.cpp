#include <osgTerrainLight/LightingSettings.h>

#include <osgTerrainLight/SkyLight.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

using namespace osgTerrainLight;

TEST(LightingSettings, QualityNamesRoundTrip)
{
    for (HorizonQuality quality :
         {HorizonQuality::Draft, HorizonQuality::Normal, HorizonQuality::Best})
    {
        HorizonQuality read = HorizonQuality::Normal;
        EXPECT_TRUE(fromString(toString(quality), read));
        EXPECT_EQ(read, quality);
    }
    HorizonQuality kept = HorizonQuality::Best;
    EXPECT_FALSE(fromString("Draft", kept));
    EXPECT_FALSE(fromString("", kept));
    EXPECT_EQ(kept, HorizonQuality::Best);
}

TEST(LightingSettings, BounceMethodNamesRoundTrip)
{
    for (BounceMethod method :
         {BounceMethod::Slices, BounceMethod::Legendre, BounceMethod::LegendreBSpline})
    {
        BounceMethod read = BounceMethod::Slices;
        EXPECT_TRUE(fromString(toString(method), read));
        EXPECT_EQ(read, method);
    }
    BounceMethod kept = BounceMethod::Legendre;
    EXPECT_FALSE(fromString("Slices", kept));
    EXPECT_FALSE(fromString("", kept));
    EXPECT_EQ(kept, BounceMethod::Legendre);
}

TEST(LightingSettings, EachRangeHoldsItsEndsAndNothingBeyond)
{
    std::set<std::string> names;
    for (const ParameterRange& range : ParameterRange::all())
    {
        EXPECT_TRUE(names.insert(range.name).second) << range.name;
        EXPECT_EQ(ParameterRange::find(range.name)->meaning, range.meaning);
        EXPECT_FALSE(range.meaning.empty());
        EXPECT_LT(range.minimum, range.maximum);
        EXPECT_EQ(range.complaint(range.minimum), "");
        EXPECT_EQ(range.complaint(range.maximum), "");
        for (double value :
             {std::nextafter(range.minimum, -1e300), std::nextafter(range.maximum, 1e300),
              std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        {
            EXPECT_NE(range.complaint(value), "") << range.name << " " << value;
            EXPECT_NE(range.complaint(value).find(range.name), std::string::npos);
        }
    }
    EXPECT_EQ(ParameterRange::find("sun"), nullptr);
}

TEST(LightingSettings, AzimuthsAreAMultipleOfFour)
{
    const ParameterRange& azimuths = *ParameterRange::find("azimuths");
    EXPECT_EQ(azimuths.complaint(36), "");
    EXPECT_NE(azimuths.complaint(34), "");
    EXPECT_NE(azimuths.complaint(32.5), "");
    EXPECT_NE(azimuths.complaint(34).find("multiple of 4"), std::string::npos);
}

TEST(LightingSettings, DefaultsAreLegal)
{
    const LightingSettings settings;
    const SkyLight light;
    const auto complaint = [](const char* name, double value)
    { return ParameterRange::find(name)->complaint(value); };
    EXPECT_EQ(complaint("azimuths", settings.azimuths), "");
    EXPECT_EQ(complaint("exposure", settings.exposure), "");
    EXPECT_EQ(complaint("sun-azimuth", light.sunAzimuth), "");
    EXPECT_EQ(complaint("sun-elevation", light.sunElevation), "");
    EXPECT_EQ(complaint("sun-radius", light.sunAngularRadius), "");
    for (std::size_t i = 0; i < 3; ++i)
    {
        EXPECT_EQ(complaint("sky-radiance", double(light.skyRadiance[i])), "");
        EXPECT_EQ(complaint("sun-irradiance", double(light.sunIrradiance[i])), "");
    }
}
