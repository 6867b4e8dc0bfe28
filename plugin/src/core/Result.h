#pragma once

#include <string>
#include <utility>
#include <variant>

namespace osgTerrainLight
{

/// Why an operation did not give a value.
enum class ErrorCode
{
    NotFound,     ///< the file or layer does not exist
    NotSupported, ///< it exists, but is not of a kind this library handles
    Invalid,      ///< it is of a handled kind, but its content cannot be used
    Elsewhere,    ///< it can be used, but lies beside what was asked for
    Failed        ///< reading, writing or the graphics library failed
};

/// An error: a code for programs and one sentence for people, which names the file, what was found
/// and what was needed.
struct Error
{
    ErrorCode code = ErrorCode::Failed;
    std::string message;
};

/// A value of type T, or the Error that explains why there is none.
template <class T>
class Result
{
public:
    Result(T value) : _state(std::move(value)) {}
    Result(Error error) : _state(std::move(error)) {}

    bool ok() const { return std::holds_alternative<T>(_state); }
    explicit operator bool() const { return ok(); }

    /// The value. Precondition: ok().
    T& value() { return std::get<T>(_state); }
    const T& value() const { return std::get<T>(_state); }
    T& operator*() { return value(); }
    const T& operator*() const { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    /// The error. Precondition: !ok().
    const Error& error() const { return std::get<Error>(_state); }

private:
    std::variant<T, Error> _state;
};

/// The result of an operation that has nothing to return.
struct Nothing
{
};
using Status = Result<Nothing>;

} // namespace osgTerrainLight
