#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "core/Raster.h"

#include <array>
#include <vector>

namespace osgTerrainLight
{

/// Whether the sky's radiance depends on direction: it then needs a table per slice.
bool skyHasTable(const SkyLight& sky);

/// The sky of SkyLight::skyModel, environment and harmonics left aside, towards a unit direction
/// (x east, y north, z up) with z ≥ 0; the sun's disc is not in it. In double, for tests and few
/// directions; sky_model.comp has the same functions.
std::array<double, 3> modelRadiance(const SkyLight& sky, const std::array<double, 3>& direction);

/// The sky without its environment as a picture for the eye, laid out as Environment::radiance,
/// 2 n × n texels, values of their middles; n even. The sun's disc is not in it, and radiance of
/// harmonics that is below 0 is 0. Below the horizontal there is level ground of an albedo, lit by
/// the sky and by a sun (irradiance on a surface that faces it), which 10 degrees of haze hide.
Raster<Rgb> skyPicture(const SkyLight& sky, int n, const Rgb& albedo, const Rgb& sun);

/// 16 coefficients of the sky, of whichever kind it is, turned and multiplied; for what works in
/// harmonics.
std::vector<Rgb> harmonicsOf(const SkyLight& sky);

/// Irradiance on a surface that faces the unoccluded sun, at the ground: sunIrradiance, less what
/// the air of SkyModel::Clear takes.
Rgb sunAtGround(const SkyLight& sky);

} // namespace osgTerrainLight
