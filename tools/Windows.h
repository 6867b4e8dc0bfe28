#pragma once

#include <osgTerrainLight/LightingSettings.h>

#include "Options.h"
#include "core/PostRect.h"
#include "io/DemReader.h"
#include "io/RasterFrame.h"

#include <cstddef>

/// How a raster that does not fit into memory is cut.
namespace osgTerrainLight::tool
{

/// Windows of a raster, side by side, in rows from the file's first pixel on. All but the last of a
/// row or a column have the same size.
struct WindowGrid
{
    static constexpr int unit = 64;        ///< sides are multiples of it
    static constexpr int mostPosts = 4096; ///< a side
    static constexpr int sanePosts = 2048; ///< more gains nothing

    /// Of at most `side` posts a side, about the same in all.
    WindowGrid(int width, int height, int side);

    int columns() const { return (_width + _windowWidth - 1) / _windowWidth; }
    int rows() const { return (_height + _windowHeight - 1) / _windowHeight; }
    int count() const { return columns() * rows(); }
    int windowWidth() const { return _windowWidth; }
    int windowHeight() const { return _windowHeight; }
    /// In pixels of the raster; index: 0 … count() − 1.
    PixelWindow at(int index) const;

private:
    int _width, _height, _windowWidth, _windowHeight;
};

/// The posts of a tile whose frame is `frame` that pixels of its file are.
PostRect postsOf(const PixelWindow& pixels, const RasterFrame& frame);
/// The frame of a part of a raster.
RasterFrame frameOf(const PixelWindow& pixels, const RasterFrame& frame);
/// What describeDem() would say of a part of what it described.
DemInfo infoOf(const PixelWindow& pixels, const DemInfo& info);

/// Posts that are lit around each window and left out of the result. Direct light needs none;
/// bounces come from ground that is lit itself.
int marginOf(const LightingSettings& settings);

/// A quarter of the machine's memory, at most 1.5 GiB [bytes].
double defaultMemory();

/// Textures of one tile and their parts [bytes]; sky and sun on.
struct TileBytes
{
    TileBytes(int width, int height, const LightingSettings& settings);

    double heights, map, working, sky, sun, shading, bounces;
    double all() const { return heights + map + working + sky + sun + shading + bounces; }
};

/// Bytes that lighting a tile takes at its peak: textures, since with software OpenGL they are in
/// the same memory, what is read back from them, and the terrain around. bands: of the result.
double runBytes(int width, int height, const LightingSettings& settings, int bands);
/// Whether memory and the textures of any OpenGL 4.3 suffice for all at once.
bool fitsInOnePiece(int width, int height, const LightingSettings& settings, int bands,
                    const ExtentOptions& extent);
/// The side of windows that fit into so many bytes, a multiple of WindowGrid::unit.
int windowSide(double memory, const LightingSettings& settings, int bands);

} // namespace osgTerrainLight::tool
