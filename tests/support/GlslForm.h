#pragma once

#include "fields/SampledForm.h"

#include <algorithm>

/// A sampled form as shaders/lib/sampled_form.glsl takes it, for its functions in C++.
namespace osgTerrainLight
{

template <class G>
typename G::SampledForm glslForm(const SampledForm& form)
{
    typename G::SampledForm own;
    own.row = 0;
    own.side = form.side;
    own.first = form.first;
    own.spacing = form.spacing;
    own.range = form.range;
    return own;
}

inline Raster<double> inDouble(const Raster<float>& values)
{
    Raster<double> same(values.width(), values.height());
    std::copy(values.values().begin(), values.values().end(), same.values().begin());
    return same;
}

} // namespace osgTerrainLight
