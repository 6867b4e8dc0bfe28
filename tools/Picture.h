#pragma once

#include "Output.h"
#include "core/Raster.h"
#include "io/RasterFrame.h"

#include <functional>
#include <vector>

/// Light as pictures and OpenEXR files.
namespace osgTerrainLight::tool
{

/// Whether an output is an 8-bit picture, by its format, else by its extension.
bool isPicture(const OutputOptions& output);

/// A row of light from the north, from the west on: red, green, blue, then the visible fraction of
/// the sun, each as many values as there are columns; void is NaN.
using LightRows = std::function<Status(int row, std::vector<float>& values)>;

/// 8-bit sRGB of `gain` times the light. Void is transparent; where nothing is void there is no
/// alpha, and in a JPEG void is black.
Status writePicture(const OutputOptions& output, const RasterFrame& frame, bool hasVoids,
                    double gain, const Metadata& metadata, const LightRows& rows,
                    const std::string& scratchFolder = {});

/// R, G, B, A as half floats; void is 0. The whole file is in memory.
Status writeLightExr(const OutputOptions& output, const RasterFrame& frame,
                     const Metadata& metadata, const LightRows& rows);

} // namespace osgTerrainLight::tool
