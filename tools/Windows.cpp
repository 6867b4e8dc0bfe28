#include "Windows.h"

#include "lighting/FarLight.h"
#include "lighting/TileLight.h"
#include "lighting/TileWindows.h"
#include "lighting/nodes/HorizonNode.h"

#include <cpl_vsi.h>

#include <algorithm>

namespace osgTerrainLight::tool
{
namespace
{

constexpr double mebibyte = 1024.0 * 1024.0;
/// The program, GDAL's and the driver's libraries, compiled shaders, GDAL's cache.
constexpr double baseBytes = 200.0 * mebibyte;

/// A side of windows of about the same size, a multiple of the unit.
int evenSide(int extent, int side)
{
    const int most = std::max(side / WindowGrid::unit, 1) * WindowGrid::unit;
    const int windows = (extent + most - 1) / most;
    const int even = (extent + windows - 1) / windows;
    return (even + WindowGrid::unit - 1) / WindowGrid::unit * WindowGrid::unit;
}

} // namespace

WindowGrid::WindowGrid(int width, int height, int side)
    : _width(width), _height(height), _windowWidth(evenSide(width, side)),
      _windowHeight(evenSide(height, side))
{
}

PixelWindow WindowGrid::at(int index) const
{
    const int column = index % columns() * _windowWidth;
    const int row = index / columns() * _windowHeight;
    return {column, row, std::min(_windowWidth, _width - column),
            std::min(_windowHeight, _height - row)};
}

PostRect postsOf(const PixelWindow& pixels, const RasterFrame& frame)
{
    return {frame.westFirst ? pixels.column : frame.width - pixels.column - pixels.width,
            frame.northUp ? frame.height - pixels.row - pixels.height : pixels.row, pixels.width,
            pixels.height};
}

RasterFrame frameOf(const PixelWindow& pixels, const RasterFrame& frame)
{
    RasterFrame part = frame;
    part.width = pixels.width;
    part.height = pixels.height;
    part.geoTransform[0] += pixels.column * frame.geoTransform[1];
    part.geoTransform[3] += pixels.row * frame.geoTransform[5];
    return part;
}

DemInfo infoOf(const PixelWindow& pixels, const DemInfo& info)
{
    DemInfo part = info;
    part.window = {info.window.column + pixels.column, info.window.row + pixels.row, pixels.width,
                   pixels.height};
    part.frame = frameOf(pixels, info.frame);
    return part;
}

int marginOf(const LightingSettings& settings)
{
    return settings.bounces > 0 ? bounceMargin : 0;
}

double defaultMemory()
{
    const auto machine = static_cast<double>(CPLGetUsablePhysicalRAM());
    return std::clamp(0.25 * machine, 256.0 * mebibyte, 1536.0 * mebibyte);
}

TileBytes::TileBytes(int width, int height, const LightingSettings& settings)
{
    const double posts = double(width) * height;
    constexpr int frame = HorizonNode::frame;
    heights = 4.0 * (double(width + 2 * frame) * (height + 2 * frame) + height);
    map = 2.0 * posts * settings.azimuths;
    working = static_cast<double>(HorizonNode::workingBytes(
        width, height, HorizonScheme::of(settings.quality), settings.azimuths));
    sun = 2.0 * TileLight::sunAzimuths * posts; // its working space is the sky's, at another time
    sky = 4.0 * posts;
    shading = 8.0 * posts;
    // What faces send, direct light, the height over the shadow, and each bounce.
    bounces = settings.bounces > 0 ? (32.0 + 16.0 + 8.0 + 8.0 * settings.bounces) * posts : 0.0;
}

double runBytes(int width, int height, const LightingSettings& settings, int bands)
{
    const double posts = double(width) * height;
    // A ring of the tile's own posts, and coarser levels: in memory, and as a texture.
    const int ring = WindowScheme::of(settings.quality).ring;
    const double terrain = 20.0 * double(width + 2 * ring) * (height + 2 * ring);
    // What coarser levels send: in memory, in floats, and as a texture. They have about as many
    // posts as half of the tile's and its ring's.
    const double far = settings.bounces * 0.5 * terrain;
    // An albedo raster, in memory and as a texture.
    const double albedo = settings.bounces > 0 ? 20.0 * posts : 0.0;
    // Heights and validity; light or a map and a band of it as they are read back and written.
    const double readBack =
        (5.0 + 16.0 + 3.0 * 4.0) * posts + (bands > 4 ? 4.0 * bands * posts : 0.0);
    return baseBytes + TileBytes(width, height, settings).all() + terrain + far + albedo + readBack;
}

bool fitsInOnePiece(int width, int height, const LightingSettings& settings, int bands,
                    const ExtentOptions& extent)
{
    constexpr int mostTexels = 16384;
    const int longest = std::max(width, height);
    return longest <= mostTexels - 2 * HorizonNode::frame &&
           (extent.windowSize == 0 || longest <= extent.windowSize) &&
           runBytes(width, height, settings, bands) <= extent.memory;
}

int windowSide(double memory, const LightingSettings& settings, int bands)
{
    const int margin = 2 * marginOf(settings);
    int side = WindowGrid::sanePosts;
    while (side > WindowGrid::unit &&
           runBytes(side + margin, side + margin, settings, bands) > memory)
        side -= WindowGrid::unit;
    return side;
}

} // namespace osgTerrainLight::tool
