#pragma once

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// While it lives, GDAL's errors and warnings on this thread are kept here and off stderr, and it
/// writes no .properties file beside an input in /vsigzip/, unless it is asked to.
/// Registers GDAL's drivers on first use.
class GdalErrors
{
public:
    GdalErrors();
    ~GdalErrors();
    GdalErrors(const GdalErrors&) = delete;
    GdalErrors& operator=(const GdalErrors&) = delete;

    void add(bool failure, const char* message);
    void clear();

    bool hasFailure() const { return !_firstFailure.empty(); }
    bool hasMessage() const { return hasFailure() || !_warnings.empty(); }
    /// The first warning with these words in it; empty: none.
    std::string warningWith(const std::string& words) const;
    /// The first failure is mostly the cause, the last the one that names the place; a warning
    /// stands in where there was no failure, and a fixed phrase where there was nothing.
    std::string first() const;
    std::string last() const;

private:
    std::string _firstFailure, _lastFailure;
    std::vector<std::string> _warnings;
    bool _keepsProperties; ///< as they were asked for
};

} // namespace osgTerrainLight
