#include "io/ExrEnvironment.h"

#include "io/CubeFaces.h"
#include "io/ExrLayers.h"

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
#include <tuple>
#include <utility>

namespace osgTerrainLight
{

namespace
{
constexpr int maxColumns = 16384;
constexpr int maxRows = 8192;

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
Picture pixelsOf(Imf::InputPart& part, const ExrLayer& layer)
{
    const Imf::Header& header = part.header();
    const Imath::Box2i window = header.dataWindow();
    Picture picture;
    picture.width = static_cast<int>(sizeOf(window).width);
    picture.height = static_cast<int>(sizeOf(window).height);
    picture.pixels.resize(static_cast<std::size_t>(picture.width) *
                          static_cast<std::size_t>(picture.height));
    const std::array<const char*, 3> names = layer.kind == LayerKind::Colours
                                                 ? std::array<const char*, 3>{"R", "G", "B"}
                                                 : std::array<const char*, 3>{"RY", "Y", "BY"};
    std::array<Plane, 3> planes;
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < 3; ++c)
    {
        if (layer.kind == LayerKind::Luminance && c != 1)
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
            if (layer.kind == LayerKind::Luminance)
                pixel[0] = pixel[2] = pixel[1];
            else if (layer.kind == LayerKind::LuminanceChroma)
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

/// A layer of light; where there was a choice, or doubt, a sentence that says so.
struct Choice
{
    ExrLayer layer;
    std::string warning;
};

std::string nameOf(const ExrPart& part, const ExrLayer& layer)
{
    const std::string name = layer.prefix.substr(0, layer.prefix.find_last_of('.'));
    const std::string of = part.name.empty() ? "" : "part \"" + part.name + "\"";
    return name.empty() ? of.empty() ? "the layer without a name" : of
                        : "the layer \"" + name + "\"" + (of.empty() ? "" : " of " + of);
}

Result<Choice> choose(const std::string& path, const Imf::MultiPartInputFile& file)
{
    std::string found;
    std::vector<ExrPart> parts;
    for (int number = 0; number < file.parts(); ++number)
    {
        const Imf::Header& header = file.header(number);
        const bool isDeep = header.hasType() && Imf::isDeepData(header.type());
        ExrPart part;
        part.name = header.hasName() ? header.name() : "";
        if (header.hasView())
            part.views = {header.view()};
        else if (hasMultiView(header))
            part.views = multiView(header);
        for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        {
            found +=
                (found.empty() ? "" : ", ") + std::string(i.name()) + (isDeep ? " (deep)" : "");
            if (!isDeep)
                part.channels.push_back(i.name());
        }
        parts.push_back(part);
    }
    const std::vector<ExrLayer> layers = lightLayers(parts);
    if (layers.empty())
        return Error{ErrorCode::NotSupported,
                     path + ": has the channels " + found +
                         "; needed R, G and B, or Y, of pixels that are not deep"};
    Choice choice = {layers[0], {}};
    std::string others;
    for (std::size_t i = 1; i < layers.size(); ++i)
        others += (i > 1 ? ", " : "") + nameOf(parts[layers[i].part], layers[i]);
    if (layers.size() > 1 || isNoLight(layers[0]))
        choice.warning = nameOf(parts[layers[0].part], layers[0]) + " is taken as light" +
                         (others.empty() ? "" : ", not " + others);
    return choice;
}

/// Whether it is a cube; an error where the shape is of no environment.
Result<bool> checkShape(const std::string& path, const Imf::Header& header, std::size_t maxPixels)
{
    const Size size = sizeOf(header.displayWindow());
    for (const Size& each : {sizeOf(header.dataWindow()), size})
        if (!isWithin(each, maxPixels))
            return Error{ErrorCode::Invalid, path + ": has a window of " + textOf(each) +
                                                 "; needed 1 to " + std::to_string(maxPixels)};
    if (!header.dataWindow().intersects(header.displayWindow()))
        return Error{ErrorCode::Invalid, path + ": has no pixels within its display window"};
    const bool isMarked = hasEnvmap(header);
    // Width of a pixel by its height, as of projectors: it counts in the shape of a picture that
    // does not say what it is. Other widths than 1 round the picture's own to whole pixels.
    const double aspect = header.pixelAspectRatio();
    const bool isSquare = aspect == 1.0;
    const bool isCube =
        isMarked ? envmap(header) == Imf::ENVMAP_CUBE : isSquare && size.height == 6 * size.width;
    const double shape = 2.0 * static_cast<double>(size.height) / aspect;
    const bool fits = isCube ? size.height == 6 * size.width
                             : isMarked || std::abs(static_cast<double>(size.width) - shape) <=
                                               (isSquare ? 0.0 : 1.0);
    if (!fits)
        return Error{ErrorCode::Invalid,
                     path + ": is " + textOf(size) +
                         (isSquare ? ""
                                   : ", " + std::to_string(aspect) +
                                         " times as wide as high (pixelAspectRatio),") +
                         " and " +
                         (isMarked ? "marked as a cube; needed 1 : 6, the faces below each other"
                                   : "has no attribute envmap; needed 2 : 1 (latitude-longitude) "
                                     "or 1 : 6 (cube, the faces below each other)")};
    const Size needed = isCube ? Size{4 * size.width, 2 * size.width} : size;
    if (needed.width > maxColumns || needed.height > maxRows)
        return Error{ErrorCode::Invalid, path + ": is " + textOf(size) + "; needed at most " +
                                             (isCube ? textOf({maxColumns / 4, 6 * maxColumns / 4})
                                                     : textOf({maxColumns, maxRows}))};
    return isCube;
}

/// What the header says of light and the picture does not follow.
std::string doubtsOf(const Imf::Header& header)
{
    const Imath::V2f white =
        (hasChromaticities(header) ? chromaticities(header) : Imf::Chromaticities()).white;
    const bool isAdopted =
        hasAdoptedNeutral(header) && !((adoptedNeutral(header) - white).length() <= 1e-3f);
    return joined({hasWhiteLuminance(header)
                       ? "its whiteLuminance is not used: pixels are taken as radiance"
                       : "",
                   isAdopted ? "its adoptedNeutral is another white than that of its "
                               "chromaticities; white is not adapted"
                             : ""});
}
} // namespace

Result<EnvironmentPicture> readExrEnvironment(const std::string& path, std::size_t maxPixels)
{
    Imf::MultiPartInputFile file(path.c_str());
    const Result<Choice> choice = choose(path, file);
    if (!choice)
        return choice.error();
    const int number = static_cast<int>(choice->layer.part);
    const Imf::Header& header = file.header(number);
    const Result<bool> isCube = checkShape(path, header, maxPixels);
    if (!isCube)
        return isCube.error();
    Imf::InputPart part(file, number);
    Picture picture = pixelsOf(part, choice->layer);
    if (hasChromaticities(header))
        if (const Status done = convert(picture, chromaticities(header)); !done)
            return Error{ErrorCode::Invalid, path + ": " + done.error().message};
    const std::string warning =
        joined({makeUsable(picture.pixels), choice->warning, doubtsOf(header)});
    picture = framed(std::move(picture), header.dataWindow(), header.displayWindow());
    EnvironmentPicture result =
        *isCube ? fromCube(picture)
                : fromLatitudeLongitude(picture.width, picture.height, picture.pixels);
    if (!warning.empty())
        result.warning = path + ": " + warning;
    return result;
}

} // namespace osgTerrainLight
