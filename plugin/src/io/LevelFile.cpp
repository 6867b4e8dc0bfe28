#include "io/LevelFile.h"

#include <cpl_string.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <sstream>
#include <utility>

namespace osgTerrainLight
{
namespace
{
constexpr float missing = std::numeric_limits<float>::quiet_NaN();

struct Head
{
    char magic[8] = {'O', 'T', 'L', 'l', 'e', 'v', 'e', 'l'};
    std::uint32_t byteOrder = 0x01020304;
    std::uint32_t version = 1;
    std::uint64_t text = 0;     ///< its place in the file; it goes on to the end
    std::uint64_t checksum = 0; ///< of the text
};

/// All digits of it, in hexadecimal.
std::string exact(double value)
{
    return CPLSPrintf("%a", value);
}

std::string textOf(const LevelFacts& facts)
{
    std::ostringstream text;
    text << "stamp " << facts.stamp << '\n';
    for (const LevelPlane& plane : facts.planes)
        text << "plane " << plane.level << ' ' << plane.posts.column << ' ' << plane.posts.row
             << ' ' << plane.posts.width << ' ' << plane.posts.height << ' ' << plane.hasCrests
             << '\n';
    for (const double value : facts.rules.voids)
        text << "void " << exact(value) << '\n';
    text << "rules " << exact(facts.rules.lowest) << ' ' << exact(facts.rules.highest) << ' '
         << facts.rules.kilometres << ' ' << exact(facts.rules.radius) << '\n';
    text << "heights " << exact(facts.lowest) << ' ' << exact(facts.highest) << '\n';
    for (std::string note : facts.notes)
    {
        std::replace(note.begin(), note.end(), '\n', ' ');
        text << "note " << note << '\n';
    }
    return text.str();
}

double numberFrom(std::istream& line)
{
    std::string word; // streams do not read hexadecimal fractions
    line >> word;
    return std::strtod(word.c_str(), nullptr);
}

LevelFacts factsOf(const std::string& text)
{
    LevelFacts facts;
    std::istringstream lines(text);
    for (std::string all; std::getline(lines, all);)
    {
        const std::size_t gap = std::min(all.find(' '), all.size());
        const std::string key = all.substr(0, gap);
        const std::string rest = all.substr(std::min(gap + 1, all.size()));
        std::istringstream line(rest);
        if (key == "stamp")
            facts.stamp = rest;
        else if (key == "note")
            facts.notes.push_back(rest);
        else if (key == "void")
            facts.rules.voids.push_back(numberFrom(line));
        else if (key == "plane")
        {
            LevelPlane plane;
            line >> plane.level >> plane.posts.column >> plane.posts.row >> plane.posts.width >>
                plane.posts.height >> plane.hasCrests;
            facts.planes.push_back(plane);
        }
        else if (key == "rules")
        {
            facts.rules.lowest = numberFrom(line);
            facts.rules.highest = numberFrom(line);
            line >> facts.rules.kilometres;
            facts.rules.radius = numberFrom(line);
        }
        else if (key == "heights")
        {
            facts.lowest = numberFrom(line);
            facts.highest = numberFrom(line);
        }
    }
    return facts;
}

/// Bytes of rows of a plane.
std::uint64_t bytesOf(const LevelPlane& plane, int rows)
{
    return static_cast<std::uint64_t>(plane.posts.width) * static_cast<std::uint64_t>(rows) *
           sizeof(float);
}

std::uint64_t endOf(const std::vector<LevelPlane>& planes)
{
    std::uint64_t at = sizeof(Head);
    for (const LevelPlane& plane : planes)
        at += (plane.hasCrests ? 2 : 1) * bytesOf(plane, plane.posts.height);
    return at;
}

const LevelPlane* find(const std::vector<LevelPlane>& planes, int level)
{
    for (const LevelPlane& plane : planes)
        if (plane.level == level)
            return &plane;
    return nullptr;
}

/// Where a post of a plane lies in the file. column, row: from the plane's south-west.
std::uint64_t placeOf(const std::vector<LevelPlane>& planes, const LevelPlane& plane,
                      CrestAxis axis, int column, int row)
{
    std::uint64_t at = sizeof(Head);
    for (const LevelPlane* before = planes.data(); before != &plane; ++before)
        at += (before->hasCrests ? 2 : 1) * bytesOf(*before, before->posts.height);
    if (plane.hasCrests && axis == CrestAxis::North)
        at += bytesOf(plane, plane.posts.height);
    return at + bytesOf(plane, row) + static_cast<std::uint64_t>(column) * sizeof(float);
}

bool writeAll(VSILFILE* file, const void* bytes, std::size_t count)
{
    return VSIFWriteL(bytes, 1, count, file) == count;
}
} // namespace

std::uint64_t checksumOf(const std::string& text)
{
    // FNV-1a
    std::uint64_t hash = 14695981039346656037u;
    for (const char letter : text)
        hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211u;
    return hash;
}

LevelFile::~LevelFile()
{
    if (_file)
        VSIFCloseL(_file);
}

Result<std::unique_ptr<LevelFile>> LevelFile::open(const std::string& path)
{
    const auto damaged = [&path](const char* why) {
        return Error{ErrorCode::Invalid, path + ": " + why};
    };
    std::unique_ptr<LevelFile> made(new LevelFile);
    made->_path = path;
    made->_file = VSIFOpenL(path.c_str(), "rb");
    if (!made->_file)
        return Error{ErrorCode::NotFound, path + ": no such file"};
    Head head;
    const Head expected;
    if (VSIFReadL(&head, sizeof head, 1, made->_file) != 1 ||
        std::memcmp(head.magic, expected.magic, sizeof head.magic) != 0)
        return damaged("is no file of coarse levels");
    if (head.byteOrder != expected.byteOrder || head.version != expected.version)
        return damaged("was made by another version or machine");
    VSIFSeekL(made->_file, 0, SEEK_END);
    const std::uint64_t size = VSIFTellL(made->_file);
    constexpr std::uint64_t longest = 1 << 20; // of a text
    if (head.text < sizeof head || head.text >= size || size - head.text > longest)
        return damaged("is truncated or damaged");
    std::string text(static_cast<std::size_t>(size - head.text), ' ');
    VSIFSeekL(made->_file, head.text, SEEK_SET);
    if (VSIFReadL(text.data(), text.size(), 1, made->_file) != 1 ||
        checksumOf(text) != head.checksum)
        return damaged("is truncated or damaged");
    made->_facts = factsOf(text);
    if (endOf(made->_facts.planes) != head.text)
        return damaged("is truncated or damaged");
    return made;
}

const LevelPlane* LevelFile::plane(int level) const
{
    return find(_facts.planes, level);
}

Result<Raster<float>> LevelFile::read(int level, CrestAxis axis, const PostRect& posts)
{
    Raster<float> result(std::max(0, posts.width), std::max(0, posts.height), missing);
    const LevelPlane* from = plane(level);
    const PostRect inside = from ? posts.clippedTo(from->posts) : PostRect();
    if (inside.empty())
        return result;
    const auto count = static_cast<std::size_t>(inside.width);
    for (int row = inside.row; row < inside.endRow(); ++row)
    {
        const std::uint64_t at = placeOf(_facts.planes, *from, axis,
                                         inside.column - from->posts.column, row - from->posts.row);
        if (VSIFSeekL(_file, at, SEEK_SET) != 0 ||
            VSIFReadL(&result.at(inside.column - posts.column, row - posts.row), sizeof(float),
                      count, _file) != count)
            return Error{ErrorCode::Failed, _path + ": cannot read row " + std::to_string(row) +
                                                " of level " + std::to_string(level) +
                                                "; removed, it is made anew"};
    }
    return result;
}

LevelFileWriter::~LevelFileWriter()
{
    if (_file)
        VSIFCloseL(_file);
}

double LevelFileWriter::bytes(const std::vector<LevelPlane>& planes)
{
    return static_cast<double>(endOf(planes));
}

bool LevelFileWriter::keep(bool written)
{
    _failed = _failed || !written;
    return written;
}

bool LevelFileWriter::create(const std::string& path, std::vector<LevelPlane> planes)
{
    _planes = std::move(planes);
    _file = VSIFOpenL(path.c_str(), "wb");
    const Head nothing{{}, 0, 0, 0, 0};
    return keep(_file && writeAll(_file, &nothing, sizeof nothing));
}

bool LevelFileWriter::writeRow(int level, CrestAxis axis, int row, const float* heights)
{
    const LevelPlane* plane = find(_planes, level);
    assert(_file && plane && row >= 0 && row < plane->posts.height);
    return keep(VSIFSeekL(_file, placeOf(_planes, *plane, axis, 0, row), SEEK_SET) == 0 &&
                writeAll(_file, heights, static_cast<std::size_t>(bytesOf(*plane, 1))));
}

bool LevelFileWriter::finish(LevelFacts facts)
{
    facts.planes = _planes;
    const std::string text = textOf(facts);
    Head head;
    head.text = endOf(_planes);
    head.checksum = checksumOf(text);
    const bool written = VSIFSeekL(_file, head.text, SEEK_SET) == 0 &&
                         writeAll(_file, text.data(), text.size()) &&
                         VSIFSeekL(_file, 0, SEEK_SET) == 0 && writeAll(_file, &head, sizeof head);
    return keep(VSIFCloseL(std::exchange(_file, nullptr)) == 0 && written);
}

} // namespace osgTerrainLight
