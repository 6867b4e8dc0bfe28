#include "io/EnvironmentFile.h"

#include "io/ExrGuard.h"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr int maxColumns = 16384;
constexpr int maxRows = 8192;

/// Pixels, row by row from the top.
struct Picture
{
    int width = 0;
    int height = 0;
    std::vector<Rgb> pixels;
    Rgb& at(int x, int y)
    {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
    const Rgb& at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
};

struct Size
{
    std::int64_t width, height;
};

/// In 64 bits: a damaged header's corners may be anything.
Size sizeOf(const Imath::Box2i& window)
{
    return {std::int64_t(window.max.x) - window.min.x + 1,
            std::int64_t(window.max.y) - window.min.y + 1};
}

std::string textOf(const Size& size)
{
    return std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels";
}

bool isWithin(const Size& size, std::size_t maxPixels)
{
    // No product of what may be 2^32 each.
    return size.width >= 1 && size.height >= 1 && size.width <= std::int64_t(maxPixels) &&
           size.height <= std::int64_t(maxPixels) / size.width;
}

enum class Kind
{
    Colours,         ///< R, G, B
    Luminance,       ///< Y
    LuminanceChroma, ///< Y, RY, BY
};

struct Layer
{
    std::string prefix; ///< empty, or with its full stop
    Kind kind;
};

/// The first layer of light; that without a name comes first.
std::optional<Layer> layerOf(const Imf::ChannelList& channels)
{
    std::set<std::string> prefixes;
    for (auto i = channels.begin(); i != channels.end(); ++i)
    {
        const std::string name = i.name();
        const std::size_t stop = name.rfind('.');
        prefixes.insert(stop == std::string::npos ? "" : name.substr(0, stop + 1));
    }
    const auto has = [&](const std::string& name) { return channels.findChannel(name) != nullptr; };
    for (const std::string& prefix : prefixes)
    {
        if (has(prefix + "R") && has(prefix + "G") && has(prefix + "B"))
            return Layer{prefix, Kind::Colours};
        if (has(prefix + "Y"))
            return Layer{prefix, has(prefix + "RY") && has(prefix + "BY") ? Kind::LuminanceChroma
                                                                          : Kind::Luminance};
    }
    return std::nullopt;
}

/// A channel that has a value for each xSampling × ySampling pixels.
struct Plane
{
    int xSampling = 1, ySampling = 1;
    int width = 0, height = 0;
    std::vector<float> values;

    /// Linear between the pixels that have a value.
    float at(int x, int y) const
    {
        const auto split = [](int place, int sampling, int count)
        {
            const int low = std::min(place / sampling, count - 1);
            return std::tuple{low, std::min(low + 1, count - 1),
                              static_cast<float>(place % sampling) / static_cast<float>(sampling)};
        };
        const auto [left, right, across] = split(x, xSampling, width);
        const auto [top, bottom, down] = split(y, ySampling, height);
        const auto value = [&](int column, int row)
        {
            return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(column)];
        };
        const auto mix = [](float a, float b, float weight)
        { return weight == 0.0f ? a : a + (b - a) * weight; };
        return mix(mix(value(left, top), value(right, top), across),
                   mix(value(left, bottom), value(right, bottom), across), down);
    }
};

/// Channels of a part's data window, as they are.
Picture pixelsOf(Imf::InputPart& part, const Layer& layer)
{
    const Imf::Header& header = part.header();
    const Imath::Box2i window = header.dataWindow();
    Picture picture;
    picture.width = static_cast<int>(sizeOf(window).width);
    picture.height = static_cast<int>(sizeOf(window).height);
    picture.pixels.resize(static_cast<std::size_t>(picture.width) *
                          static_cast<std::size_t>(picture.height));
    const std::array<const char*, 3> names = layer.kind == Kind::Colours
                                                 ? std::array<const char*, 3>{"R", "G", "B"}
                                                 : std::array<const char*, 3>{"RY", "Y", "BY"};
    std::array<Plane, 3> planes;
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < 3; ++c)
    {
        if (layer.kind == Kind::Luminance && c != 1)
            continue;
        const std::string name = layer.prefix + names[c];
        const Imf::Channel& channel = header.channels()[name];
        Plane& plane = planes[c];
        plane.xSampling = channel.xSampling;
        plane.ySampling = channel.ySampling;
        if (plane.xSampling == 1 && plane.ySampling == 1)
        {
            buffer.insert(
                name, Imf::Slice::Make(Imf::FLOAT, &picture.pixels.front()[c], window, sizeof(Rgb),
                                       sizeof(Rgb) * static_cast<std::size_t>(picture.width)));
            continue;
        }
        // The library holds windows to multiples of the sampling.
        plane.width = picture.width / plane.xSampling;
        plane.height = picture.height / plane.ySampling;
        plane.values.resize(static_cast<std::size_t>(plane.width) *
                            static_cast<std::size_t>(plane.height));
        buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.values.data(), window, sizeof(float),
                                             sizeof(float) * static_cast<std::size_t>(plane.width),
                                             plane.xSampling, plane.ySampling));
    }
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);

    const auto weights = Imf::RgbaYca::computeYw(hasChromaticities(header) ? chromaticities(header)
                                                                           : Imf::Chromaticities());
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
        {
            Rgb& pixel = picture.at(x, y);
            for (std::size_t c = 0; c < 3; ++c)
                if (!planes[c].values.empty())
                    pixel[c] = planes[c].at(x, y);
            if (layer.kind == Kind::Luminance)
                pixel[0] = pixel[2] = pixel[1];
            else if (layer.kind == Kind::LuminanceChroma)
            {
                // RY = (R - Y) / Y, BY = (B - Y) / Y (ImfRgbaYca.h).
                const float luminance = pixel[1];
                pixel[0] = (pixel[0] + 1.0f) * luminance;
                pixel[2] = (pixel[2] + 1.0f) * luminance;
                pixel[1] = (luminance - weights.x * pixel[0] - weights.z * pixel[2]) / weights.y;
            }
        }
    return picture;
}

/// Colours of the same CIE XYZ in the primaries of Rec. 709; whites are not adapted.
Status convert(Picture& picture, const Imf::Chromaticities& from)
{
    if (from == Imf::Chromaticities())
        return Nothing{};
    const Imath::M44f matrix =
        Imf::RGBtoXYZ(from, 1.0f) * Imf::XYZtoRGB(Imf::Chromaticities(), 1.0f);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(matrix[i][j]) < 1e3f))
                return Error{ErrorCode::Invalid, "its chromaticities span no colours"};
    for (Rgb& pixel : picture.pixels)
    {
        const Rgb old = pixel;
        for (int c = 0; c < 3; ++c)
            pixel[static_cast<std::size_t>(c)] =
                old[0] * matrix[0][c] + old[1] * matrix[1][c] + old[2] * matrix[2][c];
    }
    return Nothing{};
}

/// The display window's part of a picture of the data window.
Picture framed(Picture picture, const Imath::Box2i& data, const Imath::Box2i& display)
{
    if (data == display)
        return picture;
    Picture result;
    result.width = static_cast<int>(sizeOf(display).width);
    result.height = static_cast<int>(sizeOf(display).height);
    result.pixels.resize(static_cast<std::size_t>(result.width) *
                         static_cast<std::size_t>(result.height));
    for (int y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y)
        for (int x = std::max(data.min.x, display.min.x); x <= std::min(data.max.x, display.max.x);
             ++x)
            result.at(x - display.min.x, y - display.min.y) =
                picture.at(x - data.min.x, y - data.min.y);
    return result;
}

using Vector = std::array<double, 3>;
struct Point
{
    double x, y;
};

/// A face of the cube, seen from inside: axes of the file, y up.
struct Face
{
    Vector forward, right, down;
};

/// From the top of the picture down (ImfEnvmap.h).
constexpr std::array<Face, 6> faces = {{
    {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}},
    {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}},
}};

double dot(const Vector& a, const Vector& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Convex; a quadrangle gains one corner at most by each of four cuts. Rounding may find more in a
/// sliver without area, which may lose them.
struct Polygon
{
    std::array<Point, 10> corners = {};
    std::size_t count = 0;

    void add(const Point& corner)
    {
        if (count < corners.size())
            corners[count++] = corner;
    }
    const Point& after(std::size_t i) const { return corners[i + 1 < count ? i + 1 : 0]; }
};

/// The part where side · (coordinate − edge) ≥ 0.
Polygon clipped(const Polygon& polygon, double Point::*axis, double edge, double side)
{
    Polygon result;
    for (std::size_t i = 0; i < polygon.count; ++i)
    {
        const Point& a = polygon.corners[i];
        const Point& b = polygon.after(i);
        const double before = side * (a.*axis - edge);
        const double after = side * (b.*axis - edge);
        if (before >= 0.0)
            result.add(a);
        if ((before < 0.0) == (after < 0.0))
            continue;
        const double t = before / (before - after);
        result.add({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
    return result;
}

/// Of a convex polygon on a face, in texels: triangles about its first corner (Van Oosterom and
/// Strackee 1983, Eq. 8).
double solidAngle(const Polygon& polygon, int side)
{
    const auto place = [&](const Point& p) {
        return Vector{2.0 * p.x / side - 1.0, 2.0 * p.y / side - 1.0, 1.0};
    };
    const Vector a = place(polygon.corners[0]);
    const double lengthA = std::sqrt(dot(a, a));
    double sum = 0.0;
    for (std::size_t i = 2; i < polygon.count; ++i)
    {
        const Vector b = place(polygon.corners[i - 1]);
        const Vector c = place(polygon.corners[i]);
        const double lengthB = std::sqrt(dot(b, b));
        const double lengthC = std::sqrt(dot(c, c));
        // All three at depth 1: the triple product is twice the plane's area.
        const double volume = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        sum += 2.0 * std::atan2(volume, lengthA * lengthB * lengthC + dot(a, b) * lengthC +
                                            dot(a, c) * lengthB + dot(b, c) * lengthA);
    }
    return std::abs(sum);
}

/// Each texel is a quadrangle of great circles (of a parallel's arc, its chord), which are straight
/// lines on the cube's faces; the texels there are cut by it, so the mean is exact. The chords are
/// the same for texels below and above.
EnvironmentPicture fromCube(const Picture& cube)
{
    const int side = cube.width;
    EnvironmentPicture result;
    // No texel that meets a face reaches behind its plane.
    result.rows = std::max(2 * side, 32);
    result.columns = 2 * result.rows;
    result.radiance.resize(static_cast<std::size_t>(result.columns) *
                           static_cast<std::size_t>(result.rows));
    Polygon quad;
    quad.count = 4;
    for (int row = 0; row < result.rows; ++row)
        for (int column = 0; column < result.columns; ++column)
        {
            std::array<Vector, 4> corners;
            for (int i = 0; i < 4; ++i)
            {
                const double elevation = pi * (row + (i < 2 ? 0 : 1)) / result.rows - 0.5 * pi;
                const double azimuth =
                    2.0 * pi * (column + (i == 1 || i == 2 ? 1 : 0)) / result.columns;
                // East is the file's -x, north its z, up its y.
                corners[static_cast<std::size_t>(i)] = {-std::cos(elevation) * std::cos(azimuth),
                                                        std::sin(elevation),
                                                        std::cos(elevation) * std::sin(azimuth)};
            }
            Vector sum = {};
            double weights = 0.0;
            for (std::size_t f = 0; f < faces.size(); ++f)
            {
                const Face& face = faces[f];
                Point low = {double(side), double(side)}, high = {0.0, 0.0};
                bool isBefore = true;
                for (std::size_t i = 0; isBefore && i < 4; ++i)
                {
                    const double depth = dot(corners[i], face.forward);
                    isBefore = depth > 0.2;
                    Point& corner = quad.corners[i];
                    corner = {0.5 * side * (1.0 + dot(corners[i], face.right) / depth),
                              0.5 * side * (1.0 + dot(corners[i], face.down) / depth)};
                    low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
                    high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
                }
                if (!isBefore)
                    continue;
                const auto from = [](double place)
                { return std::max(static_cast<int>(std::floor(place)), 0); };
                const auto to = [&](double place)
                { return std::min(static_cast<int>(std::ceil(place)), side); };
                for (int y = from(low.y); y < to(high.y); ++y)
                {
                    const Polygon strip =
                        clipped(clipped(quad, &Point::y, y, 1.0), &Point::y, y + 1.0, -1.0);
                    for (int x = from(low.x); strip.count > 2 && x < to(high.x); ++x)
                    {
                        const Polygon piece =
                            clipped(clipped(strip, &Point::x, x, 1.0), &Point::x, x + 1.0, -1.0);
                        if (piece.count < 3)
                            continue;
                        const double weight = solidAngle(piece, side);
                        const Rgb& pixel = cube.at(x, static_cast<int>(f) * side + y);
                        for (std::size_t c = 0; c < 3; ++c)
                            sum[c] += weight * static_cast<double>(pixel[c]);
                        weights += weight;
                    }
                }
            }
            Rgb& texel = result.radiance[static_cast<std::size_t>(row) *
                                             static_cast<std::size_t>(result.columns) +
                                         static_cast<std::size_t>(column)];
            for (std::size_t c = 0; c < 3; ++c)
                texel[c] = static_cast<float>(sum[c] / weights);
        }
    return result;
}

Result<EnvironmentPicture> read(const std::string& path, std::size_t maxPixels)
{
    Imf::MultiPartInputFile file(path.c_str());
    std::string found;
    for (int number = 0; number < file.parts(); ++number)
    {
        const Imf::Header& header = file.header(number);
        const std::optional<Layer> layer = layerOf(header.channels());
        const bool isDeep = header.hasType() && Imf::isDeepData(header.type());
        if (!layer || isDeep)
        {
            for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
                found +=
                    (found.empty() ? "" : ", ") + std::string(i.name()) + (isDeep ? " (deep)" : "");
            continue;
        }
        const Imath::Box2i data = header.dataWindow();
        const Imath::Box2i display = header.displayWindow();
        const Size size = sizeOf(display);
        for (const Size& each : {sizeOf(data), size})
            if (!isWithin(each, maxPixels))
                return Error{ErrorCode::Invalid, path + ": has a window of " + textOf(each) +
                                                     "; needed 1 to " + std::to_string(maxPixels)};
        const bool isMarked = hasEnvmap(header);
        const bool isCube =
            isMarked ? envmap(header) == Imf::ENVMAP_CUBE : size.height == 6 * size.width;
        const bool fits =
            isCube ? size.height == 6 * size.width : isMarked || size.width == 2 * size.height;
        if (!fits)
            return Error{ErrorCode::Invalid,
                         path + ": is " + textOf(size) + " and " +
                             (isMarked
                                  ? "marked as a cube; needed 1 : 6, the faces below each other"
                                  : "has no attribute envmap; needed 2 : 1 (latitude-longitude) "
                                    "or 1 : 6 (cube, the faces below each other)")};
        const Size needed = isCube ? Size{4 * size.width, 2 * size.width} : size;
        if (needed.width > maxColumns || needed.height > maxRows)
            return Error{ErrorCode::Invalid,
                         path + ": is " + textOf(size) + "; needed at most " +
                             (isCube ? textOf({maxColumns / 4, 6 * maxColumns / 4})
                                     : textOf({maxColumns, maxRows}))};

        Imf::InputPart part(file, number);
        Picture picture = pixelsOf(part, *layer);
        if (hasChromaticities(header))
            if (const Status done = convert(picture, chromaticities(header)); !done)
                return Error{ErrorCode::Invalid, path + ": " + done.error().message};
        const std::string warning = makeUsable(picture.pixels);
        picture = framed(std::move(picture), data, display);
        EnvironmentPicture result =
            isCube ? fromCube(picture)
                   : fromLatitudeLongitude(picture.width, picture.height, picture.pixels);
        if (!warning.empty())
            result.warning = path + ": " + warning;
        return result;
    }
    return Error{ErrorCode::NotSupported,
                 path + ": has the channels " + found +
                     "; needed R, G and B, or Y, of pixels that are not deep"};
}

} // namespace

EnvironmentPicture fromLatitudeLongitude(int width, int height, const std::vector<Rgb>& pixels)
{
    EnvironmentPicture result;
    result.columns = width;
    result.rows = height;
    result.radiance.resize(pixels.size());
    // East is three quarters along; azimuths inside run the other way.
    const int east = static_cast<int>(std::lround(0.75 * width));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
        {
            const int column = ((east - 1 - x) % width + width) % width;
            const auto at = [&](int row, int place)
            {
                return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(place);
            };
            result.radiance[at(height - 1 - y, column)] = pixels[at(y, x)];
        }
    return result;
}

std::string makeUsable(std::vector<Rgb>& pixels)
{
    constexpr float greatest = 1e30f;
    constexpr float overflow = 65504.0f;
    std::size_t notNumbers = 0, infinite = 0;
    for (Rgb& pixel : pixels)
        for (float& value : pixel)
        {
            notNumbers += std::isnan(value);
            infinite += std::isinf(value) || std::abs(value) > greatest;
            value = !(value > 0.0f) ? 0.0f : value > greatest ? overflow : value;
        }
    if (notNumbers + infinite == 0)
        return {};
    return std::to_string(notNumbers) + " values are no number and taken as 0, " +
           std::to_string(infinite) + " are infinite and taken as 65504 (or 0 where negative)";
}

Result<EnvironmentPicture> readEnvironmentFile(const std::string& path, std::size_t maxPixels)
{
    return readGuarded(path, [&] { return read(path, maxPixels); });
}

} // namespace osgTerrainLight
