#pragma once

#include "core/Result.h"
#include <osgTerrainLight/SkyLight.h>

#include <string>
#include <vector>

namespace osgTerrainLight
{

constexpr const char* keyLightForm = "azimuth,width,lowest,highest, then nothing, a radiance or "
                                     "red,green,blue";

/// A key light as numbers: azimuth, width, lowest, highest, red, green, blue.
constexpr std::size_t numbersPerKeyLight = 7;
std::vector<double> numbersOf(const KeyLight& key);
/// Precondition: seven numbers from there on.
KeyLight keyLightOf(const double* numbers);

/// "azimuth, width, lowest, highest[, radiance]": four numbers, or five, or seven where radiance is
/// a colour.
Result<KeyLight> readKeyLight(const std::string& text);

/// Several of these with semicolons between them, seven numbers each.
Result<std::vector<double>> readKeyLights(const std::string& text);

/// Empty where there are not too many and all are legal, else what is wrong.
std::string keyLightsComplaint(const std::vector<double>& numbers);

/// Empty where every value is legal; else a sentence that names the first that is not.
std::string complaint(const KeyLight& key);

} // namespace osgTerrainLight
