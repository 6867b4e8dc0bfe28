#pragma once

#include "Options.h"
#include "core/Result.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What a run in windows keeps on disk until it is complete.
namespace osgTerrainLight::tool
{

/// Names and values, in order.
using Lines = std::vector<std::pair<std::string, std::string>>;

/// A locked file; the lock goes with the object, or with the program, however that ends.
class FileLock
{
public:
    enum class Kind
    {
        Shared,
        Exclusive
    };
    FileLock() = default;
    explicit FileLock(const std::string& path); ///< opened, not locked yet
    ~FileLock();
    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&& other) noexcept;

    /// False where another program holds it, unless `waits`.
    bool lock(Kind kind, bool waits = false);
    /// Whether the file that was opened still has its name.
    bool isThere() const;

private:
    std::string _path;
    int _file = -1;
};

/// A hidden folder beside an output with one file per window, and a list of all that they depend
/// on. It survives the program: the next run of the same command takes what is there.
///
/// A run locks the folder for itself; jobs share it and lock their shares. A part gets its name
/// once it is complete, so that what has a name is right, whenever a program was killed.
class Parts
{
public:
    /// Opens the folder of an output, or makes it. fingerprint: where it is not that of the parts
    /// in there, they go, unless others are at work on them. decide: asked once for what all runs
    /// are to keep to. An error where another run is at work.
    static Result<std::unique_ptr<Parts>> open(const std::string& output, const Lines& fingerprint,
                                               const std::optional<Job>& job,
                                               const std::function<Result<Lines>()>& decide);
    /// Whether a run left such a folder with this fingerprint, or another is at work in it.
    static bool wait(const std::string& output, const std::function<Lines()>& fingerprint);

    /// Empty, or why parts that were there are of no use.
    const std::string& whyAnew() const { return _whyAnew; }
    /// A line of what was decided; empty where it was not.
    std::string decided(const std::string& name) const;

    const std::string& folder() const { return _folder; }
    std::string path(int window) const;
    bool has(int window) const;
    /// How many of so many windows there are.
    int count(int windows) const;

    /// Removes the folder. Not for jobs.
    void remove();

private:
    explicit Parts(const std::string& output);
    Status lock(const std::optional<Job>& job);
    Status follow(const Lines& fingerprint, const std::optional<Job>& job,
                  const std::function<Result<Lines>()>& decide);
    Status failed(const std::string& what) const;

    std::string _output, _folder, _whyAnew;
    Lines _decided;
    FileLock _setup, _use, _share;
};

} // namespace osgTerrainLight::tool
