#pragma once

#include <osg/Texture2D>

#include <utility>

namespace osgTerrainLight
{

/// Heights that change: R32F, a texel per post, row 0 south, as large as it was made. Each context
/// takes up the newest ones when it applies the texture. Not to be copied.
class HeightTexture : public osg::Texture2D
{
public:
    /// All posts void.
    HeightTexture(int width, int height);

    /// heights: width × height values [m]; what is not finite or beyond ±1e6 m is stored as
    /// VOID_HEIGHT of lib/surface.glsl. May be called while other threads draw. Returns the lowest
    /// and the highest that are valid; lowest > highest where none is.
    std::pair<float, float> set(const float* heights);

private:
    ~HeightTexture() override = default;
    class Upload;
    osg::ref_ptr<Upload> _upload;
};

} // namespace osgTerrainLight
