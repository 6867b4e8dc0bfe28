#pragma once

#include "core/Result.h"
#include "fields/MeshField.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace osgTerrainLight
{

/// What a mesh and the options of its field come to, in 128 bits.
using FieldKey = std::array<std::uint64_t, 2>;

/// Of all vertices, triangles, cells and margin, and of the version of file and method.
FieldKey fieldKey(const TriangleMesh& mesh, const BakeOptions& options);

/// Rounds distances to what a file holds: multiples of a power of two, with 16 bits for the
/// greatest. The error is at most 1/32767 of that. Signs stay, but for those of distances that
/// round to 0.
void roundToFile(DistanceGrid& grid);

/// Writes a field whose distances have been rounded. The file is put in place by renaming.
Status writeField(const std::string& path, const FieldKey& key, const BakedField& field);

/// The field in a file; nothing where there is none, or it is not whole, or not of this key.
std::optional<BakedField> readField(const std::string& path, const FieldKey& key);

} // namespace osgTerrainLight
