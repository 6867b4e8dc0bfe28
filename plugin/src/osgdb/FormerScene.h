#pragma once

#include <osgTerrainLight/TerrainLighting.h>

#include <osgDB/InputStream>

namespace osgTerrainLight
{

/// Reads a node as it was written before its properties had names: fields by their place. In a
/// binary file the first field's mark has been read.
void readFormerScene(osgDB::InputStream& is, TerrainLighting& node);

} // namespace osgTerrainLight
