#include "Console.h"

#include <cpl_conv.h>
#include <gdal_priv.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <iostream>

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
