#include "scene/ShadingBinding.h"

#include "gpu/ShaderLibrary.h"
#include <osgTerrainLight/DynamicTerrain.h>

#include <cassert>

namespace osgTerrainLight
{

namespace
{
constexpr const char* fromVertexName = "osgTerrainLight_fromVertex";
constexpr const char* hasColourName = "osgTerrainLight_hasColour";
constexpr const char* colourName = "osgTerrainLight_colour";

/// From tile coordinates to texture coordinates: outermost posts are half a texel inside.
osg::Matrixd texelCentres(const osg::Texture2D& shading)
{
    const double width = shading.getTextureWidth();
    const double height = shading.getTextureHeight();
    return osg::Matrixd::scale((width - 1.0) / width, (height - 1.0) / height, 1.0) *
           osg::Matrixd::translate(0.5 / width, 0.5 / height, 0.0);
}

osg::ref_ptr<osg::Shader> hostShader(osg::Shader::Type type, const std::string& file,
                                     const std::string& version)
{
    Result<std::string> text = ShaderLibrary::instance().source("host/" + file);
    assert(text.ok());
    osg::ref_ptr<osg::Shader> shader =
        new osg::Shader(type, "#version " + version + "\n#line 1\n" + (text ? *text : ""));
    shader->setName("host/" + file);
    return shader;
}
} // namespace

osg::ref_ptr<osg::Shader> createShadingShader(osg::Shader::Type type, int version)
{
    return hostShader(type, "terrain_shading.glsl", std::to_string(version));
}

osg::ref_ptr<osg::Shader> createHeightShader(osg::Shader::Type type, int version)
{
    return hostShader(type, "terrain_heights.glsl", std::to_string(version));
}

osg::ref_ptr<osg::Program> createDefaultProgram()
{
    osg::ref_ptr<osg::Program> program = new osg::Program;
    program->setName("osgTerrainLight default terrain");
    for (osg::Shader::Type type : {osg::Shader::VERTEX, osg::Shader::FRAGMENT})
        program->addShader(createShadingShader(type));
    program->addShader(hostShader(osg::Shader::VERTEX, "default_terrain.vert", "120"));
    program->addShader(hostShader(osg::Shader::FRAGMENT, "default_terrain.frag", "120"));
    return program;
}

osg::ref_ptr<osg::Program> createDisplacedProgram(bool lit)
{
    const std::string version = "330 compatibility";
    osg::ref_ptr<osg::Program> program = new osg::Program;
    program->setName(lit ? "osgTerrainLight dynamic terrain" : "osgTerrainLight unlit terrain");
    for (const char* file :
         {"terrain_shading.glsl", "terrain_heights.glsl", "dynamic_terrain.vert"})
        program->addShader(hostShader(osg::Shader::VERTEX, file, version));
    if (lit)
    {
        program->addShader(hostShader(osg::Shader::FRAGMENT, "terrain_shading.glsl", version));
        program->addShader(
            hostShader(osg::Shader::FRAGMENT, "default_terrain.frag", version + "\n#define HOLES"));
    }
    else
        program->addShader(hostShader(osg::Shader::FRAGMENT, "unlit_terrain.frag", version));
    return program;
}

ShadingBinding::ShadingBinding(osg::StateSet* stateSet, osg::Texture2D* shading, unsigned unit,
                               const ShadingCoordinates& coordinates, osg::Program* program)
    : _stateSet(stateSet), _shading(shading), _program(program), _unit(unit),
      _theirVariance(stateSet->getDataVariance())
{
    stateSet->setDataVariance(osg::Object::DYNAMIC);
    _theirTextureUnits = stateSet->getTextureAttributeList().size();
    _theirTextureModes = stateSet->getTextureModeList();
    if (const auto* pair = stateSet->getTextureAttributePair(unit, osg::StateAttribute::TEXTURE))
        _theirTexture = *pair;
    if (const auto* pair = stateSet->getAttributePair(osg::StateAttribute::PROGRAM))
        _theirProgram = *pair;

    // No mode: fixed-function drawing must not see the texture.
    stateSet->setTextureAttribute(unit, shading);
    add(new osg::Uniform(ShadingTexture::sampler, static_cast<int>(unit)));
    add(new osg::Uniform(ShadingTexture::matrix,
                         osg::Matrixf(coordinates.toTile * texelCentres(*shading))));
    if (!program)
        return;
    stateSet->setAttribute(program);
    add(new osg::Uniform(fromVertexName, coordinates.source == ShadingCoordinates::Source::Vertex));
    add(new osg::Uniform(colourName, 0));
    _hasColour = new osg::Uniform(hasColourName, false);
    add(_hasColour);
}

void ShadingBinding::add(osg::Uniform* uniform)
{
    Slot slot{uniform->getName(), uniform, {}};
    if (const auto* pair = _stateSet->getUniformPair(uniform->getName()))
        slot.theirs = *pair;
    _uniforms.push_back(slot);
    _stateSet->addUniform(uniform);
}

void ShadingBinding::setHasColour(bool hasColour)
{
    bool current = hasColour;
    if (_hasColour && _hasColour->get(current) && current != hasColour)
        _hasColour->set(hasColour);
}

ShadingBinding::~ShadingBinding()
{
    osg::StateSet& stateSet = *_stateSet;
    stateSet.setDataVariance(_theirVariance);
    for (const Slot& slot : _uniforms)
    {
        if (stateSet.getUniform(slot.name) != slot.ours)
            continue; // the host has put its own there
        stateSet.removeUniform(slot.name);
        if (slot.theirs.first)
            stateSet.addUniform(slot.theirs.first, slot.theirs.second);
    }
    if (_program && stateSet.getAttribute(osg::StateAttribute::PROGRAM) == _program)
    {
        stateSet.removeAttribute(osg::StateAttribute::PROGRAM);
        if (_theirProgram.first)
            stateSet.setAttribute(_theirProgram.first, _theirProgram.second);
    }
    if (stateSet.getTextureAttribute(_unit, osg::StateAttribute::TEXTURE) == _shading)
    {
        stateSet.removeTextureAttribute(_unit, osg::StateAttribute::TEXTURE);
        if (_theirTexture.first)
            stateSet.setTextureAttribute(_unit, _theirTexture.first, _theirTexture.second);
        // Taking the texture off also took modes off its unit; and the lists have grown.
        auto& modes = stateSet.getTextureModeList();
        if (_unit < modes.size())
            modes[_unit] = _unit < _theirTextureModes.size() ? _theirTextureModes[_unit]
                                                             : osg::StateSet::ModeList();
        while (modes.size() > _theirTextureModes.size() && modes.back().empty())
            modes.pop_back();
        auto& attributes = stateSet.getTextureAttributeList();
        while (attributes.size() > _theirTextureUnits && attributes.back().empty())
            attributes.pop_back();
    }
}

} // namespace osgTerrainLight
