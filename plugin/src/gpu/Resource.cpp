#include "gpu/Resource.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"

#include <atomic>

namespace osgTerrainLight
{

namespace
{
using Lock = std::lock_guard<std::mutex>;

std::string nameOf(GLint format)
{
    switch (format)
    {
    case 0:
        return "no format";
    case GL_R8_SNORM:
        return "R8_SNORM";
    case GL_R16:
        return "R16";
    case GL_R32F:
        return "R32F";
    case GL_R32UI:
        return "R32UI";
    case GL_RG16F:
        return "RG16F";
    case GL_RG32F:
        return "RG32F";
    case GL_RGBA16F_ARB:
        return "RGBA16F";
    case GL_RGBA32F_ARB:
        return "RGBA32F";
    default:
        return "format " + std::to_string(format);
    }
}
} // namespace

bool TextureLayout::operator==(const TextureLayout& other) const
{
    return width == other.width && height == other.height && layers == other.layers &&
           format == other.format && depth == other.depth;
}

std::string TextureLayout::text() const
{
    return nameOf(format) + ' ' + std::to_string(width) + " x " + std::to_string(height) +
           (layers > 0 ? " x " + std::to_string(layers) : "") +
           (depth > 0 ? " x " + std::to_string(depth) : "");
}

Resource::Resource(std::string name, const TextureLayout& layout)
    : _name(std::move(name)), _layout(layout)
{
}

Resource::Resource(std::string name, Content content)
    : _name(std::move(name)), _content(std::move(content))
{
}

Resource::Version Resource::next()
{
    static std::atomic<Version> last{0};
    return ++last;
}

void Resource::setLayout(const TextureLayout& layout)
{
    Lock lock(_mutex);
    if (layout != _layout)
        _texture = nullptr;
    _layout = layout;
}

osg::Texture* Resource::texture() const
{
    Lock lock(_mutex);
    return _texture;
}

osg::Texture* Resource::make()
{
    Lock lock(_mutex);
    if (_texture)
        return _texture;
    if (_content)
        _texture = _content();
    else if (_layout.format != 0 && _layout.depth > 0)
        _texture = createVolumeTarget(_layout.width, _layout.height, _layout.depth, _layout.format);
    else if (_layout.format != 0 && _layout.layers > 0)
        _texture =
            createLayeredTarget(_layout.width, _layout.height, _layout.layers, _layout.format);
    else if (_layout.format != 0)
        _texture = createTarget(_layout.width, _layout.height, _layout.format);
    return _texture;
}

void Resource::set(osg::Texture* texture)
{
    Lock lock(_mutex);
    _texture = texture;
    _shared = false;
}

void Resource::share(osg::Texture* texture)
{
    Lock lock(_mutex);
    _texture = texture;
    _shared = true;
}

void Resource::drop()
{
    Lock lock(_mutex);
    _texture = nullptr;
}

Resource::Version Resource::version(unsigned contextID) const
{
    Lock lock(_mutex);
    const auto found = _versions.find(contextID);
    return found != _versions.end() ? found->second : _version;
}

void Resource::touch()
{
    Lock lock(_mutex);
    _version = next();
    _versions.clear();
}

void Resource::touch(unsigned contextID)
{
    Lock lock(_mutex);
    _versions[contextID] = next();
}

std::size_t Resource::bytes() const
{
    Lock lock(_mutex);
    return _texture && !_shared ? textureBytes(*_texture) : 0;
}

void Resource::releaseGLObjects(osg::State* state) const
{
    Lock lock(_mutex);
    if (_texture)
        _texture->releaseGLObjects(state);
}

void Resource::resizeGLObjectBuffers(unsigned size)
{
    Lock lock(_mutex);
    if (_texture)
        _texture->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
