#pragma once

#include "Parts.h"
#include "Pipeline.h"
#include "Windows.h"

namespace osgTerrainLight::tool
{

/// How a window is written.
OutputOptions partOptions(const std::string& path);

/// Makes one file of all windows, reads it again, and puts it in place. Needs memory for a strip of
/// some rows. A part that cannot be read is removed, so that the next run computes it again.
Status joinParts(const Parts& parts, const WindowGrid& grid, const OutputOptions& output,
                 const Product& product, const RasterFrame& frame, const Metadata& metadata,
                 const Fraction& progress);

} // namespace osgTerrainLight::tool
