#pragma once

#include "glsl_host.h"

#include <gtest/gtest.h>

#include <limits>

namespace osgTerrainLight
{

/// The precisions that shaders/lib is compiled in on the CPU.
using Precisions = testing::Types<float, double>;

/// The shared functions as the tests call them: with their preconditions checked in every build.
template <class Real>
using CheckedGlsl = Glsl<Real, true>;

/// Half a unit in the last place of 1: the relative error of one rounded operation.
template <class Real>
constexpr double roundoff = static_cast<double>(std::numeric_limits<Real>::epsilon()) / 2.0;

} // namespace osgTerrainLight
