#pragma once

#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture>

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace osgTerrainLight
{

/// Size and format of a texture that passes write.
struct TextureLayout
{
    int width = 0, height = 0; ///< [texels]
    int layers = 0;            ///< 0: not an array
    GLint format = 0;          ///< internal: GL_R32F, GL_RGBA16F, …
    int depth = 0;             ///< slices; 0: not a volume

    bool operator==(const TextureLayout& other) const;
    bool operator!=(const TextureLayout& other) const { return !(*this == other); }
    /// For messages: "RGBA16F 512 x 512".
    std::string text() const;
};

/// A value that nodes of a WorkGraph read and write: a texture, or something from outside that only
/// says when it has changed (settings, the sun's place). It has a version per graphics context, so
/// that nodes of any graph can tell whether they are behind it.
///
/// It owns its texture, which exists only where make() asked for it and drop() did not follow.
class Resource : public osg::Referenced
{
public:
    using Version = unsigned long;
    using Content = std::function<osg::ref_ptr<osg::Texture>()>;

    /// A value without a texture.
    explicit Resource(std::string name) : _name(std::move(name)) {}
    /// A texture that passes write.
    Resource(std::string name, const TextureLayout& layout);
    /// A texture whose content comes from the CPU: `content` is called when it is to exist.
    Resource(std::string name, Content content);

    const std::string& name() const { return _name; }
    /// Empty where there is no texture, or the CPU makes it.
    const TextureLayout& layout() const { return _layout; }
    /// Passes write it in one dispatch, also where their node runs in pieces: it is drawn, or is
    /// made of what may change before all pieces have run.
    void keepWhole() { _isWhole = true; }
    bool isWhole() const { return _isWhole; }
    /// Drops the texture where it has another layout.
    void setLayout(const TextureLayout& layout);

    /// Null where it does not exist.
    osg::Texture* texture() const;
    /// The texture, which exists from now on; null where the value has none.
    osg::Texture* make();
    /// In place of the one there was: for a node that makes its texture on the CPU.
    void set(osg::Texture* texture);
    /// The same for a texture that others own, too: its bytes are not counted.
    void share(osg::Texture* texture);
    void drop();

    /// Changes where the value does.
    Version version(unsigned contextID) const;
    /// The value has changed: in every context, or in one.
    void touch();
    void touch(unsigned contextID);

    std::size_t bytes() const;
    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

protected:
    ~Resource() override = default;

private:
    const std::string _name;
    bool _isWhole = false;
    TextureLayout _layout;
    Content _content;
    mutable std::mutex _mutex; ///< of what follows
    osg::ref_ptr<osg::Texture> _texture;
    bool _shared = false;
    Version _version = next(); ///< where a context has none of its own
    std::map<unsigned, Version> _versions;

    static Version next();
};

} // namespace osgTerrainLight
