#include "io/GdalErrors.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>

#include <mutex>

namespace osgTerrainLight
{
namespace
{
constexpr const char* propertiesOption = "CPL_VSIL_GZIP_WRITE_PROPERTIES";

void CPL_STDCALL keepError(CPLErr level, CPLErrorNum, const char* message)
{
    if (auto* errors = static_cast<GdalErrors*>(CPLGetErrorHandlerUserData()))
        errors->add(level >= CE_Failure, message);
}
} // namespace

GdalErrors::GdalErrors() : _keepsProperties(CPLGetConfigOption(propertiesOption, nullptr))
{
    static std::once_flag once;
    std::call_once(once, [] { GDALAllRegister(); });
    if (!_keepsProperties)
        CPLSetThreadLocalConfigOption(propertiesOption, "NO");
    CPLPushErrorHandlerEx(keepError, this);
    // CPL_DEBUG stays the user's to switch on.
    CPLSetCurrentErrorHandlerCatchDebug(FALSE);
}

GdalErrors::~GdalErrors()
{
    CPLPopErrorHandler();
    if (!_keepsProperties)
        CPLSetThreadLocalConfigOption(propertiesOption, nullptr);
}

void GdalErrors::add(bool failure, const char* message)
{
    if (!failure)
        _warnings.emplace_back(message);
    else
    {
        if (_firstFailure.empty())
            _firstFailure = message;
        _lastFailure = message;
    }
}

void GdalErrors::clear()
{
    _firstFailure.clear();
    _lastFailure.clear();
    _warnings.clear();
}

std::string GdalErrors::first() const
{
    if (!_firstFailure.empty())
        return _firstFailure;
    return _warnings.empty() ? "GDAL gives no reason" : _warnings.back();
}

std::string GdalErrors::warningWith(const std::string& words) const
{
    for (const std::string& warning : _warnings)
        if (warning.find(words) != std::string::npos)
            return warning;
    return {};
}

std::string GdalErrors::last() const
{
    return _lastFailure.empty() ? first() : _lastFailure;
}

} // namespace osgTerrainLight
