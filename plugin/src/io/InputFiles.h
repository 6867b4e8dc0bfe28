#pragma once

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Every file on disk that an input is made of: the file itself, what GDAL lists for it (sources of
/// a VRT, of VRTs among them again, header pairs), its sidecars (.aux.xml, .ovr, .msk, world files,
/// .prj), the file within a dataset's name (NETCDF:"a.nc":Band1, vrt://a.tif,
/// /vsizip/{a.zip}/b.tif) and before the extensions that name OpenSceneGraph's readers
/// (a.tif.terrainlight, a.osgt.2.scale), and of an .earth map its layers and its sky. Files that do
/// not exist are not listed.
std::vector<std::string> filesOf(const std::string& input);

/// Empty, or why a path cannot be read as a file: a pipe would be waited for, and has no size.
std::string complaintOfFile(const std::string& path);

/// What tells a file from another one of the same name, or of another time: size and time of
/// change, of a disk in nanoseconds; "none" where there is none. GDAL's own file systems too.
std::string stateOfFile(const std::string& path);

/// The first of `inputs` that is the same file (device and inode) as `output`; empty: none.
std::string sameFile(const std::vector<std::string>& inputs, const std::string& output);

} // namespace osgTerrainLight
