#include "Console.h"

#include <cpl_conv.h>
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <utility>

#include <unistd.h>

namespace osgTerrainLight::tool
{
namespace
{

volatile std::sig_atomic_t waitingSignal = 0;
int deferring = 0; ///< objects that live
std::array<struct sigaction, _NSIG> previous;

bool isFault(int signal)
{
    return signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL;
}

/// A fault of the program itself comes again as soon as this returns, and ends it.
void keepSignal(int signal, siginfo_t* info, void*)
{
    if (isFault(signal) && info->si_code > 0)
        sigaction(signal, &previous[static_cast<std::size_t>(signal)], nullptr);
    else
        waitingSignal = signal;
}

/// Whether a signal ends a program that does nothing about it.
bool endsPrograms(int signal)
{
    for (const int other : {SIGCHLD, SIGCONT, SIGURG, SIGWINCH, SIGTSTP, SIGTTIN, SIGTTOU})
        if (signal == other)
            return false;
    return true;
}

/// Of every signal that can be caught and is not ignored, as nohup does, and shells for what runs
/// in the background.
template <class Action>
void forEachSignal(const Action& action)
{
    for (int signal = 1; signal < _NSIG; ++signal)
    {
        struct sigaction now = {};
        if (endsPrograms(signal) && sigaction(signal, nullptr, &now) == 0 &&
            now.sa_handler != SIG_IGN)
            action(signal, now);
    }
}

} // namespace

std::string text(double value)
{
    return CPLSPrintf("%.10g", value);
}

void complain(const std::string& sentence)
{
    // GDAL ends some of its messages with a line break.
    std::cerr << "terrainlight: " << sentence.substr(0, sentence.find_last_not_of(" \n") + 1)
              << std::endl;
}

void warn(const std::string& sentence)
{
    complain("warning: " + sentence);
}

Progress::~Progress()
{
    if (!_quiet && _reached >= 0.0 && _reached < 1.0)
        std::cout << std::endl;
}

void Progress::reach(double fraction)
{
    if (_quiet || fraction <= _reached)
        return;
    _reached = std::min(fraction, 1.0);
    GDALTermProgress(_reached, nullptr, nullptr);
}

std::string timeLeft(double seconds)
{
    const double minutes = std::ceil(seconds / 60.0);
    if (seconds < 1.0)
        return "about 1 s left";
    if (seconds < 60.0)
        return CPLSPrintf("about %.0f s left", seconds);
    if (minutes < 100.0)
        return CPLSPrintf("about %.0f min left", minutes);
    return CPLSPrintf("about %.1f h left", minutes / 60.0);
}

ProgressLines::ProgressLines(bool quiet) : _quiet(quiet), _isTerminal(isatty(STDOUT_FILENO) == 1) {}

ProgressLines::~ProgressLines()
{
    if (_width > 0)
        std::cout << std::endl;
}

void ProgressLines::say(const std::string& line, bool mustBeSeen)
{
    constexpr std::chrono::seconds pause{3};
    const auto now = std::chrono::steady_clock::now();
    if (_quiet || (!_isTerminal && !mustBeSeen && now - _last < pause))
        return;
    _last = now;
    if (!_isTerminal)
    {
        std::cout << line << std::endl;
        return;
    }
    const std::size_t before = std::exchange(_width, line.size());
    std::cout << '\r' << line << std::string(std::max(before, _width) - _width, ' ') << std::flush;
}

namespace
{

constexpr std::array<int, 4> endings = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
/// Two, so that a signal never meets one that is being written.
std::array<std::array<char, 1024>, 2> lastWords;
volatile std::sig_atomic_t currentWords = 0;

void sayLastWords(int signal)
{
    const auto& words = lastWords[static_cast<std::size_t>(currentWords)];
    const ssize_t written = write(STDERR_FILENO, words.data(), std::strlen(words.data()));
    static_cast<void>(written);
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

} // namespace

LastWords::LastWords()
{
    set("");
    for (const int signal : endings)
        if (std::signal(signal, sayLastWords) == SIG_IGN)
            std::signal(signal, SIG_IGN);
}

LastWords::~LastWords()
{
    for (const int signal : endings)
        if (std::signal(signal, SIG_DFL) == SIG_IGN)
            std::signal(signal, SIG_IGN);
}

void LastWords::set(const std::string& sentence)
{
    auto& words = lastWords[static_cast<std::size_t>(1 - currentWords)];
    const std::string line =
        sentence.empty() ? "" : "terrainlight: " + sentence.substr(0, words.size() - 20) + "\n";
    std::copy(line.begin(), line.end(), words.begin());
    words[line.size()] = '\0';
    currentWords = 1 - currentWords;
}

DeferredSignals::DeferredSignals()
{
    if (deferring++ > 0)
        return;
    struct sigaction keep = {};
    keep.sa_sigaction = keepSignal;
    keep.sa_flags = SA_SIGINFO | SA_RESTART;
    forEachSignal(
        [&keep](int signal, const struct sigaction& now)
        {
            previous[static_cast<std::size_t>(signal)] = now;
            sigaction(signal, &keep, nullptr); // SIGKILL and SIGSTOP refuse
        });
}

DeferredSignals::~DeferredSignals()
{
    if (--deferring > 0)
        return;
    forEachSignal([](int signal, const struct sigaction&)
                  { sigaction(signal, &previous[static_cast<std::size_t>(signal)], nullptr); });
    if (waitingSignal != 0)
        std::raise(waitingSignal);
}

Status DeferredSignals::check()
{
    if (waitingSignal != 0)
        return Error{ErrorCode::Failed, "interrupted"};
    return Nothing{};
}

} // namespace osgTerrainLight::tool
