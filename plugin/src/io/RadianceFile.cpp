#include "io/RadianceFile.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

namespace osgTerrainLight
{

namespace
{
using Pixel = std::array<unsigned char, 4>; ///< mantissas of three channels, exponent

constexpr const char* xyzFormat = "32-bit_rle_xyze";

/// What the header's lines say.
struct Header
{
    std::string format;                               ///< of the last FORMAT line
    bool hasFormats = false;                          ///< FORMAT lines that contradict each other
    std::string gamma;                                ///< of the last GAMMA that is not 1
    std::array<double, 3> exposure = {1.0, 1.0, 1.0}; ///< EXPOSURE times COLORCORR, per channel
    double pixelAspect = 1.0;
    std::optional<std::array<double, 8>> primaries; ///< x, y of red, green, blue, white
    std::string viewType;                           ///< of the last VIEW that has one
};

/// The resolution string "-Y 512 +X 1024": scan lines first.
struct Resolution
{
    char slowAxis = 'Y';
    bool slowRises = false, fastRises = true; ///< X to the right, Y upwards
    int lines = 0, length = 0;

    int width() const { return slowAxis == 'Y' ? length : lines; }
    int height() const { return slowAxis == 'Y' ? lines : length; }
};

/// A file in memory, read from its front.
class Bytes
{
public:
    explicit Bytes(const std::string& all) : _all(all) {}
    /// Up to the next line break, without it; false at the end.
    bool line(std::string& text)
    {
        if (_place >= _all.size())
            return false;
        const std::size_t end = std::min(_all.find('\n', _place), _all.size());
        text = _all.substr(_place, end - _place);
        if (!text.empty() && text.back() == '\r')
            text.pop_back();
        _place = std::min(end + 1, _all.size());
        return true;
    }
    bool byte(unsigned char& value)
    {
        if (_place >= _all.size())
            return false;
        value = static_cast<unsigned char>(_all[_place++]);
        return true;
    }
    bool pixel(Pixel& value)
    {
        bool there = true;
        for (unsigned char& part : value)
            there = there && byte(part);
        return there;
    }
    void back(std::size_t count) { _place -= count; }

private:
    const std::string& _all;
    std::size_t _place = 0;
};

/// Numbers separated by blanks; empty where the text holds anything else.
std::vector<double> numbersIn(std::string_view text)
{
    std::vector<double> values;
    while (true)
    {
        text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
        if (text.empty())
            return values;
        if (text.front() == '+')
            text.remove_prefix(1);
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const auto length = static_cast<std::size_t>(end - text.data());
        if (error != std::errc() ||
            (length < text.size() && text[length] != ' ' && text[length] != '\t'))
            return {};
        values.push_back(value);
        text.remove_prefix(length);
    }
}

/// What is wrong, or empty. A line that begins with a blank belongs to a picture that this one was
/// made from.
std::string readVariable(const std::string& line, Header& header)
{
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos)
        return {};
    const std::string name = line.substr(0, equals);
    const std::string value = line.substr(equals + 1);
    const std::vector<double> numbers = numbersIn(value);
    const auto positive = [&](std::size_t count)
    {
        bool good = numbers.size() == count;
        for (const double number : numbers)
            good = good && number > 0.0 && number < 1e30;
        return good;
    };
    if (name == "FORMAT")
    {
        const std::size_t start = std::min(value.find_first_not_of(' '), value.size());
        const std::string format = value.substr(start, value.find_last_not_of(' ') + 1 - start);
        if (format != xyzFormat && format != "32-bit_rle_rgbe")
            return "needed FORMAT=32-bit_rle_rgbe or 32-bit_rle_xyze";
        header.hasFormats |= !header.format.empty() && format != header.format;
        header.format = format;
    }
    else if (name == "EXPOSURE" || name == "COLORCORR")
    {
        const bool each = name == "COLORCORR";
        if (!positive(each ? 3 : 1))
            return each ? "needed three numbers > 0" : "needed a number > 0";
        for (std::size_t c = 0; c < 3; ++c)
            header.exposure[c] *= numbers[each ? c : 0];
    }
    else if (name == "PIXASPECT")
    {
        if (!positive(1))
            return "needed a number > 0";
        header.pixelAspect *= numbers[0];
    }
    else if (name == "PRIMARIES")
    {
        if (numbers.size() != 8)
            return "needed x and y of red, green, blue and white";
        std::array<double, 8> primaries = {};
        for (std::size_t i = 0; i < 8; ++i)
            primaries[i] = numbers[i];
        header.primaries = primaries;
    }
    else if (name == "GAMMA" && numbers != std::vector<double>{1.0})
        header.gamma = value.substr(0, 80);
    else if (name == "VIEW")
    {
        const std::size_t type = value.rfind("-vt");
        if (type != std::string::npos && type + 3 < value.size())
            header.viewType = value.substr(type, 4);
    }
    return {};
}

std::optional<Resolution> readResolution(const std::string& line)
{
    Resolution result;
    std::array<char, 2> axes = {};
    std::array<bool, 2> rises = {};
    std::array<int, 2> sizes = {};
    std::string_view rest = line;
    for (std::size_t i = 0; i < 2; ++i)
    {
        rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
        if (rest.size() < 3 || (rest[0] != '+' && rest[0] != '-') ||
            (rest[1] != 'X' && rest[1] != 'Y') || rest[2] != ' ')
            return std::nullopt;
        rises[i] = rest[0] == '+';
        axes[i] = rest[1];
        rest.remove_prefix(2);
        rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), sizes[i]);
        if (error != std::errc() || sizes[i] < 1)
            return std::nullopt;
        rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    }
    if (axes[0] == axes[1] || rest.find_first_not_of(' ') != std::string_view::npos)
        return std::nullopt;
    result.slowAxis = axes[0];
    result.slowRises = rises[0];
    result.fastRises = rises[1];
    result.lines = sizes[0];
    result.length = sizes[1];
    return result;
}

/// Flat pixels, or runs of whole pixels: 1, 1, 1, n repeats the one before n times; further such
/// pixels count for the higher bytes of n.
bool readOldLine(Bytes& bytes, std::vector<Pixel>& line, std::size_t length)
{
    unsigned shift = 0;
    while (line.size() < length)
    {
        Pixel pixel = {};
        if (!bytes.pixel(pixel))
            return false;
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1)
        {
            line.push_back(pixel);
            shift = 0;
            continue;
        }
        const std::size_t count = shift < 32 ? std::size_t(pixel[3]) << shift : 0;
        if (line.empty() || count > length - line.size() || shift >= 32)
            return false;
        line.insert(line.end(), count, Pixel(line.back()));
        shift += 8;
    }
    return true;
}

/// One scan line; false where the file ends or its runs do not fit.
bool readLine(Bytes& bytes, std::vector<Pixel>& line, std::size_t length)
{
    line.clear();
    Pixel start = {};
    if (length < 8 || length > 0x7fff)
        return readOldLine(bytes, line, length);
    if (!bytes.pixel(start))
        return false;
    if (start[0] != 2 || start[1] != 2 || (start[2] & 0x80) != 0)
    {
        bytes.back(4);
        return readOldLine(bytes, line, length);
    }
    if ((std::size_t(start[2]) << 8 | start[3]) != length)
        return false;
    line.resize(length);
    for (std::size_t channel = 0; channel < 4; ++channel)
        for (std::size_t i = 0; i < length;)
        {
            unsigned char code = 0, value = 0;
            if (!bytes.byte(code) || code == 0)
                return false;
            const bool isRun = code > 128;
            const std::size_t count = isRun ? code & 127u : code;
            if (count > length - i || (isRun && !bytes.byte(value)))
                return false;
            for (const std::size_t end = i + count; i < end; ++i)
            {
                if (!isRun && !bytes.byte(value))
                    return false;
                line[i][channel] = value;
            }
        }
    return true;
}

/// A mantissa stands for the lower end of its step, as most readers have it, so that 1 is 1;
/// Radiance itself adds half a step, up to 0.4 %.
std::array<double, 3> valueOf(const Pixel& pixel)
{
    if (pixel[3] == 0)
        return {};
    const double step = std::ldexp(1.0, int(pixel[3]) - 136);
    return {pixel[0] * step, pixel[1] * step, pixel[2] * step};
}

using Chromaticities = std::array<double, 8>;
constexpr Chromaticities radianceColours = {0.640, 0.330, 0.290,     0.600,
                                            0.150, 0.060, 1.0 / 3.0, 1.0 / 3.0};
constexpr Chromaticities rec709 = {0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290};

bool isClose(const Chromaticities& a, const Chromaticities& b)
{
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!(std::abs(a[i] - b[i]) <= 1e-3))
            return false;
    return true;
}

/// Columns are XYZ of red, green and blue whose sum is the white of luminance 1.
glm::dmat3 toXyz(const Chromaticities& p)
{
    const auto xyz = [&](std::size_t i)
    {
        return glm::dvec3(p[2 * i] / p[2 * i + 1], 1.0,
                          (1.0 - p[2 * i] - p[2 * i + 1]) / p[2 * i + 1]);
    };
    const glm::dmat3 unscaled(xyz(0), xyz(1), xyz(2));
    const glm::dvec3 scale = glm::inverse(unscaled) * xyz(3);
    return glm::dmat3(unscaled[0] * scale[0], unscaled[1] * scale[1], unscaled[2] * scale[2]);
}

/// From the file's channels to red, green, blue; nothing where the primaries span no colours.
std::optional<glm::dmat3> colourMatrix(const Header& header)
{
    constexpr double lumensPerWatt = 179.0; // of Radiance's white (color.h, WHTEFFICACY)
    glm::dmat3 matrix(1.0);
    if (header.format == xyzFormat)
        matrix = glm::inverse(toXyz(radianceColours)) / lumensPerWatt;
    else if (header.primaries && !isClose(*header.primaries, radianceColours) &&
             !isClose(*header.primaries, rec709))
    {
        // Bradford's cone responses, in which white goes to white (ICC.1:2022, annex E); columns.
        const glm::dmat3 cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367,
                               1.0296);
        const glm::dmat3 theirs = toXyz(*header.primaries);
        const glm::dmat3 ours = toXyz(radianceColours);
        const glm::dvec3 ratio =
            (cones * (ours * glm::dvec3(1.0))) / (cones * (theirs * glm::dvec3(1.0)));
        glm::dmat3 scale(1.0);
        for (int i = 0; i < 3; ++i)
            scale[i][i] = ratio[i];
        matrix = glm::inverse(ours) * glm::inverse(cones) * scale * cones * theirs;
    }
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!(std::abs(matrix[column][row]) < 1e3))
                return std::nullopt;
    return matrix;
}

/// Row 0 at the top, column 0 left.
std::vector<Rgb> upright(std::vector<Rgb> pixels, const Resolution& resolution)
{
    if (resolution.slowAxis == 'Y' && !resolution.slowRises && resolution.fastRises)
        return pixels;
    std::vector<Rgb> result(pixels.size());
    for (int line = 0; line < resolution.lines; ++line)
        for (int i = 0; i < resolution.length; ++i)
        {
            const int slow = resolution.slowRises ? line : resolution.lines - 1 - line;
            const int fast = resolution.fastRises ? i : resolution.length - 1 - i;
            const int x = resolution.slowAxis == 'Y' ? fast : slow;
            const int y = resolution.slowAxis == 'Y' ? slow : fast;
            const int row = resolution.height() - 1 - y;
            result[static_cast<std::size_t>(row) * static_cast<std::size_t>(resolution.width()) +
                   static_cast<std::size_t>(x)] =
                pixels[static_cast<std::size_t>(line) *
                           static_cast<std::size_t>(resolution.length) +
                       static_cast<std::size_t>(i)];
        }
    return result;
}

/// Header and resolution string; an error without the file's name.
std::string readHeader(Bytes& bytes, Header& header, Resolution& resolution)
{
    std::string line;
    bytes.line(line);
    if (line.rfind("#?", 0) != 0)
        return "does not begin with #?; needed a picture of Radiance";
    bool ends = false;
    while (!ends && bytes.line(line))
    {
        ends = line.empty();
        if (const std::string wrong = readVariable(line, header); !wrong.empty())
            return "its header says \"" + line.substr(0, 80) + "\"; " + wrong;
    }
    if (!ends)
        return "ends in its header; needed an empty line, a resolution string and pixels";
    line.clear();
    bytes.line(line);
    const std::optional<Resolution> found = readResolution(line);
    if (!found)
        return "its resolution string is \"" + line.substr(0, 80) +
               "\"; needed one such as \"-Y 512 +X 1024\"";
    resolution = *found;
    return {};
}

/// What the header says and the picture does not follow.
std::string doubtsOf(const Header& header)
{
    return joined(
        {header.hasFormats
             ? "its FORMAT lines contradict each other; the last one, " + header.format + ", counts"
             : "",
         header.gamma.empty() ? ""
                              : "its GAMMA is " + header.gamma + "; it is taken as linear light",
         header.viewType.empty()
             ? ""
             : "its VIEW is of type " + header.viewType + "; it is taken as latitude-longitude"});
}

/// Empty, or what is wrong with the shape.
std::string complaintOf(const Header& header, const Resolution& resolution, std::size_t maxPixels)
{
    const int width = resolution.width(), height = resolution.height();
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    const double shape = 2.0 * height * header.pixelAspect;
    if (!(std::abs(width - shape) <= (header.pixelAspect == 1.0 ? 0.0 : 1.0)))
        return "is " + size +
               (header.pixelAspect == 1.0 ? std::string()
                                          : ", " + std::to_string(header.pixelAspect) +
                                                " times as high as wide (PIXASPECT)") +
               "; needed 2 : 1 (latitude-longitude)";
    if (width > 16384 || height > 8192 || std::size_t(width) * std::size_t(height) > maxPixels)
        return "is " + size + "; needed at most 16384 x 8192" +
               (maxPixels < (std::size_t(1) << 27) ? " and " + std::to_string(maxPixels) : "");
    return {};
}
} // namespace

Result<EnvironmentPicture> readRadianceFile(const std::string& path, std::size_t maxPixels)
{
    std::ifstream file(path, std::ios::binary);
    if (!file)
        return Error{ErrorCode::NotFound, path + ": cannot be read"};
    const std::string all{std::istreambuf_iterator<char>(file), {}};
    Bytes bytes(all);
    Header header;
    Resolution resolution;
    if (const std::string wrong = readHeader(bytes, header, resolution); !wrong.empty())
        return Error{wrong.find("FORMAT=32") != std::string::npos ? ErrorCode::NotSupported
                                                                  : ErrorCode::Invalid,
                     path + ": " + wrong};
    if (const std::string wrong = complaintOf(header, resolution, maxPixels); !wrong.empty())
        return Error{ErrorCode::Invalid, path + ": " + wrong};
    const std::optional<glm::dmat3> matrix = colourMatrix(header);
    if (!matrix)
        return Error{ErrorCode::Invalid, path + ": its PRIMARIES span no colours"};

    std::vector<Rgb> pixels;
    std::vector<Pixel> line;
    for (int number = 0; number < resolution.lines; ++number)
    {
        if (!readLine(bytes, line, static_cast<std::size_t>(resolution.length)))
            return Error{ErrorCode::Invalid, path + ": is damaged or cut off in scan line " +
                                                 std::to_string(number + 1) + " of " +
                                                 std::to_string(resolution.lines)};
        for (const Pixel& pixel : line)
        {
            const std::array<double, 3> value = valueOf(pixel);
            const glm::dvec3 colour =
                *matrix * glm::dvec3(value[0] / header.exposure[0], value[1] / header.exposure[1],
                                     value[2] / header.exposure[2]);
            pixels.push_back({static_cast<float>(colour.x), static_cast<float>(colour.y),
                              static_cast<float>(colour.z)});
        }
    }
    pixels = upright(std::move(pixels), resolution);
    const std::string warning = joined({makeUsable(pixels), doubtsOf(header)});
    EnvironmentPicture picture =
        fromLatitudeLongitude(resolution.width(), resolution.height(), pixels);
    if (!warning.empty())
        picture.warning = path + ": " + warning;
    return picture;
}

} // namespace osgTerrainLight
