#pragma once

#include "core/WedgeMatrices.h"

#include <array>

namespace osgTerrainLight
{

/// Spherical harmonics of order 4, as in WedgeMatrices.h.
using ShFunction = std::array<double, 16>;

/// The product of functions with a fixed one: M g are the harmonics of order 4 of f·g, for an f and
/// a g of order 4 (NS09, section 7: incident light is the SH product of lighting and visibility).
/// What f·g has beyond order 4 is lost.
ShMatrix<16> shProduct(const ShFunction& f);

} // namespace osgTerrainLight
