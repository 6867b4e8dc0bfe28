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

// All that end a program and can be caught, but for those of its own faults. SIGPIPE and SIGXFSZ
// come from writing itself, which then fails as on a full disk.
constexpr std::array<int, DeferredSignals::count> signals = {SIGHUP,  SIGINT,    SIGQUIT, SIGTERM,
                                                             SIGPIPE, SIGALRM,   SIGUSR1, SIGUSR2,
                                                             SIGXCPU, SIGVTALRM, SIGPROF, SIGXFSZ};
volatile std::sig_atomic_t waitingSignal = 0;

void keepSignal(int signal)
{
    waitingSignal = signal;
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
    for (std::size_t i = 0; i < signals.size(); ++i)
    {
        _previous[i] = std::signal(signals[i], keepSignal);
        if (_previous[i] == SIG_IGN) // as nohup does, and shells for what runs in the background
            std::signal(signals[i], SIG_IGN);
    }
}

DeferredSignals::~DeferredSignals()
{
    for (std::size_t i = 0; i < signals.size(); ++i)
        std::signal(signals[i], _previous[i]);
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
