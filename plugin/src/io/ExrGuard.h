#pragma once

#include "core/Result.h"

#include <exception>
#include <new>
#include <string>

namespace osgTerrainLight
{

/// What can be told of an OpenEXR file before the library reads it: that it is there, and that
/// attributes are as long as they claim, since the library allocates what one claims, gigabytes for
/// a file of a few bytes.
Status checkExrFile(const std::string& path);

/// What `read` gives, a Result, where checkExrFile() finds nothing. Whatever OpenEXR throws and
/// lack of memory become errors that name the path.
template <class Read>
auto readGuarded(const std::string& path, const Read& read) -> decltype(read())
{
    if (const Status checked = checkExrFile(path); !checked)
        return checked.error();
    try
    {
        return read();
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed, path + ": not enough memory for its pixels"};
    }
    // Iex::BaseExc, and what a damaged file makes the library's own containers throw.
    catch (const std::exception& error)
    {
        return Error{ErrorCode::Invalid, path + ": cannot be read as OpenEXR: " + error.what()};
    }
}

} // namespace osgTerrainLight
