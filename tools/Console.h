#pragma once

#include <osgTerrainLight/SkyLight.h>

#include "core/Result.h"

#include <chrono>
#include <cstddef>
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

/// "about 3 min left"; seconds ≥ 0.
std::string timeLeft(double seconds);

/// Lines of a run that takes long. On a terminal each stands in the place of the one before;
/// elsewhere one comes every few seconds at most, but for those that must be seen.
class ProgressLines
{
public:
    explicit ProgressLines(bool quiet);
    ~ProgressLines();
    ProgressLines(const ProgressLines&) = delete;
    ProgressLines& operator=(const ProgressLines&) = delete;
    void say(const std::string& line, bool mustBeSeen = false);

private:
    bool _quiet, _isTerminal;
    std::size_t _width = 0; ///< of the line that stands on the terminal
    std::chrono::steady_clock::time_point _last;
};

/// While one lives, a signal that people or batch systems end programs with says a sentence first.
class LastWords
{
public:
    LastWords();
    ~LastWords();
    LastWords(const LastWords&) = delete;
    LastWords& operator=(const LastWords&) = delete;
    void set(const std::string& sentence);
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
