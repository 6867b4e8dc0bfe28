#pragma once

#include "core/SettingRow.h"
#include "gpu/WorkGraph.h"
#include "lighting/nodes/HorizonNode.h"

#include <osg/Referenced>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A kind of light: what it needs computed for it, and how passes read it. The shaders' side is a
/// file in shaders/lights/, compiled in by a define, with a line in each function of lights.glsl.
class LightSource : public osg::Referenced
{
public:
    /// In the order in which they run.
    virtual WorkGraph::Nodes nodes() const = 0;
    /// What a node reads whose passes bind this light, beside TileInputs::light.
    virtual std::vector<Resource*> values() const = 0;
    /// Gives a pass its textures and uniforms, and adds the define where it lights anything now.
    virtual void bind(GpuPass& pass, std::vector<std::string>& defines) const = 0;
    /// Null where it needs none.
    virtual HorizonNode* horizon() const { return nullptr; }
    /// Whether lights.glsl has it in harmonics; gloss.comp has code of its own for the others.
    virtual bool isInHarmonics() const { return true; }
    /// Whether its light on a face is not near enough to bilinear between the face's corners: it is
    /// found where the face is seen.
    virtual bool variesInCells() const { return false; }
    /// Settings or light have changed, which makes this stale: adapts the nodes.
    virtual void follow(Invalidation) {}

protected:
    ~LightSource() override = default;
};

using LightSources = std::vector<osg::ref_ptr<LightSource>>;

/// Those whose light varies in cells.
inline LightSources varyingInCells(const LightSources& lights)
{
    LightSources varying;
    for (const auto& light : lights)
        if (light->variesInCells())
            varying.push_back(light);
    return varying;
}

/// Makes the pass the variant that reads these lights, with `defines` of its own.
inline void bindLights(GpuPass& pass, const LightSources& lights,
                       std::vector<std::string> defines = {})
{
    for (const auto& light : lights)
        light->bind(pass, defines);
    pass.setDefines(std::move(defines));
}

} // namespace osgTerrainLight
