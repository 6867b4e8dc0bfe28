#include "FarRadiance.h"

#include "Windows.h"
#include "io/AlbedoFile.h"

#include <glm/gtc/packing.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

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
    std::int32_t column, row, width, height;
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

bool FileRadiance::has(int level) const
{
    return ::access(path(level).c_str(), R_OK) == 0;
}

Status FileRadiance::begin(int level, int, const PostRect& posts)
{
    errno = 0;
    const int file =
        ::open((path(level) + ".partial").c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0)
        return failed(level, "cannot be written");
    _files[level] = {file, posts};
    const Head head = {posts.column, posts.row, posts.width, posts.height};
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

Result<Raster<Rgb>> albedoOfLevel(const std::string& path, const DemInfo& info, int level,
                                  const PostRect& posts, const Rgb& other)
{
    const int step = 1 << level;
    const PostRect all = {0, 0, info.frame.width, info.frame.height};
    Raster<Rgb> mean(posts.width, posts.height, other);
    for (int row = 0; row < posts.height; ++row)
    {
        // What lies half way to the next posts, a strip at a time.
        const PostRect strip =
            PostRect{posts.column * step - step / 2, (posts.row + row) * step - step / 2,
                     posts.width * step, step}
                .clippedTo(all);
        if (strip.empty())
            continue;
        const PostRect pixels = {info.frame.westFirst ? strip.column
                                                      : all.width - strip.endColumn(),
                                 info.frame.northUp ? all.height - strip.endRow() : strip.row,
                                 strip.width, strip.height};
        const Result<Raster<Rgb>> read = readAlbedo(
            path, infoOf({pixels.column, pixels.row, pixels.width, pixels.height}, info));
        if (!read)
            return read.error();
        for (int column = 0; column < posts.width; ++column)
        {
            const int first = (posts.column + column) * step - step / 2 - strip.column;
            Rgb sum = {};
            int count = 0;
            for (int y = 0; y < strip.height; ++y)
                for (int x = std::max(first, 0); x < std::min(first + step, strip.width); ++x)
                {
                    for (std::size_t c = 0; c < 3; ++c)
                        sum[c] += read->at(x, y)[c];
                    ++count;
                }
            for (std::size_t c = 0; count > 0 && c < 3; ++c)
                mean.at(column, row)[c] = sum[c] / static_cast<float>(count);
        }
    }
    return mean;
}

} // namespace osgTerrainLight::tool
