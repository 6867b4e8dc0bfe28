#pragma once

#include "core/Result.h"
#include "fields/MeshField.h"

#include <string>

namespace osgTerrainLight
{

/// A field, and where it comes from.
struct CachedField
{
    BakedField field;
    bool isFromFile = false;
    /// Why the field could not be kept in a file, one sentence; empty where it was or needed not.
    std::string problem;
};

/// Keeps fields of meshes in a folder, one file per mesh and options, named by their content: a
/// mesh that has changed has another file, and nobody removes the former one. Distances are kept in
/// 16 bits. The error is at most 1/32767 of the greatest distance, about 0.002 voxels for 64 cells.
/// A field has the same bits whether it is from a file or has just been made. A file that
/// is damaged, or of another version, is made anew. Files are put in place by renaming, so several
/// processes may share a folder.
class FieldCache
{
public:
    /// folder: made where it does not exist. Empty: nothing is kept.
    explicit FieldCache(std::string folder);

    /// The field of the mesh, from its file where that is there, else by bakeMesh(). Errors: those
    /// of bakeMesh(). A folder that cannot be written to is no error. May be called by several
    /// threads at once.
    Result<CachedField> bake(const TriangleMesh& mesh, const BakeOptions& options = {}) const;

    /// The file of a mesh and options, whether or not it exists.
    std::string pathOf(const TriangleMesh& mesh, const BakeOptions& options = {}) const;

private:
    std::string _folder;
};

} // namespace osgTerrainLight
