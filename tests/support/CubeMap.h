#pragma once

#include <osg/State>
#include <osg/TextureCubeMap>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace osgTerrainLight
{

/// Unit direction to a place on a face, +x, −x, +y, −y, +z, −z, across and down −1 … 1: OpenGL 4.3,
/// table 8.18, solved for the direction.
inline std::array<double, 3> directionOnCube(int face, double across, double down)
{
    const std::array<std::array<double, 3>, 6> faces = {{{1.0, -down, -across},
                                                         {-1.0, -down, across},
                                                         {across, 1.0, down},
                                                         {across, -1.0, -down},
                                                         {across, -down, 1.0},
                                                         {-across, -down, -1.0}}};
    const double length = std::sqrt(1.0 + across * across + down * down);
    const std::array<double, 3>& d = faces[static_cast<std::size_t>(face)];
    return {d[0] / length, d[1] / length, d[2] / length};
}

/// Texels of a cube map that passes wrote, face by face, RGBA. Needs a current context.
inline std::vector<float> readCube(osg::State& state, osg::TextureCubeMap& map)
{
    const auto side = static_cast<std::size_t>(map.getTextureWidth());
    std::vector<float> values(6 * side * side * 4);
    state.setActiveTextureUnit(0);
    map.apply(state);
    state.haveAppliedTextureAttribute(0, osg::StateAttribute::TEXTURE);
    for (unsigned face = 0; face < 6; ++face)
        glGetTexImage(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, GL_RGBA, GL_FLOAT,
                      &values[face * side * side * 4]);
    return values;
}

} // namespace osgTerrainLight
