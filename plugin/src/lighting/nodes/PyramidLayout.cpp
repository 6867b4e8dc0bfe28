#include "lighting/nodes/PyramidLayout.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace osgTerrainLight
{

namespace
{
osg::ref_ptr<osg::Uniform> rectangle(const char* name, const PyramidLayout::Level& level)
{
    osg::ref_ptr<osg::Uniform> uniform = new osg::Uniform(osg::Uniform::INT_VEC4, name);
    uniform->set(level.x, level.y, level.width, level.height);
    return uniform;
}

/// Level 1 on the left; the others, all no higher together, in a column beside it.
PyramidLayout layOut(int columns, int rows, int smallest, int (*coarser)(int))
{
    PyramidLayout layout;
    layout.levels.push_back({0, 0, columns, rows});
    int top = 0;
    while (layout.levels.back().width > smallest || layout.levels.back().height > smallest)
    {
        const PyramidLayout::Level& finer = layout.levels.back();
        PyramidLayout::Level level{0, 0, coarser(finer.width), coarser(finer.height)};
        if (layout.levels.size() > 1)
        {
            level.x = layout.levels[1].width;
            level.y = top;
            top += level.height;
        }
        layout.levels.push_back(level);
        layout.width = std::max(layout.width, level.x + level.width);
        layout.height = std::max(layout.height, level.y + level.height);
    }
    return layout;
}
} // namespace

PyramidLayout PyramidLayout::ofPosts(int columns, int rows)
{
    // The last post of an even count is beyond the last texel but one.
    return layOut(columns, rows, 2, [](int count) { return count / 2 + 1; });
}

PyramidLayout PyramidLayout::ofCells(int columns, int rows)
{
    return layOut(columns, rows, 1, [](int count) { return (count + 1) / 2; });
}

Status reducePyramid(osg::State& state, const PyramidLayout& layout, GpuPass& first,
                     Resource* finest, int frame, GpuPass& next, Resource* pyramid)
{
    const auto layers = static_cast<unsigned>(std::max(1, pyramid->layout().layers));
    Status done = Nothing{};
    for (std::size_t i = 1; done && i < layout.levels.size(); ++i)
    {
        GpuPass& pass = i == 1 ? first : next;
        PyramidLayout::Level from = layout.levels[i - 1];
        if (i == 1)
            from.x = from.y = frame;
        const PyramidLayout::Level& to = layout.levels[i];
        pass.reads("finer", i == 1 ? finest : pyramid);
        pass.set(rectangle("from", from));
        pass.set(rectangle("to", to));
        pass.writes(0, pyramid);
        done = pass.dispatch(
            state, {GpuPass::groupsFor(to.width, 8), GpuPass::groupsFor(to.height, 8), layers});
    }
    return done;
}

void setLevels(GpuPass& pass, const char* uniform, const PyramidLayout& layout)
{
    constexpr std::size_t maxLevels = 16; // the size of the arrays in the shaders
    assert(layout.levels.size() <= maxLevels);
    osg::ref_ptr<osg::Uniform> levels =
        new osg::Uniform(osg::Uniform::INT_VEC4, uniform, static_cast<int>(maxLevels));
    for (unsigned i = 0; i < layout.levels.size(); ++i)
    {
        const PyramidLayout::Level& level = layout.levels[i];
        levels->setElement(i, level.x, level.y, level.width, level.height);
    }
    pass.set(levels);
}

} // namespace osgTerrainLight
