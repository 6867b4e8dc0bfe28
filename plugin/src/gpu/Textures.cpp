#include "gpu/Textures.h"

#include "gpu/GlConstants.h"

#include <osg/GLExtensions>
#include <osg/Image>

#include <algorithm>
#include <cassert>
#include <cstring>

namespace osgTerrainLight
{

namespace
{
struct Format
{
    GLint internal;
    GLenum format, type;
    std::size_t bytes;
};

Format formatOf(GLint internalFormat)
{
    switch (internalFormat)
    {
    case GL_R8_SNORM:
        return {internalFormat, GL_RED, GL_BYTE, 1};
    case GL_R16:
        return {internalFormat, GL_RED, GL_UNSIGNED_SHORT, 2};
    case GL_R32UI:
        return {internalFormat, GL_RED_INTEGER, GL_UNSIGNED_INT, 4};
    case GL_RG16F:
        return {internalFormat, GL_RG, GL_HALF_FLOAT, 4};
    case GL_RG32F:
        return {internalFormat, GL_RG, GL_FLOAT, 8};
    case GL_RGBA16F_ARB:
        return {internalFormat, GL_RGBA, GL_HALF_FLOAT, 8};
    case GL_RGBA32F_ARB:
        return {internalFormat, GL_RGBA, GL_FLOAT, 16};
    default:
        assert(internalFormat == GL_R32F);
        return {internalFormat, GL_RED, GL_FLOAT, 4};
    }
}

void prepare(osg::Texture& texture, const Format& format)
{
    texture.setInternalFormat(format.internal);
    texture.setSourceFormat(format.format);
    texture.setSourceType(format.type);
    const auto filter = format.internal == GL_R32UI ? osg::Texture::NEAREST : osg::Texture::LINEAR;
    texture.setFilter(osg::Texture::MIN_FILTER, filter);
    texture.setFilter(osg::Texture::MAG_FILTER, filter);
    texture.setWrap(osg::Texture::WRAP_S, osg::Texture::CLAMP_TO_EDGE);
    texture.setWrap(osg::Texture::WRAP_T, osg::Texture::CLAMP_TO_EDGE);
    texture.setWrap(osg::Texture::WRAP_R, osg::Texture::CLAMP_TO_EDGE);
    texture.setResizeNonPowerOfTwoHint(false);
}

/// Allocates an array or a volume without content. Left to itself, OSG takes a released texture of
/// the same kind and asks for immutable storage a second time, which OpenGL refuses with an error.
template <class Texture>
class LayeredAllocation : public Texture::SubloadCallback
{
public:
    void load(const Texture& texture, osg::State& state) const override
    {
        state.get<osg::GLExtensions>()->glTexImage3D(
            texture.getTextureTarget(), 0, static_cast<GLenum>(texture.getInternalFormat()),
            texture.getTextureWidth(), texture.getTextureHeight(), texture.getTextureDepth(), 0,
            texture.getSourceFormat(), texture.getSourceType(), nullptr);
    }
    void subload(const Texture&, osg::State&) const override {}
};

template <class Texture>
osg::ref_ptr<Texture> createLayered(int width, int height, int layers, GLint internalFormat)
{
    osg::ref_ptr<Texture> texture = new Texture;
    prepare(*texture, formatOf(internalFormat));
    texture->setTextureSize(width, height, layers);
    texture->setSubloadCallback(new LayeredAllocation<Texture>);
    return texture;
}

template <class T>
std::vector<T> read(osg::State& state, osg::Texture& texture, GLenum format, GLenum type,
                    int channels)
{
    const int layers = std::max(1, texture.getTextureDepth());
    std::vector<T> values(static_cast<std::size_t>(texture.getTextureWidth()) *
                          static_cast<std::size_t>(texture.getTextureHeight()) *
                          static_cast<std::size_t>(layers) * static_cast<std::size_t>(channels));
    state.setActiveTextureUnit(0);
    texture.apply(state);
    state.haveAppliedTextureAttribute(0, osg::StateAttribute::TEXTURE);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(texture.getTextureTarget(), 0, format, type, values.data());
    return values;
}
} // namespace

osg::ref_ptr<osg::Texture2D> createFloatTexture(const Raster<float>& values)
{
    osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(values.width(), values.height(), 1, GL_RED, GL_FLOAT, 1);
    std::memcpy(image->data(), values.data(), values.size() * sizeof(float));
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
    prepare(*texture, formatOf(GL_R32F));
    return texture;
}

osg::ref_ptr<osg::Texture2D> createColourTexture(const Raster<std::array<float, 3>>& colours)
{
    osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(colours.width(), colours.height(), 1, GL_RGBA, GL_FLOAT, 1);
    auto* texel = reinterpret_cast<float*>(image->data());
    for (const std::array<float, 3>& colour : colours.values())
    {
        texel = std::copy(colour.begin(), colour.end(), texel);
        *texel++ = 1.0f;
    }
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
    Format format = formatOf(GL_RGBA16F_ARB);
    format.type = GL_FLOAT;
    prepare(*texture, format);
    return texture;
}

osg::ref_ptr<osg::Texture2D> createHeightTexture(const DemTile& tile, int frame, double bodyRadius)
{
    constexpr float voidHeight = -1.0e30f; // VOID_HEIGHT of lib/surface.glsl
    Raster<float> framed(tile.width() + 2 * frame, tile.height() + 2 * frame, voidHeight);
    for (int y = 0; y < tile.height(); ++y)
        for (int x = 0; x < tile.width(); ++x)
            if (tile.isValid(x, y))
                framed.at(x + frame, y + frame) = static_cast<float>(
                    static_cast<double>(tile.heightAt(x, y)) - tile.sinkAt(x, y, bodyRadius));
    return createFloatTexture(framed);
}

osg::ref_ptr<osg::Texture2D> createSpacingTexture(const DemTile& tile)
{
    Raster<float> spacings(1, tile.height());
    for (int y = 0; y < tile.height(); ++y)
        spacings.at(0, y) = static_cast<float>(tile.eastSpacing(y));
    return createFloatTexture(spacings);
}

osg::ref_ptr<osg::Texture2D> createTarget(int width, int height, GLint internalFormat)
{
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D;
    const Format format = formatOf(internalFormat);
    prepare(*texture, format);
    texture->setTextureSize(width, height);
    if (internalFormat == GL_R32UI) // a counter: starts at 0
    {
        osg::ref_ptr<osg::Image> zeros = new osg::Image;
        zeros->allocateImage(width, height, 1, format.format, format.type, 1);
        std::memset(zeros->data(), 0, zeros->getTotalSizeInBytes());
        texture->setImage(zeros);
    }
    return texture;
}

osg::ref_ptr<osg::Texture2DArray> createLayeredTarget(int width, int height, int layers,
                                                      GLint internalFormat)
{
    return createLayered<osg::Texture2DArray>(width, height, layers, internalFormat);
}

osg::ref_ptr<osg::Texture3D> createVolumeTarget(int width, int height, int depth,
                                                GLint internalFormat)
{
    return createLayered<osg::Texture3D>(width, height, depth, internalFormat);
}

std::size_t textureBytes(const osg::Texture& texture)
{
    const auto image = texture.getImage(0);
    const std::size_t width =
        static_cast<std::size_t>(image ? image->s() : texture.getTextureWidth());
    const std::size_t height =
        static_cast<std::size_t>(image ? image->t() : texture.getTextureHeight());
    const std::size_t layers = static_cast<std::size_t>(std::max(1, texture.getTextureDepth()));
    return width * height * layers * formatOf(texture.getInternalFormat()).bytes;
}

std::vector<float> readFloats(osg::State& state, osg::Texture& texture, int channels)
{
    return read<float>(state, texture,
                       channels == 4   ? GL_RGBA
                       : channels == 2 ? GL_RG
                                       : GL_RED,
                       GL_FLOAT, channels);
}

std::vector<std::uint16_t> readUnorm16(osg::State& state, osg::Texture& texture)
{
    return read<std::uint16_t>(state, texture, GL_RED, GL_UNSIGNED_SHORT, 1);
}

std::vector<std::uint32_t> readUints(osg::State& state, osg::Texture& texture)
{
    return read<std::uint32_t>(state, texture, GL_RED_INTEGER, GL_UNSIGNED_INT, 1);
}

} // namespace osgTerrainLight
