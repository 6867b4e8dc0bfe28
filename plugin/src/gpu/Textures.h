#pragma once

#include <osgTerrainLight/DemTile.h>

#include "core/Raster.h"

#include <osg/State>
#include <osg/Texture2D>
#include <osg/Texture2DArray>
#include <osg/Texture3D>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace osgTerrainLight
{

/// Height texture of a tile: R32F [m above heightOrigin], row 0 south, framed by `frame` void posts
/// on every side so that no read leaves it; void posts hold VOID_HEIGHT of lib/surface.glsl.
/// bodyRadius [m]: how a planet's ground sinks towards the edges (LightingSettings); 0: flat.
osg::ref_ptr<osg::Texture2D> createHeightTexture(const DemTile& tile, int frame,
                                                 double bodyRadius = 0.0);

/// R32F [m], one texel per row: the distance between its columns.
osg::ref_ptr<osg::Texture2D> createSpacingTexture(const DemTile& tile);

/// A texture of the given values, format R32F.
osg::ref_ptr<osg::Texture2D> createFloatTexture(const Raster<float>& values);

/// A texture of the given colours, format RGBA16F, alpha 1.
osg::ref_ptr<osg::Texture2D> createColourTexture(const Raster<std::array<float, 3>>& colours);

/// A texture without content that passes write: GL_R32F, GL_RGBA16F, GL_R32UI, …, linear filter
/// where the format has one.
osg::ref_ptr<osg::Texture2D> createTarget(int width, int height, GLint internalFormat);
osg::ref_ptr<osg::Texture2DArray> createLayeredTarget(int width, int height, int layers,
                                                      GLint internalFormat);
osg::ref_ptr<osg::Texture3D> createVolumeTarget(int width, int height, int depth,
                                                GLint internalFormat);

/// Bytes that a texture made by these functions takes on the GPU.
std::size_t textureBytes(const osg::Texture& texture);

/// Content of a GPU texture, layer after layer (slice after slice), row 0 first. Needs a current
/// context in which the texture was written.
std::vector<float> readFloats(osg::State& state, osg::Texture& texture, int channels);
std::vector<std::uint16_t> readUnorm16(osg::State& state, osg::Texture& texture);
std::vector<std::uint32_t> readUints(osg::State& state, osg::Texture& texture);

} // namespace osgTerrainLight
