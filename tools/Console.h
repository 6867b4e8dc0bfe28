#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"

#include <string>

/// What the tool says to people: messages, progress, and signals that wait for a file.
namespace osgTerrainLight::tool
{

/// Shortest of up to 10 significant digits.
std::string text(double value);

/// "terrainlight: …" on stderr.
void complain(const std::string& sentence);
void warn(const std::string& sentence);

/// GDAL's progress line, 0 … 1; never runs backwards. Ends an unfinished line when it goes.
class Progress
{
public:
    explicit Progress(bool quiet) : _quiet(quiet) {}
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void reach(double fraction);

private:
    bool _quiet;
    double _reached = -1.0;
};

/// While one lives, every signal that would end the program waits: a file being written is removed
/// first. Then it acts. Signals of the program's own faults do not wait.
class DeferredSignals
{
public:
    DeferredSignals();
    ~DeferredSignals();
    DeferredSignals(const DeferredSignals&) = delete;
    DeferredSignals& operator=(const DeferredSignals&) = delete;
    /// An error where a signal waits.
    static Status check();
};

} // namespace osgTerrainLight::tool
