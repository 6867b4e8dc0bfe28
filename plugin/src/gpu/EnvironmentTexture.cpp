#include "gpu/EnvironmentTexture.h"

#include "gpu/GlConstants.h"

#include <osg/Image>
#include <osg/observer_ptr>

#include <map>
#include <mutex>
#include <utility>

namespace osgTerrainLight
{

namespace
{
/// The environment's own memory, held for as long as a texture may be loaded from it.
class EnvironmentImage : public osg::Image
{
public:
    explicit EnvironmentImage(std::shared_ptr<const Environment> environment)
        : _environment(std::move(environment))
    {
        // OSG takes what it only reads as unsigned char*.
        auto* data = const_cast<Rgb*>(_environment->radiance.data());
        setImage(_environment->columns, _environment->rows, 1, GL_RGB32F_ARB, GL_RGB, GL_FLOAT,
                 reinterpret_cast<unsigned char*>(data), NO_DELETE);
    }

    const Environment* environment() const { return _environment.get(); }

private:
    ~EnvironmentImage() override = default;
    std::shared_ptr<const Environment> _environment;
};
} // namespace

osg::ref_ptr<osg::Texture2D> environmentTexture(const std::shared_ptr<const Environment>& from)
{
    static std::mutex mutex;
    static std::map<const Environment*, osg::observer_ptr<osg::Texture2D>> known;
    const std::lock_guard<std::mutex> lock(mutex);
    // What is gone may have left its address to another.
    for (auto entry = known.begin(); entry != known.end();)
        entry = entry->second.valid() ? std::next(entry) : known.erase(entry);
    osg::ref_ptr<osg::Texture2D> texture;
    if (known[from.get()].lock(texture))
        return texture;
    texture = new osg::Texture2D(new EnvironmentImage(from));
    texture->setInternalFormat(GL_RGB32F_ARB);
    texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR);
    texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
    texture->setWrap(osg::Texture::WRAP_S, osg::Texture::REPEAT);
    texture->setWrap(osg::Texture::WRAP_T, osg::Texture::CLAMP_TO_EDGE);
    texture->setResizeNonPowerOfTwoHint(false);
    known[from.get()] = texture;
    return texture;
}

} // namespace osgTerrainLight
