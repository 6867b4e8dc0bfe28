#include "io/ExrFile.h"

#include "io/ExrGuard.h"
#include "io/PendingFile.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <new>
#include <utility>

namespace osgTerrainLight
{
namespace
{

std::string size(int width, int height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

Status writePixels(const std::string& path, const ExrImage& image, ExrPixelType type)
{
    const bool half = type == ExrPixelType::Half;
    const auto width = static_cast<std::size_t>(image.width);
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [key, value] : image.text)
        header.insert(key, Imf::StringAttribute(value));

    std::vector<std::vector<Imath::half>> halves(half ? image.channels.size() : 0);
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < image.channels.size(); ++i)
    {
        const ExrChannel& channel = image.channels[i];
        header.channels().insert(channel.name, Imf::Channel(half ? Imf::HALF : Imf::FLOAT));
        const void* data = channel.values.data();
        if (half)
        {
            halves[i].assign(channel.values.begin(), channel.values.end());
            data = halves[i].data();
        }
        const std::size_t bytes = half ? sizeof(Imath::half) : sizeof(float);
        // The library takes a pointer to non-const for reading and writing alike.
        buffer.insert(channel.name, Imf::Slice(half ? Imf::HALF : Imf::FLOAT,
                                               static_cast<char*>(const_cast<void*>(data)), bytes,
                                               bytes * width));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(image.height);
    return Nothing{};
}

Result<ExrImage> readPixels(const std::string& path, std::size_t maxValues)
{
    // Headers before pixels: a part that is opened has its buffers already.
    Imf::MultiPartInputFile file(path.c_str());
    const Imf::Header& header = file.header(0);
    if (header.hasType() && Imf::isDeepData(header.type()))
        return Error{ErrorCode::NotSupported,
                     path + ": has deep pixels; needed one value per pixel"};
    const Imath::Box2i window = header.dataWindow();
    // In 64 bits: a damaged header's corners may be anything.
    const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
    const std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
    std::size_t count = 0;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
    {
        if (i.channel().xSampling != 1 || i.channel().ySampling != 1)
            return Error{ErrorCode::NotSupported,
                         path + ": channel " + i.name() +
                             " is sub-sampled; needed one value per pixel"};
        ++count;
    }
    if (width < 1 || height < 1 || count == 0)
        return Error{ErrorCode::Invalid, path + ": holds no pixels"};
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (pixels > maxValues / count)
        return Error{ErrorCode::Invalid, path + ": " + std::to_string(width) + " x " +
                                             std::to_string(height) + " pixels of " +
                                             std::to_string(count) +
                                             " channels are more than the limit of " +
                                             std::to_string(maxValues) + " values"};

    ExrImage image;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    for (auto i = header.begin(); i != header.end(); ++i)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
            image.text[i.name()] = text->value();
    Imf::FrameBuffer buffer;
    image.channels.reserve(count);
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
    {
        image.channels.push_back({i.name(), std::vector<float>(pixels)});
        buffer.insert(i.name(), Imf::Slice::Make(Imf::FLOAT, image.channels.back().values.data(),
                                                 header.dataWindow()));
    }
    Imf::InputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
    return image;
}

/// Reads the file and compares every value. The message is without the file's name.
Status compare(const std::string& path, const ExrImage& image, ExrPixelType type)
{
    const Error wrong{ErrorCode::Failed, "what was written cannot be read again"};
    const Result<ExrImage> read = readExr(path, std::numeric_limits<std::size_t>::max());
    if (!read || read->width != image.width || read->height != image.height ||
        read->channels.size() != image.channels.size())
        return wrong;
    for (const ExrChannel& channel : image.channels)
    {
        const ExrChannel* found = read->find(channel.name);
        for (std::size_t i = 0; found && i < channel.values.size(); ++i)
        {
            const float put = channel.values[i];
            const float value = type == ExrPixelType::Half ? float(Imath::half(put)) : put;
            if (found->values[i] != value && !(std::isnan(found->values[i]) && std::isnan(value)))
                found = nullptr;
        }
        if (!found)
            return wrong;
    }
    return Nothing{};
}

Status writeGuarded(const std::string& path, const ExrImage& image, ExrPixelType type)
{
    try
    {
        if (Status written = writePixels(path, image, type); !written)
            return written;
        return compare(path, image, type);
    }
    catch (const std::bad_alloc&)
    {
        return Error{ErrorCode::Failed, "not enough memory"};
    }
    catch (const std::exception& error) // Iex::BaseExc above all
    {
        return Error{ErrorCode::Failed, error.what()};
    }
}

} // namespace

const ExrChannel* ExrImage::find(const std::string& name) const
{
    for (const ExrChannel& channel : channels)
        if (channel.name == name)
            return &channel;
    return nullptr;
}

Status writeExr(const std::string& path, const ExrImage& image, ExrPixelType type)
{
    if (image.width < 1 || image.height < 1 || image.channels.empty())
        return Error{ErrorCode::Invalid, path + ": an image of " + size(image.width, image.height) +
                                             " with " + std::to_string(image.channels.size()) +
                                             " channels; needed at least one of each"};
    const std::size_t pixels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    for (const ExrChannel& channel : image.channels)
        if (channel.name.empty() || channel.values.size() != pixels ||
            image.find(channel.name) != &channel)
            return Error{ErrorCode::Invalid, path + ": channel \"" + channel.name + "\" has " +
                                                 std::to_string(channel.values.size()) +
                                                 " values; needed " + std::to_string(pixels) +
                                                 " and a name that no other has"};

    PendingFile file(path);
    if (Status created = file.create(true); !created)
        return created;
    const Status written = writeGuarded(file.path(), image, type);
    if (!written)
        return Error{ErrorCode::Failed,
                     path + ": cannot be written: " +
                         file.reason(written.error().message,
                                     static_cast<double>(pixels * image.channels.size() *
                                                         (type == ExrPixelType::Half ? 2 : 4)))};
    return file.commit();
}

Result<ExrImage> readExr(const std::string& path, std::size_t maxValues)
{
    return readGuarded(path, [&] { return readPixels(path, maxValues); });
}

} // namespace osgTerrainLight
