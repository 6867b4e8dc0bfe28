#include "gpu/HeightTexture.h"

#include "gpu/GlConstants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <vector>

namespace osgTerrainLight
{

namespace
{
constexpr float voidHeight = -1.0e30f;   // VOID_HEIGHT of lib/surface.glsl
constexpr float greatestHeight = 1.0e6f; // as DemTile
} // namespace

/// The posts, and which of them each context has. An osg::Image would be read by one thread while
/// another changes it.
class HeightTexture::Upload : public osg::Texture2D::SubloadCallback
{
public:
    Upload(int width, int height)
        : _width(width), _height(height),
          _posts(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), voidHeight)
    {
    }

    std::pair<float, float> set(const float* heights)
    {
        std::lock_guard<std::mutex> lock(_mutex);
        std::pair<float, float> range{std::numeric_limits<float>::max(),
                                      std::numeric_limits<float>::lowest()};
        for (std::size_t i = 0; i < _posts.size(); ++i)
        {
            const bool valid = std::abs(heights[i]) <= greatestHeight; // false for NaN
            _posts[i] = valid ? heights[i] : voidHeight;
            if (valid)
                range = {std::min(range.first, heights[i]), std::max(range.second, heights[i])};
        }
        ++_revision;
        return range;
    }

    void load(const osg::Texture2D&, osg::State& state) const override
    {
        std::lock_guard<std::mutex> lock(_mutex);
        prepare();
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, _width, _height, 0, GL_RED, GL_FLOAT,
                     _posts.data());
        _loaded[state.getContextID()] = _revision;
    }

    void subload(const osg::Texture2D&, osg::State& state) const override
    {
        std::lock_guard<std::mutex> lock(_mutex);
        unsigned long& loaded = _loaded[state.getContextID()];
        if (loaded == _revision)
            return;
        prepare();
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, _width, _height, GL_RED, GL_FLOAT, _posts.data());
        loaded = _revision;
    }

private:
    static void prepare()
    {
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    }

    const int _width, _height;
    mutable std::mutex _mutex;
    std::vector<float> _posts;
    unsigned long _revision = 1;
    mutable std::map<unsigned, unsigned long> _loaded; ///< by context
};

HeightTexture::HeightTexture(int width, int height) : _upload(new Upload(width, height))
{
    setTextureSize(width, height);
    setInternalFormat(GL_R32F);
    setSourceFormat(GL_RED);
    setSourceType(GL_FLOAT);
    setFilter(MIN_FILTER, NEAREST);
    setFilter(MAG_FILTER, NEAREST);
    setWrap(WRAP_S, CLAMP_TO_EDGE);
    setWrap(WRAP_T, CLAMP_TO_EDGE);
    setResizeNonPowerOfTwoHint(false);
    setSubloadCallback(_upload);
}

std::pair<float, float> HeightTexture::set(const float* heights)
{
    return _upload->set(heights);
}

} // namespace osgTerrainLight
