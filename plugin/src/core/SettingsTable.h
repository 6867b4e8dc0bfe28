#pragma once

#include "core/SettingRow.h"
#include <osgTerrainLight/LightingSettings.h>
#include <osgTerrainLight/SkyLight.h>

#include <functional>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A row of the table of settings, and where its value is.
template <class Owner>
struct Setting : SettingRow
{
    std::function<SettingValue(const Owner&)> get;
    /// Precondition: a value that complaint() has nothing against.
    std::function<void(Owner&, const SettingValue&)> set;
    std::function<bool(const Owner&, const Owner&)> same;

    std::string textOf(const Owner& owner) const { return text(get(owner)); }
    std::string defaultText() const { return textOf(Owner()); }
};

/// The table: a row per member of LightingSettings, SkyLight (without its environment, which is a
/// picture) and KeyLight.
template <class Owner>
const std::vector<Setting<Owner>>& settingsOf();
template <>
const std::vector<Setting<LightingSettings>>& settingsOf();
template <>
const std::vector<Setting<SkyLight>>& settingsOf();
template <>
const std::vector<Setting<KeyLight>>& settingsOf();

/// What settings are chosen by (LightingSettings::forMaxError, forFrameTime).
const std::vector<SettingRow>& budgetRows();

/// By name. Null where there is no such row.
template <class Owner>
const Setting<Owner>* findSetting(const std::string& name)
{
    for (const Setting<Owner>& setting : settingsOf<Owner>())
        if (setting.name == name)
            return &setting;
    return nullptr;
}

/// What a change from a to b makes stale. An environment counts as the sky's shape and light.
Invalidation changed(const LightingSettings& a, const LightingSettings& b);
Invalidation changed(const SkyLight& a, const SkyLight& b);

/// A setting that changes nothing beside the others, whatever its value, and a sentence why.
struct IdleSetting
{
    std::string name; ///< of the row
    std::string sentence;
};
/// Gloss, with a method that has none.
std::vector<IdleSetting> idleSettings(const LightingSettings& settings);
/// What is of another kind of sky.
std::vector<IdleSetting> idleSettings(const SkyLight& sky);

/// Empty where every value is legal; else a sentence that names the first that is not.
std::string complaint(const SkyLight& sky);
std::string complaint(const LightingSettings& settings);

} // namespace osgTerrainLight
