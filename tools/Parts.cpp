#include "Parts.h"

#include "Console.h"
#include "io/PendingFile.h"

#include <cpl_string.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace osgTerrainLight::tool
{
namespace
{
namespace fs = std::filesystem;

constexpr char manifestName[] = "manifest.txt";
constexpr char decidedMark[] = "--- decided";

std::string folderOf(const std::string& output)
{
    const fs::path place = withoutLinks(output);
    return (place.parent_path() / ("." + place.filename().string() + ".windows")).string();
}

std::string onOneLine(std::string text)
{
    for (std::size_t at = 0; (at = text.find_first_of("\n\\", at)) != std::string::npos; at += 2)
        text.replace(at, 1, text[at] == '\n' ? "\\n" : "\\\\");
    return text;
}

std::string textOf(const Lines& fingerprint, const Lines& decided)
{
    std::string text;
    for (const auto& [name, value] : fingerprint)
        text += onOneLine(name) + "=" + onOneLine(value) + "\n";
    text += std::string(decidedMark) + "\n";
    for (const auto& [name, value] : decided)
        text += onOneLine(name) + "=" + onOneLine(value) + "\n";
    return text + "--- end\n";
}

struct Manifest
{
    Lines fingerprint, decided;
};

/// Nothing where there is none, or only a part of one.
std::optional<Manifest> readManifest(const std::string& path)
{
    std::ifstream file(path);
    Manifest found;
    Lines* into = &found.fingerprint;
    for (std::string line; std::getline(file, line);)
    {
        if (line == "--- end")
            return found;
        if (line == decidedMark)
            into = &found.decided;
        else if (const std::size_t sign = line.find('='); sign != std::string::npos)
            into->emplace_back(line.substr(0, sign), line.substr(sign + 1));
    }
    return std::nullopt;
}

const std::string* find(const Lines& lines, const std::string& name)
{
    for (const auto& [key, value] : lines)
        if (key == onOneLine(name))
            return &value;
    return nullptr;
}

/// Empty, or the first difference, for people.
std::string difference(const Lines& before, const Lines& now)
{
    const auto quoted = [](const std::string* value)
    { return value ? "'" + *value + "'" : std::string("not given"); };
    const auto told = [&](const std::string& name, const std::string* was, const std::string* is)
    {
        constexpr char file[] = "file ";
        return name.rfind(file, 0) == 0 && was && is
                   ? name.substr(sizeof file - 1) + " has changed"
                   : name + " was " + quoted(was) + ", now it is " + quoted(is);
    };
    for (const auto& [name, value] : now)
    {
        const std::string is = onOneLine(value);
        const std::string* was = find(before, name);
        if (!was || *was != is)
            return told(name, was, &is);
    }
    for (const auto& [name, value] : before)
        if (!find(now, name))
            return told(name, &value, nullptr);
    return {};
}

} // namespace

FileLock::FileLock(const std::string& path)
    : _path(path), _file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666))
{
}

FileLock::~FileLock()
{
    if (_file >= 0)
        ::close(_file);
}

FileLock::FileLock(FileLock&& other) noexcept
    : _path(std::move(other._path)), _file(std::exchange(other._file, -1))
{
}

FileLock& FileLock::operator=(FileLock&& other) noexcept
{
    std::swap(_path, other._path);
    std::swap(_file, other._file);
    return *this;
}

bool FileLock::lock(Kind kind, bool waits)
{
    const int how = kind == Kind::Shared ? LOCK_SH : LOCK_EX;
    // A program that was killed keeps its locks until all of its threads are gone.
    constexpr int turns = 20;
    for (int turn = 0; turn < turns; ++turn)
    {
        if (flock(_file, waits ? how : how | LOCK_NB) == 0)
            return true;
        if (errno == EWOULDBLOCK)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        else if (errno != EINTR)
            break;
    }
    if (errno == EWOULDBLOCK)
        return false;
    static bool said = false;
    if (!std::exchange(said, true))
        warn(_path + ": this file system has no locks (" + std::generic_category().message(errno) +
             "): nothing keeps two runs from writing the same parts");
    return true;
}

bool FileLock::isThere() const
{
    struct stat opened = {};
    struct stat named = {};
    return _file >= 0 && fstat(_file, &opened) == 0 && stat(_path.c_str(), &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

Parts::Parts(const std::string& output) : _output(output), _folder(folderOf(output)) {}

bool Parts::wait(const std::string& output, const std::function<Lines()>& fingerprint)
{
    const std::optional<Manifest> found = readManifest(folderOf(output) + "/" + manifestName);
    return found && (difference(found->fingerprint, fingerprint()).empty() ||
                     !FileLock(folderOf(output) + "/use.lock").lock(FileLock::Kind::Exclusive));
}

std::string Parts::path(int window) const
{
    return _folder + CPLSPrintf("/window-%06d.tif", window + 1);
}

bool Parts::has(int window) const
{
    std::error_code failure;
    return fs::exists(path(window), failure);
}

int Parts::count(int windows) const
{
    int there = 0;
    for (int window = 0; window < windows; ++window)
        there += has(window);
    return there;
}

std::string Parts::decided(const std::string& name) const
{
    const std::string* value = find(_decided, name);
    return value ? *value : std::string();
}

Status Parts::failed(const std::string& what) const
{
    const int number = errno;
    return Error{ErrorCode::Failed,
                 _output + ": " + what +
                     (number != 0 ? ": " + std::generic_category().message(number) : "")};
}

Result<std::unique_ptr<Parts>> Parts::open(const std::string& output, const Lines& fingerprint,
                                           const std::optional<Job>& job,
                                           const std::function<Result<Lines>()>& decide)
{
    std::unique_ptr<Parts> parts(new Parts(output));
    if (Status locked = parts->lock(job); !locked)
        return locked.error();
    if (Status followed = parts->follow(fingerprint, job, decide); !followed)
        return followed.error();
    parts->_setup = FileLock();
    return parts;
}

/// Takes the lock of those who set up first: until it is given back no other comes or goes.
Status Parts::lock(const std::optional<Job>& job)
{
    const auto taken = [&](const std::string& who)
    {
        return Error{ErrorCode::Failed, _output + ": " + who + " is at work on it already, in " +
                                            _folder +
                                            "; needed its end, or another name for the output"};
    };
    do
    {
        errno = 0;
        if (::mkdir(_folder.c_str(), 0777) != 0 && errno != EEXIST)
            return failed("cannot make a folder for windows beside it");
        _setup = FileLock(_folder + "/setup.lock");
        if (!_setup.lock(FileLock::Kind::Exclusive, true))
            return failed("cannot lock its folder of windows");
    } while (!_setup.isThere() && errno != EACCES && errno != EROFS && errno != ENOSPC);
    if (!_setup.isThere())
        return failed("cannot write into its folder of windows");
    _use = FileLock(_folder + "/use.lock");
    if (!_use.lock(job ? FileLock::Kind::Shared : FileLock::Kind::Exclusive))
        return taken(job ? "a run" : "another run");
    if (!job)
        return Nothing{};
    const std::string share = std::to_string(job->index) + "-of-" + std::to_string(job->count);
    _share = FileLock(_folder + "/job-" + share + ".lock");
    if (!_share.lock(FileLock::Kind::Exclusive))
        return taken("the same job, --job " + std::to_string(job->index) + "/" +
                     std::to_string(job->count) + ",");
    return Nothing{};
}

Status Parts::follow(const Lines& fingerprint, const std::optional<Job>& job,
                     const std::function<Result<Lines>()>& decide)
{
    const std::string manifest = _folder + "/" + manifestName;
    const std::optional<Manifest> found = readManifest(manifest);
    const std::string other = found ? difference(found->fingerprint, fingerprint) : std::string();
    std::error_code failure;
    if (!other.empty() && job && !_use.lock(FileLock::Kind::Exclusive))
        return Error{ErrorCode::Failed, _output +
                                            ": other jobs are at work on it with other input "
                                            "or options: " +
                                            other};
    // What a killed run was writing stays in folders of no use; those of jobs may be in use.
    std::vector<fs::path> entries;
    for (const auto& entry : fs::directory_iterator(_folder, failure))
        entries.push_back(entry.path());
    for (const fs::path& entry : entries)
    {
        const std::string name = entry.filename().string();
        const bool isPart =
            name.rfind("window-", 0) == 0 || name.rfind("light-", 0) == 0 || name == manifestName;
        if ((!job && name[0] == '.') || (isPart && (!found || !other.empty())))
            fs::remove_all(entry, failure);
    }
    if (job && !_use.lock(FileLock::Kind::Shared))
        return Error{ErrorCode::Failed, _output + ": another run is at work on it"};
    if (found && other.empty())
    {
        _decided = found->decided;
        return Nothing{};
    }
    _whyAnew = other;
    const Result<Lines> decided = decide();
    if (!decided)
    {
        if (!job) // nothing was done: nothing stays
            fs::remove_all(_folder, failure);
        return decided.error();
    }
    _decided = *decided;
    errno = 0;
    PendingFile file(manifest, _folder);
    if (Status made = file.create(true); !made)
        return made;
    {
        std::ofstream stream(file.path());
        stream << textOf(fingerprint, _decided);
        stream.close();
        if (!stream)
            return Error{ErrorCode::Failed,
                         _output + ": " + file.reason("cannot be begun", 4096.0)};
    }
    return file.commit();
}

/// Those who come meanwhile wait for the lock of a file that then has no name, and begin again.
void Parts::remove()
{
    std::error_code failure;
    _setup = FileLock(_folder + "/setup.lock");
    _setup.lock(FileLock::Kind::Exclusive, true);
    fs::remove(_folder + "/" + manifestName, failure);
    fs::remove_all(_folder, failure);
}

} // namespace osgTerrainLight::tool
