#include "io/AlbedoFile.h"
#include "io/EnvironmentFile.h"
#include <osgTerrainLight/Environment.h>

#include <osg/Image>
#include <osg/Notify>
#include <osgDB/FileNameUtils>
#include <osgDB/ReadFile>

#include <exception>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

namespace osgTerrainLight
{

namespace
{
Error noRadiance(const std::string& path)
{
    std::error_code failure;
    if (!std::filesystem::exists(path, failure))
        return {ErrorCode::NotFound, path + ": no such file"};
    return {ErrorCode::Invalid, path + ": does not begin with #?; needed a picture of Radiance"};
}

/// Floats are linear, bytes and the like sRGB.
Result<EnvironmentPicture> readByPlugin(const std::string& path)
{
    std::error_code failure;
    if (!std::filesystem::exists(path, failure))
        return Error{ErrorCode::NotFound, path + ": no such file"};
    osgDB::ReaderWriter::ReadResult read = osgDB::Registry::instance()->readImage(path, nullptr);
    const osg::ref_ptr<osg::Image> image = read.takeImage();
    if (!image || image->s() < 1 || image->t() < 1 || !image->data())
        return Error{ErrorCode::Invalid,
                     path + ": no plugin of OpenSceneGraph reads it as a picture" +
                         (read.message().empty() ? "" : " (" + read.message() + ")") +
                         "; needed OpenEXR, .hdr or another picture"};
    const std::string size = std::to_string(image->s()) + " x " + std::to_string(image->t());
    if (image->s() != 2 * image->t() || image->t() > 8192)
        return Error{ErrorCode::Invalid, path + ": is " + size +
                                             " pixels; needed 2 : 1 (latitude-longitude), at most "
                                             "16384 x 8192"};
    const GLenum type = image->getDataType();
    if (image->isCompressed() ||
        (type != GL_UNSIGNED_BYTE && type != GL_UNSIGNED_SHORT && type != GL_FLOAT))
        return Error{ErrorCode::NotSupported,
                     path + ": has pixels of OpenGL's type " + std::to_string(type) +
                         "; needed floats, bytes or 16-bit integers, not compressed"};
    const bool isLinear = type == GL_FLOAT;
    const bool fromTop = image->getOrigin() == osg::Image::TOP_LEFT;
    std::vector<Rgb> pixels;
    pixels.reserve(static_cast<std::size_t>(image->s()) * static_cast<std::size_t>(image->t()));
    for (int y = 0; y < image->t(); ++y)
        for (int x = 0; x < image->s(); ++x)
        {
            const osg::Vec4 colour = image->getColor(
                static_cast<unsigned>(x), static_cast<unsigned>(fromTop ? y : image->t() - 1 - y));
            Rgb pixel = {colour[0], colour[1], colour[2]};
            if (!isLinear)
                for (float& value : pixel)
                    value = linearOfSrgb(value);
            pixels.push_back(pixel);
        }
    const std::string warning = makeUsable(pixels);
    EnvironmentPicture picture = fromLatitudeLongitude(image->s(), image->t(), pixels);
    if (!warning.empty())
        picture.warning = path + ": " + warning;
    return picture;
}
} // namespace

std::shared_ptr<const Environment> readEnvironment(const std::string& path, std::string& problem)
try
{
    // Damaged files never reach a plugin, whose readers trust them: what claims to be of a kind
    // that we read ourselves, by its content or its name, is read so.
    const std::string extension = osgDB::getLowerCaseFileExtension(path);
    Result<EnvironmentPicture> picture =
        formatOf(path) != PictureFormat::Other || extension == "exr" ? readEnvironmentFile(path)
        : extension == "hdr" || extension == "pic" ? Result<EnvironmentPicture>(noRadiance(path))
                                                   : readByPlugin(path);
    if (!picture)
    {
        problem = picture.error().message;
        return nullptr;
    }
    if (!picture->warning.empty())
        OSG_WARN << "osgTerrainLight: " << picture->warning << std::endl;
    const std::shared_ptr<const Environment> made =
        createEnvironment(picture->columns, picture->rows, std::move(picture->radiance), problem);
    if (!made)
    {
        problem = path + ": " + problem;
        return nullptr;
    }
    // Nobody else has it yet.
    std::const_pointer_cast<Environment>(made)->name = path;
    return made;
}
catch (const std::exception& error) // of a plugin, or no memory
{
    problem = path + ": cannot be read: " + error.what();
    return nullptr;
}

} // namespace osgTerrainLight
