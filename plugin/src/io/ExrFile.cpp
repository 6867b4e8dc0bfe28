#include "io/ExrFile.h"

#include "io/ExrGuard.h"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <new>
#include <random>
#include <system_error>
#include <utility>

namespace osgTerrainLight
{
namespace
{

namespace fs = std::filesystem;

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

    const fs::path target(path);
    std::error_code failure;
    if (fs::is_directory(target, failure))
        return Error{ErrorCode::Failed, path + ": is a folder; needed the name of a file"};
    // A device or a pipe would be replaced by the file that is moved over it.
    if (fs::exists(target, failure) && !fs::is_regular_file(target, failure))
        return Error{ErrorCode::Failed,
                     path + ": is a device or a pipe; needed the name of a file"};
    static std::atomic<unsigned> counter{0};
    // Random rather than the process id, which neither standard library nor OpenEXR gives.
    static const unsigned process = std::random_device{}();
    const fs::path partial =
        target.parent_path() / ("." + target.filename().string() + ".partial-" +
                                std::to_string(process) + "-" + std::to_string(counter++));
    std::string reason;
    try
    {
        writePixels(partial.string(), image, type);
    }
    catch (const Iex::BaseExc& error)
    {
        reason = error.what();
    }
    catch (const std::bad_alloc&)
    {
        reason = "not enough memory";
    }
    // The library names the partial file, which is of no use to whoever reads the message.
    if (const std::size_t at = reason.find(partial.string()); at != std::string::npos)
        reason.replace(at, partial.string().size(), target.filename().string());
    if (reason.empty())
    {
        fs::rename(partial, target, failure);
        if (!failure)
            return Nothing{};
        reason = failure.message();
    }
    fs::remove(partial, failure);
    return Error{ErrorCode::Failed, path + ": cannot be written: " + reason};
}

Result<ExrImage> readExr(const std::string& path, std::size_t maxValues)
{
    return readGuarded(path, [&] { return readPixels(path, maxValues); });
}

} // namespace osgTerrainLight
