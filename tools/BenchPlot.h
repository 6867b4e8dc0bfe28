#pragma once

#include "core/Result.h"

#include <string>
#include <vector>

/// `terrainlight bench`: pictures by gnuplot.
namespace osgTerrainLight::tool::bench
{

/// Output of gnuplot for a script. Both travel through pipes: no shell reads them, and gnuplot
/// opens no file (-d: not even its user's settings).
Result<std::string> runGnuplot(const std::string& script);

/// A string of the script: nothing in it is special to gnuplot, and it is legal in XML.
std::string quoted(std::string text);

/// A logarithmic axis around values > 0, with room for labels beside the points; labelled 1, 2, 5.
std::string logarithmic(const char* axis, const std::vector<double>& values);

} // namespace osgTerrainLight::tool::bench
