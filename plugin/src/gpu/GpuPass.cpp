#include "gpu/GpuPass.h"

#include "gpu/GlConstants.h"
#include "gpu/WorkPace.h"

#include <osg/BufferObject>
#include <osg/GLExtensions>

#include <algorithm>

namespace osgTerrainLight
{

GpuPass::GpuPass(std::string name, std::vector<std::string> defines)
    : _name(std::move(name)), _defines(std::move(defines))
{
}

GpuPass::~GpuPass()
{
    dropProgram();
}

void GpuPass::setDefines(std::vector<std::string> defines)
{
    if (defines == _defines)
        return;
    _defines = std::move(defines);
    dropProgram();
}

GpuPass::Input& GpuPass::input(const std::string& uniform)
{
    for (Input& input : _inputs)
        if (input.uniform == uniform)
            return input;
    set(uniform, static_cast<int>(_inputs.size()));
    _inputs.push_back({uniform, nullptr, nullptr});
    return _inputs.back();
}

void GpuPass::reads(const std::string& uniform, osg::Texture* texture)
{
    input(uniform) = {uniform, texture, nullptr};
}

void GpuPass::reads(const std::string& uniform, Resource* resource)
{
    input(uniform) = {uniform, nullptr, resource};
}

void GpuPass::writes(unsigned unit, osg::Texture* texture, Access access)
{
    if (_outputs.size() <= unit)
        _outputs.resize(unit + 1);
    _outputs[unit] = {texture, access, nullptr};
}

void GpuPass::writes(unsigned unit, Resource* resource, Access access)
{
    writes(unit, static_cast<osg::Texture*>(nullptr), access);
    _outputs[unit].resource = resource;
}

/// Has the textures of resources while it lives, so that no pass keeps one that is dropped.
class GpuPass::Resolved
{
public:
    explicit Resolved(GpuPass& pass) : _pass(pass)
    {
        for (Input& input : _pass._inputs)
            if (input.resource)
                input.texture = input.resource->texture();
        for (Output& output : _pass._outputs)
            if (output.resource)
                output.texture = output.resource->make();
    }
    ~Resolved()
    {
        for (Input& input : _pass._inputs)
            if (input.resource)
                input.texture = nullptr;
        for (Output& output : _pass._outputs)
            if (output.resource)
                output.texture = nullptr;
    }
    Resolved(const Resolved&) = delete;
    Resolved& operator=(const Resolved&) = delete;

private:
    GpuPass& _pass;
};

void GpuPass::set(const std::string& uniform, int x, int y)
{
    osg::ref_ptr<osg::Uniform> pair = new osg::Uniform(osg::Uniform::INT_VEC2, uniform);
    pair->set(x, y);
    set(pair);
}

void GpuPass::setBlock(const std::vector<osg::Vec4f>& values, unsigned binding)
{
    osg::ref_ptr<osg::UniformBufferBinding>& block = _blocks[binding];
    auto* held = block ? static_cast<osg::Vec4Array*>(block->getBufferData()) : nullptr;
    if (!held || held->size() != values.size())
    {
        held = new osg::Vec4Array(static_cast<unsigned>(values.size()));
        held->setBufferObject(new osg::UniformBufferObject);
        block = new osg::UniformBufferBinding(binding, held);
    }
    std::copy(values.begin(), values.end(), held->begin());
    held->dirty();
}

void GpuPass::setStorage(unsigned binding, osg::Array* values)
{
    if (!values->getBufferObject())
        values->setBufferObject(new osg::ShaderStorageBufferObject);
    _storage[binding] = new osg::ShaderStorageBufferBinding(binding, values);
}

unsigned GpuPass::groupsFor(int count, int size)
{
    return static_cast<unsigned>((count + size - 1) / size);
}

/// Takes up the shader's text.
Status GpuPass::compose()
{
    if (_program && !_program->isOutdated())
        return Nothing{};
    Result<osg::ref_ptr<ComputeProgram>> program = ComputeProgram::shared(_name, _defines);
    if (!program)
        return program.error();
    dropProgram();
    _program = *program;
    return Nothing{};
}

Status GpuPass::link(osg::State& state)
{
    if (_contexts.insert(state.getContextID()).second)
        _program->addUser(state.getContextID());
    return _program->link(state);
}

/// In all contexts.
void GpuPass::dropProgram()
{
    for (const unsigned context : _contexts)
        _program->removeUser(context);
    _contexts.clear();
    _program = nullptr;
}

Status GpuPass::dispatch(osg::State& state, Groups groups)
{
    if (Status composed = compose(); !composed)
        return composed;
    PacedRun* run = PacedRun::current();
    if (!run)
        return dispatch(state, {0, 0, 0}, groups);
    return run->dispatch(_name, groups, isWhole(),
                         [&](Groups first, Groups count) { return dispatch(state, first, count); });
}

bool GpuPass::isWhole() const
{
    return !_program->knowsPieces() ||
           std::any_of(_outputs.begin(), _outputs.end(),
                       [](const Output& output)
                       { return !output.resource || output.resource->isWhole(); });
}

Status GpuPass::dispatch(osg::State& state, Groups first, Groups count)
{
    if (_program->knowsPieces())
    {
        osg::Uniform& place = *_firstGroup;
        place.set(first.x, first.y, first.z);
    }
    const Resolved resolved(*this);
    return dispatchResolved(state, count);
}

Status GpuPass::dispatchResolved(osg::State& state, Groups groups)
{
    if (Status linked = link(state); !linked)
        return linked;

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

    bindImages(state); // names units
    osg::Program& program = _program->program();
    program.apply(state);
    const osg::Program::PerContextProgram* linked = program.getPCP(state);
    for (const auto& [name, uniform] : _uniforms)
        linked->apply(*uniform);
    if (_program->knowsPieces())
        linked->apply(*_firstGroup);
    for (const auto& [binding, block] : _blocks)
        block->apply(state);
    for (const auto& [binding, storage] : _storage)
        storage->apply(state);
    extensions->glDispatchCompute(groups.x, groups.y, groups.z);
    GLbitfield barriers = GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                          GL_TEXTURE_UPDATE_BARRIER_BIT;
    if (!_storage.empty())
        barriers |= GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;
    extensions->glMemoryBarrier(barriers);
    leave(state);
    return Nothing{};
}

void GpuPass::bindImages(osg::State& state)
{
    const auto bind = [&state](unsigned unit, const osg::Texture& texture, GLenum access)
    {
        const GLenum target = texture.getTextureTarget();
        const bool layered = target == GL_TEXTURE_2D_ARRAY_EXT || target == GL_TEXTURE_CUBE_MAP ||
                             target == GL_TEXTURE_3D;
        state.get<osg::GLExtensions>()->glBindImageTexture(
            unit, texture.getTextureObject(state.getContextID())->id(), 0,
            layered ? GL_TRUE : GL_FALSE, 0, access,
            static_cast<GLenum>(texture.getInternalFormat()));
    };
    unsigned unit = 0;
    for (const Output& output : _outputs)
        bind(unit++, *output.texture,
             output.access == Access::Write ? GL_WRITE_ONLY : GL_READ_WRITE);
    for (const Input& input : _inputs)
        if (input.texture && _program->imagesRead().count(input.uniform) != 0)
        {
            set(input.uniform, static_cast<int>(unit));
            bind(unit++, *input.texture, GL_READ_ONLY);
        }
}

// What OSG believes of the state must be what it is.
void GpuPass::leave(osg::State& state) const
{
    const auto* extensions = state.get<osg::GLExtensions>();
    extensions->glUseProgram(0);
    state.setLastAppliedProgramObject(nullptr);
    state.haveAppliedAttribute(osg::StateAttribute::PROGRAM);
    for (const auto& [binding, block] : _blocks)
    {
        extensions->glBindBufferBase(GL_UNIFORM_BUFFER, binding, 0);
        state.haveAppliedAttribute(osg::StateAttribute::UNIFORMBUFFERBINDING, binding);
    }
    for (const auto& [binding, storage] : _storage)
    {
        extensions->glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, 0);
        state.haveAppliedAttribute(osg::StateAttribute::SHADERSTORAGEBUFFERBINDING, binding);
    }
    for (std::size_t unit = 0; unit <= _inputs.size(); ++unit)
        state.haveAppliedTextureAttribute(static_cast<unsigned>(unit),
                                          osg::StateAttribute::TEXTURE);
}

void GpuPass::releaseGLObjects(osg::State* state) const
{
    for (auto context = _contexts.begin(); context != _contexts.end();)
        if (!state || state->getContextID() == *context)
        {
            _program->removeUser(*context);
            context = _contexts.erase(context);
        }
        else
            ++context;
    for (const auto& [binding, block] : _blocks)
        block->getBufferData()->releaseGLObjects(state);
    for (const auto& [binding, storage] : _storage)
        storage->getBufferData()->releaseGLObjects(state);
}

void GpuPass::resizeGLObjectBuffers(unsigned size)
{
    if (_program)
        _program->program().resizeGLObjectBuffers(size);
    for (const auto& [binding, block] : _blocks)
        block->getBufferData()->resizeGLObjectBuffers(size);
    for (const auto& [binding, storage] : _storage)
        storage->getBufferData()->resizeGLObjectBuffers(size);
}

void readStorage(osg::State& state, osg::Array& values)
{
    osg::BufferObject* buffer = values.getBufferObject();
    const osg::GLBufferObject* object =
        buffer ? buffer->getGLBufferObject(state.getContextID()) : nullptr;
    if (!object)
        return;
    const auto* extensions = state.get<osg::GLExtensions>();
    extensions->glBindBuffer(GL_SHADER_STORAGE_BUFFER, object->getGLObjectID());
    extensions->glGetBufferSubData(
        GL_SHADER_STORAGE_BUFFER, static_cast<GLintptr>(object->getOffset(values.getBufferIndex())),
        static_cast<GLsizeiptr>(values.getTotalDataSize()),
        const_cast<void*>(values.getDataPointer())); // OSG's arrays give no other way in
    extensions->glBindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
}

} // namespace osgTerrainLight
