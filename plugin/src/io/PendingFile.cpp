#include "io/PendingFile.h"

#include <cpl_multiproc.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace osgTerrainLight
{

namespace
{
namespace fs = std::filesystem;
const std::string prefix = ".partial-";

std::string systemsReason(int number)
{
    return std::generic_category().message(number);
}

/// Empty, or why a file of so many bytes cannot be written: by a block at its end, since a limit
/// counts the length and a disk what is written.
std::string complaintOfSystem(const std::string& path, double bytes)
{
    const std::vector<char> block(static_cast<std::size_t>(std::clamp(bytes, 1.0, 65536.0)), 'x');
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file)
        return systemsReason(errno);
    errno = 0;
    const double start = std::max(bytes - static_cast<double>(block.size()), 0.0);
    const bool placed = fseeko(file, static_cast<off_t>(start), SEEK_SET) == 0;
    const bool written = placed && std::fwrite(block.data(), 1, block.size(), file) == block.size();
    const int number = errno;
    const bool closed = std::fclose(file) == 0; // a failed one closes, too
    const int last = errno;
    std::remove(path.c_str());
    return written && closed ? std::string() : systemsReason(written ? last : number);
}

/// Waits until a file is on its disk, so that a name never stands for less after a power failure.
/// Files that are not on one have no such moment.
bool reachesDisk(const std::string& path)
{
    const int file = path.rfind("/vsi", 0) == 0 ? -1 : open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return true;
    const bool synced = fsync(file) == 0 || errno == EINVAL || errno == EROFS;
    const int number = errno;
    close(file);
    errno = number;
    return synced;
}
} // namespace

std::string withoutLinks(const std::string& path)
{
    fs::path at = path;
    std::error_code failure;
    constexpr int mostLinks = 40; // as many as Linux follows
    for (int links = 0; links < mostLinks && fs::is_symlink(at, failure); ++links)
        at = at.parent_path() / fs::read_symlink(at, failure);
    return at.string();
}

PendingFile::PendingFile(std::string target, std::string scratch)
    : _target(std::move(target)), _scratch(std::move(scratch))
{
}

PendingFile::~PendingFile()
{
    if (!_folder.empty())
        VSIRmdirRecursive(_folder.c_str());
}

Status PendingFile::create(bool overwrite)
{
    const auto refused = [&](const std::string& why) {
        return Error{ErrorCode::Failed, _target + ": " + why};
    };
    VSIStatBufL stat;
    errno = 0;
    const bool there = VSIStatL(_target.c_str(), &stat) == 0;
    if (!there && errno == ENAMETOOLONG)
        return refused(systemsReason(errno));
    if (there)
    {
        if (VSI_ISDIR(stat.st_mode))
            return refused("is a folder; needed the name of a file");
        // A device or a pipe would be replaced by the file that is moved over it.
        if (!VSI_ISREG(stat.st_mode))
            return refused("is a device or a pipe; needed the name of a file");
        if (!overwrite)
            return refused("exists already, and overwriting was not asked for");
    }
    static std::atomic<unsigned> counter{0};
    _place = withoutLinks(_target);
    _parent = fs::path(_place).parent_path().string();
    _name = fs::path(_place).filename().string();
    // Not by the target's name, which may be as long as names can be.
    const std::string name =
        prefix + std::to_string(CPLGetCurrentProcessID()) + "-" + std::to_string(counter++);
    const std::string folder = _scratch.empty() ? beside(name) : _scratch + "/" + name;
    errno = 0;
    if (_name.empty() || VSIMkdir(folder.c_str(), 0700) != 0)
        return refused("cannot write into " + (_parent.empty() ? "this folder" : _parent) +
                       (errno != 0 ? ": " + systemsReason(errno) : "") +
                       "; needed an existing folder with leave to write");
    _folder = folder;
    return Nothing{};
}

std::string PendingFile::reason(const std::string& said, double bytes,
                                const std::string& suffix) const
{
    std::string plain = said.substr(0, said.find_last_not_of(" \n") + 1);
    const std::string written = path();
    for (std::size_t at = 0; (at = plain.find(written, at)) != std::string::npos;)
    {
        plain.replace(at, written.size(), _target);
        at += _target.size();
    }
    const bool isOnDisk = !_folder.empty() && _folder.compare(0, 4, "/vsi") != 0;
    const std::string system =
        isOnDisk ? complaintOfSystem(suffix.empty() ? inside(".room") : path() + suffix, bytes)
                 : "";
    return system.empty() ? plain : plain.empty() ? system : system + " (" + plain + ")";
}

bool PendingFile::isFolderOfOne(const std::string& name)
{
    return name.compare(0, prefix.size(), prefix) == 0;
}

Status PendingFile::commit()
{
    const auto failed = [](const std::string& path, const char* what)
    {
        return Error{ErrorCode::Failed,
                     path + ": " + what + (errno != 0 ? ": " + systemsReason(errno) : "")};
    };
    const CPLStringList names(VSIReadDir(_folder.c_str()));
    std::error_code failure;
    if (const fs::file_status old = fs::status(_place, failure); fs::is_regular_file(old))
        for (int i = 0; i < names.size(); ++i)
            if (fs::is_regular_file(inside(names[i]), failure))
                fs::permissions(inside(names[i]), old.permissions(), failure);
    errno = 0;
    if (!reachesDisk(path()))
        return failed(_target, "cannot be completed");
    errno = 0;
    if (VSIRename(path().c_str(), _place.c_str()) != 0)
        return failed(_target, "cannot be replaced by the file written");
    for (const char* stale : {".aux.xml", ".ovr", ".msk"})
        VSIUnlink((_place + stale).c_str());
    for (int i = 0; i < names.size(); ++i)
    {
        const std::string name = names[i];
        if (name == "." || name == ".." || name == _name)
            continue;
        errno = 0;
        if (VSIRename(inside(name).c_str(), beside(name).c_str()) != 0)
            return failed(beside(name), "cannot be written");
    }
    return Nothing{};
}

std::string PendingFile::beside(const std::string& name) const
{
    return (fs::path(_parent) / name).string();
}

} // namespace osgTerrainLight
