#pragma once

#include "core/Result.h"

#include <string>

namespace osgTerrainLight
{

/// The path that a link stands for, through links to links; any other path as it is. A link whose
/// file does not exist yet stands for that file.
std::string withoutLinks(const std::string& path);

/// A hidden folder beside a target that is written into under the final name, so that names inside
/// sidecar files are right, too. Until commit() the target and its sidecars are as they were; the
/// folder goes with this object, with everything in it, whatever happens.
class PendingFile
{
public:
    /// scratch: the folder that the hidden one is made in, of the target's file system; empty: that
    /// of the target.
    explicit PendingFile(std::string target, std::string scratch = {});
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    /// A target that is a link stays one: the file that it stands for is replaced. Errors name the
    /// target and the system's reason. overwrite: whether it may exist already.
    Status create(bool overwrite);

    /// Whether a name is that of such a folder, of any target. One is left by a program that was
    /// killed.
    static bool isFolderOfOne(const std::string& name);

    std::string path() const { return inside(_name); }
    std::string inside(const std::string& name) const { return _folder + "/" + name; }

    /// The reason of a failure to write: the system's own, where a file of so many bytes cannot be
    /// written in this folder (no space left, too large), with what the library said in brackets;
    /// else that alone. It names the target where the library named the file in the folder. suffix:
    /// of the sidecar that failed.
    std::string reason(const std::string& said, double bytes, const std::string& suffix = {}) const;

    /// Moves all that is in the folder to its place; the main file first, since where that fails
    /// nothing has changed. What is moved has reached the disk by then. Statistics, overviews and
    /// masks of the file that was there are removed; its permissions stay.
    Status commit();

private:
    std::string beside(const std::string& name) const;

    std::string _target; ///< as it was given, for messages
    std::string _scratch;
    std::string _place; ///< without links
    std::string _parent, _name, _folder;
};

} // namespace osgTerrainLight
