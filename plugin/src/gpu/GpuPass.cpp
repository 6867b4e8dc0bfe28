#include "gpu/GpuPass.h"

#include "gpu/GlConstants.h"

#include <osg/BufferObject>
#include <osg/GLExtensions>
#include <osg/Shader>

#include <algorithm>

namespace osgTerrainLight
{

GpuPass::GpuPass(std::string name, std::vector<std::string> defines)
    : _name(std::move(name)), _defines(std::move(defines))
{
}

void GpuPass::setDefines(std::vector<std::string> defines)
{
    if (defines == _defines)
        return;
    _defines = std::move(defines);
    _program = nullptr;
}

void GpuPass::reads(const std::string& uniform, osg::Texture* texture)
{
    for (Input& input : _inputs)
        if (input.uniform == uniform)
        {
            input.texture = texture;
            return;
        }
    set(uniform, static_cast<int>(_inputs.size()));
    _inputs.push_back({uniform, texture});
}

void GpuPass::writes(unsigned unit, osg::Texture* texture, Access access)
{
    if (_outputs.size() <= unit)
        _outputs.resize(unit + 1);
    _outputs[unit] = {texture, access};
}

void GpuPass::set(const std::string& uniform, int x, int y)
{
    osg::ref_ptr<osg::Uniform> pair = new osg::Uniform(osg::Uniform::INT_VEC2, uniform);
    pair->set(x, y);
    set(pair);
}

void GpuPass::setBlock(const std::vector<osg::Vec4f>& values)
{
    if (!_blockValues || _blockValues->size() != values.size())
    {
        _blockValues = new osg::Vec4Array(static_cast<unsigned>(values.size()));
        _blockValues->setBufferObject(new osg::UniformBufferObject);
        _block = new osg::UniformBufferBinding(0, _blockValues);
    }
    std::copy(values.begin(), values.end(), _blockValues->begin());
    _blockValues->dirty();
}

unsigned GpuPass::groupsFor(int count, int size)
{
    return static_cast<unsigned>((count + size - 1) / size);
}

Status GpuPass::build(osg::State& state)
{
    const ShaderLibrary& library = ShaderLibrary::instance();
    const std::string file = "passes/" + _name + ".comp";
    const long long revision = library.revision();
    if (!_program || revision != _revision)
    {
        Result<ComposedShader> shader = library.compose(file, _defines);
        if (!shader)
            return shader.error();
        _program = new osg::Program;
        _program->setName(_name);
        osg::ref_ptr<osg::Shader> compute = new osg::Shader(osg::Shader::COMPUTE, shader->text);
        compute->setName(file);
        _program->addShader(compute);
        _parts = shader->parts;
        _revision = revision;
    }
    const osg::Program::PerContextProgram* linked = _program->getPCP(state);
    if (linked->needsLink())
        _program->compileGLObjects(state);
    if (linked->isLinked())
        return Nothing{};

    std::string log;
    _program->getShader(0)->getPCS(state)->getInfoLog(log);
    if (log.empty())
        _program->getGlProgramInfoLog(state.getContextID(), log);
    log.erase(log.find_last_not_of(" \n\r\t") + 1);
    return Error{ErrorCode::Failed,
                 "shader " + file + " does not compile: " + ComposedShader{{}, _parts}.mapLog(log)};
}

Status GpuPass::dispatch(osg::State& state, Groups groups)
{
    Status built = build(state);
    if (!built)
        return built;

    // Applied directly, not through the state's lazy tracking: that compares addresses, and takes a
    // new texture for a deleted one that stood in the same place. apply() also allocates.
    const auto* extensions = state.get<osg::GLExtensions>();
    const unsigned context = state.getContextID();
    const auto applyTexture = [&state](unsigned unit, const osg::Texture& texture)
    {
        state.setActiveTextureUnit(unit);
        texture.apply(state);
    };
    for (const Output& output : _outputs)
        if (!output.texture->getTextureObject(context))
            applyTexture(0, *output.texture);
    for (std::size_t unit = 0; unit < _inputs.size(); ++unit)
        if (_inputs[unit].texture)
            applyTexture(static_cast<unsigned>(unit), *_inputs[unit].texture);

    _program->apply(state);
    const osg::Program::PerContextProgram* linked = _program->getPCP(state);
    for (const auto& [name, uniform] : _uniforms)
        linked->apply(*uniform);
    if (_block)
        _block->apply(state);

    for (std::size_t unit = 0; unit < _outputs.size(); ++unit)
    {
        const Output& output = _outputs[unit];
        const GLenum target = output.texture->getTextureTarget();
        const bool layered = target == GL_TEXTURE_2D_ARRAY_EXT || target == GL_TEXTURE_CUBE_MAP;
        extensions->glBindImageTexture(
            static_cast<GLuint>(unit), output.texture->getTextureObject(context)->id(), 0,
            layered ? GL_TRUE : GL_FALSE, 0,
            output.access == Access::Write ? GL_WRITE_ONLY : GL_READ_WRITE,
            static_cast<GLenum>(output.texture->getInternalFormat()));
    }
    extensions->glDispatchCompute(groups.x, groups.y, groups.z);
    extensions->glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                                GL_TEXTURE_UPDATE_BARRIER_BIT);

    // What OSG believes of the state must be what it is.
    extensions->glUseProgram(0);
    state.setLastAppliedProgramObject(nullptr);
    state.haveAppliedAttribute(osg::StateAttribute::PROGRAM);
    if (_block)
    {
        extensions->glBindBufferBase(GL_UNIFORM_BUFFER, 0, 0);
        state.haveAppliedAttribute(osg::StateAttribute::UNIFORMBUFFERBINDING, 0);
    }
    for (std::size_t unit = 0; unit <= _inputs.size(); ++unit)
        state.haveAppliedTextureAttribute(static_cast<unsigned>(unit),
                                          osg::StateAttribute::TEXTURE);
    return Nothing{};
}

void GpuPass::releaseGLObjects(osg::State* state) const
{
    if (_program)
        _program->releaseGLObjects(state);
    if (_blockValues)
        _blockValues->releaseGLObjects(state);
}

void GpuPass::resizeGLObjectBuffers(unsigned size)
{
    if (_program)
        _program->resizeGLObjectBuffers(size);
    if (_blockValues)
        _blockValues->resizeGLObjectBuffers(size);
}

} // namespace osgTerrainLight
