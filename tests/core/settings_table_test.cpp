#include "core/SettingsTable.h"

#include "core/KeyLightText.h"
#include <osgTerrainLight/Environment.h>

#include <gtest/gtest.h>

#include <cmath>
#include <set>

using namespace osgTerrainLight;

namespace
{
using Numbers = std::vector<double>;

/// A legal value that is not the default's.
template <class Owner>
SettingValue otherValue(const Setting<Owner>& setting)
{
    const ValueForm& form = setting.form;
    const SettingValue now = setting.get(Owner());
    switch (form.kind)
    {
    case ValueForm::Kind::Name:
        return form.names[form.names[0] == std::get<std::string>(now) ? 1 : 0];
    case ValueForm::Kind::Harmonics:
        return Numbers{0.125, 0.25, 0.5};
    case ValueForm::Kind::KeyLights:
        return Numbers{10, 20, 30, 40, 1, 2, 3};
    default:
        break;
    }
    Numbers numbers = std::get<Numbers>(now);
    numbers[0] = numbers[0] == form.maximum ? form.minimum : form.maximum;
    return numbers;
}

template <class Owner>
class SettingsTable : public testing::Test
{
};
using Owners = testing::Types<LightingSettings, SkyLight, KeyLight>;
TYPED_TEST_SUITE(SettingsTable, Owners);
} // namespace

TYPED_TEST(SettingsTable, EachDefaultIsLegalAndEachNameUnique)
{
    std::set<std::string> names;
    for (const Setting<TypeParam>& setting : settingsOf<TypeParam>())
    {
        SCOPED_TRACE(setting.name);
        EXPECT_TRUE(names.insert(setting.name).second);
        EXPECT_EQ(setting.complaint(setting.get(TypeParam())), "");
        EXPECT_EQ(findSetting<TypeParam>(setting.name), &setting);
        EXPECT_NE(setting.invalidates, Invalidation::Nothing);
        // A whole sentence.
        ASSERT_FALSE(setting.meaning.empty());
        EXPECT_EQ(setting.meaning.back(), '.');
        EXPECT_TRUE(std::isupper(static_cast<unsigned char>(setting.meaning.front())));
    }
    EXPECT_EQ(findSetting<TypeParam>("colour"), nullptr);
}

TYPED_TEST(SettingsTable, EachTextReadsBackAsTheSameValue)
{
    for (const Setting<TypeParam>& setting : settingsOf<TypeParam>())
        for (const SettingValue& value : {setting.get(TypeParam()), otherValue(setting)})
        {
            SCOPED_TRACE(setting.name);
            const Result<SettingValue> again = setting.read(setting.text(value), setting.key());
            ASSERT_TRUE(again) << again.error().message;
            TypeParam was, is;
            setting.set(was, value);
            setting.set(is, *again);
            EXPECT_TRUE(setting.same(was, is));
        }
    // Digits that a float does not have.
    const Setting<SkyLight>& azimuth = *findSetting<SkyLight>("sun-azimuth");
    const SettingValue third = Numbers{1000.0 / 3.0 - 200.0};
    EXPECT_EQ(*azimuth.read(azimuth.text(third), "x"), third);
}

TYPED_TEST(SettingsTable, EqualityAndChangesSeeEveryRow)
{
    for (const Setting<TypeParam>& setting : settingsOf<TypeParam>())
    {
        SCOPED_TRACE(setting.name);
        TypeParam before, after;
        EXPECT_TRUE(before == after);
        const SettingValue other = otherValue(setting);
        setting.set(after, other);
        EXPECT_EQ(setting.get(after), other);
        EXPECT_FALSE(before == after);
        if constexpr (!std::is_same_v<TypeParam, KeyLight>)
        {
            EXPECT_EQ(changed(before, after), setting.invalidates);
            EXPECT_EQ(changed(after, after), Invalidation::Nothing);
        }
        setting.set(after, setting.get(before));
        EXPECT_TRUE(before == after);
    }
}

TEST(SettingsTableRows, CoverEveryMember)
{
    // These do not compile once a member is added: then the table needs a row for it.
    [[maybe_unused]] const auto& [azimuths, quality, bounces, method, subsampling, interval, albedo,
                                  gloss, exponent, transfer, viewer, edges, cones, radius,
                                  exposure] = LightingSettings();
    EXPECT_EQ(settingsOf<LightingSettings>().size(), 15u);
    [[maybe_unused]] const auto& [sky, model, skyRadiance, turbidity, environment, heading, gain,
                                  harmonics, keys, sun, sunAzimuth, sunElevation, irradiance,
                                  sunRadius] = SkyLight();
    EXPECT_EQ(settingsOf<SkyLight>().size() + 1, 14u); // the environment is no row
    [[maybe_unused]] const auto& [azimuth, width, lowest, highest, radiance] = KeyLight();
    EXPECT_EQ(settingsOf<KeyLight>().size(), 5u);
}

TYPED_TEST(SettingsTable, WhatIsBeyondARangeIsRefusedByName)
{
    for (const Setting<TypeParam>& setting : settingsOf<TypeParam>())
    {
        const bool number = setting.form.kind != ValueForm::Kind::Name && setting.form.count > 0;
        std::vector<std::string> bad = {"", "none of them", "1,2", "nan"};
        if (number)
            for (double value :
                 {setting.form.maximum * 1.01 + 1.0, std::nextafter(setting.form.minimum, -1e300)})
                bad.push_back(numberText(value));
        for (const std::string& text : bad)
        {
            if (text.empty() && setting.form.kind != ValueForm::Kind::Name && !number)
                continue; // an empty list
            SCOPED_TRACE(setting.name + " = " + text);
            const Result<SettingValue> read = setting.read(text, "called");
            ASSERT_FALSE(read);
            EXPECT_EQ(read.error().code, ErrorCode::Invalid);
            EXPECT_EQ(read.error().message.rfind("called", 0), 0u) << read.error().message;
            EXPECT_NE(read.error().message.find("needs "), std::string::npos);
            if (number)
            {
                EXPECT_NE(read.error().message.find(setting.needs()), std::string::npos);
            }
        }
    }
}

TEST(SettingsTableRows, SayWhatTheyNeed)
{
    const auto settings = [](const char* name)
    { return findSetting<LightingSettings>(name)->needs(); };
    EXPECT_EQ(settings("azimuths"), "a multiple of 4, 4 ... 256");
    EXPECT_EQ(settings("subsampling"), "a power of 2, 1 ... 4");
    EXPECT_EQ(settings("quality"), "draft, normal or best");
    EXPECT_EQ(settings("body-radius"), "a number, 0, or 1000 ... 1e+12 m");
    EXPECT_EQ(settings("albedo"), "one number or three, 0 ... 1");
    EXPECT_EQ(findSetting<SkyLight>("sun-radius")->needs(), "a number, 0.01 ... 10 degrees");
    EXPECT_EQ(findSetting<SkyLight>("sun-azimuth")->key(), "sun_azimuth");
}

TEST(SettingsTableRows, OneNumberStandsForThree)
{
    const Setting<LightingSettings>& albedo = *findSetting<LightingSettings>("albedo");
    LightingSettings settings;
    albedo.set(settings, *albedo.read("0.25", "albedo"));
    EXPECT_EQ(settings.albedo, (std::array<float, 3>{0.25f, 0.25f, 0.25f}));
    EXPECT_FALSE(albedo.read("0.1,0.2", "albedo"));
}

TEST(Problems, AreFoundOneByOneAndTogether)
{
    LightingSettings settings;
    SkyLight sky;
    EXPECT_TRUE(problems(settings, sky).empty());
    EXPECT_TRUE(problems(settings, sky, SettingsUse::Choice).empty());

    settings.azimuths = 30;
    sky.sunElevation = 95.0;
    auto found = problems(settings, sky);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].sentence, "azimuths = 30: needs a multiple of 4, 4 ... 256");
    EXPECT_EQ(found[1].sentence, "sun-elevation = 95 degrees: needs -90 ... 90");
    EXPECT_TRUE(found[0].refused && found[1].refused);

    settings = {};
    sky = {};
    settings.gloss = 0.3;
    settings.bounceMethod = BounceMethod::Legendre;
    found = problems(settings, sky);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].sentence, "gloss has no effect with bounce method legendre: needs slices");
    EXPECT_FALSE(found[0].refused);

    settings.bounceMethod = BounceMethod::Slices;
    settings.albedo = {0.1f, 0.8f, 0.1f};
    EXPECT_TRUE(problems(settings, sky).empty()); // nothing bounces
    settings.bounces = 1;
    found = problems(settings, sky);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].sentence.rfind("albedo + gloss = 1.1", 0), 0u) << found[0].sentence;
    EXPECT_FALSE(found[0].refused);
}

// Expected: by hand, from what SkyLight's members say they are for.
TEST(Problems, OfSettingsOfAnotherSky)
{
    const LightingSettings settings;
    const auto namesOf = [&](const SkyLight& sky)
    {
        std::string names;
        for (const SettingsProblem& problem : problems(settings, sky))
        {
            EXPECT_FALSE(problem.refused);
            EXPECT_EQ(problem.sentence.rfind(problem.setting + " has no effect with ", 0), 0u)
                << problem.sentence;
            names += problem.setting + " ";
        }
        return names;
    };
    SkyLight sky;
    sky.turbidity = 5.0;
    EXPECT_EQ(problems(settings, sky).front().sentence,
              "turbidity has no effect with sky uniform: needs sky clear");
    EXPECT_EQ(namesOf(sky), "turbidity ");
    sky.skyModel = SkyModel::Clear;
    EXPECT_EQ(namesOf(sky), "");
    sky.skyRadiance = {1.0f, 1.0f, 1.0f};
    EXPECT_EQ(namesOf(sky), "sky-radiance ");
    sky.skyModel = SkyModel::Overcast;
    sky.turbidity = 3.0;
    EXPECT_EQ(namesOf(sky), "");
    sky.environmentGain = 2.0;
    sky.environmentHeading = 90.0;
    EXPECT_EQ(namesOf(sky), "sky-heading sky-gain ");
    std::string problem;
    sky.environment = createEnvironment(2, 1, {{}, {}}, problem);
    ASSERT_TRUE(sky.environment) << problem;
    EXPECT_EQ(namesOf(sky), "sky-radiance sky-model ");
    sky = SkyLight();
    sky.skyHarmonics = {{1.0f, 1.0f, 1.0f}};
    EXPECT_EQ(namesOf(sky), "");
    sky.turbidity = 5.0;
    sky.skyModel = SkyModel::Clear;
    EXPECT_EQ(namesOf(sky), "turbidity sky-model ");
}

TEST(Problems, OfAChoiceByBudget)
{
    LightingSettings settings;
    SkyLight sky;
    sky.keyLights = {KeyLight()};
    EXPECT_TRUE(problems(settings, sky).empty());
    ASSERT_EQ(problems(settings, sky, SettingsUse::Choice).size(), 1u);
    EXPECT_TRUE(problems(settings, sky, SettingsUse::Choice)[0].refused);
    sky.keyLights.clear();
    sky.skyModel = SkyModel::Clear;
    EXPECT_EQ(problems(settings, sky, SettingsUse::Choice).size(), 1u);
    settings.bounceMethod = BounceMethod::Legendre;
    EXPECT_EQ(problems(settings, sky, SettingsUse::Choice).size(), 2u);
}
