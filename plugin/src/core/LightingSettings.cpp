#include <osgTerrainLight/LightingSettings.h>

#include "core/EnumNames.h"
#include "core/SettingsTable.h"
#include "core/SkyRadiance.h"

#include <algorithm>

namespace osgTerrainLight
{

const char* toString(HorizonQuality quality)
{
    return nameOf(quality);
}

bool fromString(const std::string& text, HorizonQuality& quality)
{
    return readName(text, quality);
}

const char* toString(BounceMethod method)
{
    return nameOf(method);
}

bool fromString(const std::string& text, BounceMethod& method)
{
    return readName(text, method);
}

const char* toString(GlossTransfer transfer)
{
    return nameOf(transfer);
}

bool fromString(const std::string& text, GlossTransfer& transfer)
{
    return readName(text, transfer);
}

namespace
{
ParameterRange rangeOf(const SettingRow& row)
{
    return {row.name, row.form.unit, row.form.minimum, row.form.maximum, row.meaning};
}

bool isNumber(const SettingRow& row)
{
    return row.form.count > 0 && row.form.kind != ValueForm::Kind::Name;
}

/// The row of a number's name: of settings, light or a budget. Null where there is none.
const SettingRow* numberRow(const std::string& name)
{
    const SettingRow* found = findSetting<LightingSettings>(name);
    if (!found)
        found = findSetting<SkyLight>(name);
    for (const SettingRow& row : budgetRows())
        if (row.name == name)
            found = &row;
    return found && isNumber(*found) ? found : nullptr;
}
} // namespace

const std::vector<ParameterRange>& ParameterRange::all()
{
    static const std::vector<ParameterRange> table = []
    {
        std::vector<ParameterRange> ranges;
        const auto add = [&](const SettingRow& row)
        {
            if (isNumber(row))
                ranges.push_back(rangeOf(row));
        };
        const auto& settings = settingsOf<LightingSettings>();
        const auto& sky = settingsOf<SkyLight>();
        std::for_each(settings.begin(), settings.end(), add);
        std::for_each(sky.begin(), sky.end(), add);
        std::for_each(budgetRows().begin(), budgetRows().end(), add);
        return ranges;
    }();
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
    const SettingRow* row = numberRow(name);
    return row ? row->complaint(value) : "";
}

std::vector<IdleSetting> idleSettings(const LightingSettings& settings)
{
    const bool bySlices = settings.bounceMethod == BounceMethod::Slices;
    const std::string needs = std::string(" has no effect with bounce method ") +
                              toString(settings.bounceMethod) + ": needs " +
                              (bySlices ? "legendre or legendre-bspline" : "slices");
    std::vector<IdleSetting> idle;
    for (const std::string& name : bySlices ? std::vector<std::string>{"subsampling"}
                                            : std::vector<std::string>{"gloss", "shadow-edges"})
        idle.push_back({name, name + needs});
    return idle;
}

std::vector<IdleSetting> idleSettings(const SkyLight& sky)
{
    std::vector<IdleSetting> idle;
    const bool ofFile = sky.environment != nullptr;
    const bool ofHarmonics = !ofFile && !sky.skyHarmonics.empty();
    const bool ofModel = !ofFile && !ofHarmonics;
    const bool clear = ofModel && sky.skyModel == SkyModel::Clear;
    const std::string kind = ofFile        ? "a sky from a file"
                             : ofHarmonics ? "sky-harmonics"
                                           : std::string("sky ") + toString(sky.skyModel);
    const auto addIf = [&](bool condition, const char* name, const char* needs)
    {
        if (condition)
            idle.push_back(
                {name, std::string(name) + " has no effect with " + kind + ": needs " + needs});
    };
    addIf(!clear, "turbidity", "sky clear");
    addIf(!ofFile, "sky-heading", "a sky from a file");
    addIf(!ofFile, "sky-gain", "a sky from a file");
    addIf(!ofModel || clear, "sky-radiance", "sky uniform or overcast");
    addIf(!ofModel, "sky-model", "a sky that is neither from a file nor sky-harmonics");
    addIf(ofFile, "sky-harmonics", "a sky that is not from a file");
    return idle;
}

namespace
{
/// Those that have no effect and are not the default.
template <class Owner>
void addIdle(std::vector<SettingsProblem>& found, const Owner& owner)
{
    for (const IdleSetting& idle : idleSettings(owner))
        if (!findSetting<Owner>(idle.name)->same(owner, Owner()))
            found.push_back({idle.sentence, false, idle.name});
}
} // namespace

std::vector<SettingsProblem> problems(const LightingSettings& settings, const SkyLight& sky,
                                      SettingsUse use)
{
    std::vector<SettingsProblem> found;
    for (const std::string& wrong : {complaint(settings), complaint(sky)})
        if (!wrong.empty())
            found.push_back({wrong, true, ""});
    addIdle(found, settings);
    addIdle(found, sky);
    const bool slices = settings.bounceMethod == BounceMethod::Slices;
    const float albedo = *std::max_element(settings.albedo.begin(), settings.albedo.end());
    const double sent = static_cast<double>(albedo) + settings.gloss;
    if (settings.bounces > 0 && sent > 1.0)
        found.push_back({"albedo + gloss = " + numberText(static_cast<float>(sent)) +
                             ": ground that sends more light than it receives; needs at most 1",
                         false, "albedo"});
    if (use == SettingsUse::Choice && !slices)
        found.push_back({std::string("settings can be chosen for bounce method slices only, not ") +
                             toString(settings.bounceMethod),
                         true, "bounce-method"});
    if (use == SettingsUse::Choice && (skyHasTable(sky) || !sky.keyLights.empty()))
        found.push_back({"settings can be chosen for a uniform sky and a sun only: needs neither "
                         "another sky nor key lights",
                         true, "sky-model"});
    return found;
}

} // namespace osgTerrainLight
