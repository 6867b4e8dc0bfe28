#include "FarRadiance.h"

#include "Windows.h"
#include "io/AlbedoFile.h"

#include <glm/gtc/packing.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace osgTerrainLight::tool
{
namespace
{

/// What stands first in a file.
struct Head
{
    std::int32_t column, row, width, height, bounces;
};

constexpr std::size_t postBytes = 3 * sizeof(std::uint16_t);

off_t placeOf(const PostRect& all, int bounce, int column, int row)
{
    const auto posts = (static_cast<off_t>(bounce) * all.height + (row - all.row)) * all.width +
                       (column - all.column);
    return static_cast<off_t>(sizeof(Head)) + posts * static_cast<off_t>(postBytes);
}

bool writeAll(int file, const void* data, std::size_t bytes, off_t at)
{
    const char* from = static_cast<const char*>(data);
    while (bytes > 0)
    {
        const ssize_t written = pwrite(file, from, bytes, at);
        if (written <= 0)
            return false;
        from += written;
        at += written;
        bytes -= static_cast<std::size_t>(written);
    }
    return true;
}

bool readAll(int file, void* data, std::size_t bytes, off_t at)
{
    char* to = static_cast<char*>(data);
    while (bytes > 0)
    {
        const ssize_t got = pread(file, to, bytes, at);
        if (got <= 0)
            return false;
        to += got;
        at += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

/// All of the raster, in posts of the part that is lit.
PostRect wholeRaster(const DemInfo& info)
{
    const PixelWindow& part = info.window;
    const int beyondEast = info.rasterWidth - part.column - part.width;
    const int beyondSouth = info.rasterHeight - part.row - part.height;
    return {-(info.frame.westFirst ? part.column : beyondEast),
            -(info.frame.northUp ? beyondSouth : part.row), info.rasterWidth, info.rasterHeight};
}

/// Posts as pixels of the part that is lit, beyond it too.
PixelWindow pixelsOf(const PostRect& posts, const DemInfo& info)
{
    const PixelWindow& lit = info.window;
    return {info.frame.westFirst ? posts.column : lit.width - posts.endColumn(),
            info.frame.northUp ? lit.height - posts.endRow() : posts.row, posts.width,
            posts.height};
}

} // namespace

FileRadiance::~FileRadiance()
{
    for (const auto& [level, file] : _files)
        ::close(file.number);
}

std::string FileRadiance::path(int level) const
{
    return _folder + "/light-" + std::to_string(level);
}

Error FileRadiance::failed(int level, const char* what) const
{
    return {ErrorCode::Failed, path(level) + ": " + what + ": " +
                                   (errno != 0 ? std::strerror(errno) : "it ends too early")};
}

/// One that is too short was damaged, and is made anew.
bool FileRadiance::has(int level) const
{
    const int file = ::open(path(level).c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return false;
    Head head = {};
    struct stat state = {};
    const bool whole = readAll(file, &head, sizeof head, 0) && ::fstat(file, &state) == 0 &&
                       head.width > 0 && head.height > 0 && head.bounces > 0 &&
                       state.st_size == placeOf({head.column, head.row, head.width, head.height},
                                                head.bounces, head.column, head.row);
    ::close(file);
    return whole;
}

Status FileRadiance::begin(int level, int bounces, const PostRect& posts)
{
    errno = 0;
    const int file =
        ::open((path(level) + ".partial").c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0)
        return failed(level, "cannot be written");
    _files[level] = {file, posts};
    const Head head = {posts.column, posts.row, posts.width, posts.height, bounces};
    return writeAll(file, &head, sizeof head, 0) ? Status(Nothing{})
                                                 : Status(failed(level, "cannot be written"));
}

Status FileRadiance::write(int level, int bounce, const PostRect& posts,
                           const Raster<Rgb>& radiance)
{
    const File& file = _files.at(level);
    std::vector<std::uint16_t> line;
    errno = 0;
    for (int row = 0; row < posts.height; ++row)
    {
        line.clear();
        for (int column = 0; column < posts.width; ++column)
            for (const float channel : radiance.at(column, row))
                line.push_back(glm::packHalf1x16(channel));
        if (!writeAll(file.number, line.data(), line.size() * sizeof line[0],
                      placeOf(file.posts, bounce, posts.column, posts.row + row)))
            return failed(level, "cannot be written");
    }
    return Nothing{};
}

Status FileRadiance::end(int level)
{
    errno = 0;
    if (::fsync(_files.at(level).number) != 0 ||
        std::rename((path(level) + ".partial").c_str(), path(level).c_str()) != 0)
        return failed(level, "cannot be completed");
    return Nothing{};
}

/// One that an earlier run has made.
Status FileRadiance::open(int level)
{
    if (_files.count(level) > 0)
        return Nothing{};
    errno = 0;
    const int number = ::open(path(level).c_str(), O_RDONLY | O_CLOEXEC);
    Head head = {};
    if (number < 0 || !readAll(number, &head, sizeof head, 0))
        return failed(level, "cannot be read");
    _files[level] = {number, {head.column, head.row, head.width, head.height}};
    return Nothing{};
}

Result<Raster<Rgb>> FileRadiance::read(int level, int bounce, const PostRect& posts)
{
    if (Status opened = open(level); !opened)
        return opened.error();
    const File& file = _files.at(level);
    if (!file.posts.contains(posts))
        return Error{ErrorCode::Failed,
                     path(level) + ": does not reach as far as a window sees: needs to be removed"};
    const PostRect both = posts.clippedTo(file.posts);
    Raster<Rgb> radiance(posts.width, posts.height);
    std::vector<std::uint16_t> line(3 * static_cast<std::size_t>(both.width));
    errno = 0;
    for (int row = both.row; row < both.endRow(); ++row)
    {
        if (!readAll(file.number, line.data(), line.size() * sizeof line[0],
                     placeOf(file.posts, bounce, both.column, row)))
            return failed(level, "cannot be read");
        for (int column = 0; column < both.width; ++column)
            for (std::size_t c = 0; c < 3; ++c)
                radiance.at(both.column - posts.column + column, row - posts.row)[c] =
                    glm::unpackHalf1x16(line[3 * static_cast<std::size_t>(column) + c]);
    }
    return radiance;
}

/// In strips of at most so many pixels; each pixel adds to the post that it is nearest to.
Result<Raster<Rgb>> albedoOfLevel(const std::string& path, const DemInfo& info, int level,
                                  const PostRect& posts, const Rgb& other)
{
    constexpr int mostPixels = 1 << 21;
    const int step = 1 << level;
    const int half = step / 2;
    const PostRect all = PostRect{posts.column * step - half, posts.row * step - half,
                                  posts.width * step, posts.height * step}
                             .clippedTo(wholeRaster(info));
    Raster<Rgb> mean(posts.width, posts.height);
    Raster<float> counts(posts.width, posts.height);
    const int rows = std::max(1, mostPixels / std::max(all.width, 1));
    for (int first = all.row; first < all.endRow(); first += rows)
    {
        const PostRect strip = PostRect{all.column, first, all.width, rows}.clippedTo(all);
        const Result<Raster<Rgb>> read = readAlbedo(path, infoOf(pixelsOf(strip, info), info));
        if (!read)
            return read.error();
        for (int y = 0; y < strip.height; ++y)
            for (int x = 0; x < strip.width; ++x)
            {
                const int column = (strip.column + x + half - posts.column * step) / step;
                const int row = (strip.row + y + half - posts.row * step) / step;
                for (std::size_t c = 0; c < 3; ++c)
                    mean.at(column, row)[c] += read->at(x, y)[c];
                counts.at(column, row) += 1.0f;
            }
    }
    for (std::size_t i = 0; i < mean.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            mean.values()[i][c] =
                counts.values()[i] > 0.0f ? mean.values()[i][c] / counts.values()[i] : other[c];
    return mean;
}

} // namespace osgTerrainLight::tool
