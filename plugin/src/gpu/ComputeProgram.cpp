#include "gpu/ComputeProgram.h"

#include <osg/Shader>
#include <osg/observer_ptr>

#include <mutex>
#include <regex>

namespace osgTerrainLight
{

namespace
{

std::mutex& programsMutex()
{
    static std::mutex mutex;
    return mutex;
}

} // namespace

Result<osg::ref_ptr<ComputeProgram>> ComputeProgram::shared(const std::string& name,
                                                            const std::vector<std::string>& defines)
{
    using Key = std::pair<std::string, std::vector<std::string>>;
    static std::map<Key, osg::observer_ptr<ComputeProgram>> programs;
    const std::lock_guard<std::mutex> lock(programsMutex());
    osg::observer_ptr<ComputeProgram>& known = programs[{name, defines}];
    osg::ref_ptr<ComputeProgram> program;
    if (known.lock(program) && !program->isOutdated())
        return program;

    const ShaderLibrary& library = ShaderLibrary::instance();
    const std::string file = "passes/" + name + ".comp";
    const long long revision = library.revision();
    Result<ComposedShader> shader = library.compose(file, defines);
    if (!shader)
        return shader.error();
    program = new ComputeProgram(file, *shader, revision);
    known = program;
    return program;
}

ComputeProgram::ComputeProgram(std::string file, const ComposedShader& shader, long long revision)
    : _file(std::move(file)), _revision(revision), _parts(shader.parts), _program(new osg::Program)
{
    const std::string& text = shader.text;
    _program->setName(_file);
    osg::ref_ptr<osg::Shader> compute = new osg::Shader(osg::Shader::COMPUTE, text);
    compute->setName(_file);
    _program->addShader(compute);
    // The shader says its blocks' bindings; OSG warns of each that it is not told as well.
    static const std::regex block(R"(layout\(std140, binding = (\d+)\)\s+uniform\s+(\w+))");
    for (std::sregex_iterator found(text.begin(), text.end(), block), none; found != none; ++found)
        _program->addBindUniformBlock((*found)[2], static_cast<GLuint>(std::stoul((*found)[1])));
    static const std::regex image(R"(readonly\s+uniform\s+\w*image\w+\s+(\w+);)");
    for (std::sregex_iterator found(text.begin(), text.end(), image), none; found != none; ++found)
        _imagesRead.insert((*found)[1]);
    // Where it is defined, and where the shader uses it.
    _knowsPieces = text.find("INVOCATION") != text.rfind("INVOCATION");
}

bool ComputeProgram::isOutdated() const
{
    return ShaderLibrary::instance().revision() != _revision;
}

Status ComputeProgram::link(osg::State& state)
{
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
    return Error{ErrorCode::Failed, "shader " + _file + " does not compile: " +
                                        ComposedShader{{}, _parts}.mapLog(log)};
}

void ComputeProgram::addUser(unsigned context)
{
    const std::lock_guard<std::mutex> lock(programsMutex());
    ++_users[context];
}

void ComputeProgram::removeUser(unsigned context)
{
    const std::lock_guard<std::mutex> lock(programsMutex());
    if (--_users[context] > 0)
        return;
    _users.erase(context);
    // Only the context's number is asked of the state. Left in place, the program would be taken
    // for one of the next context of that number.
    const osg::ref_ptr<osg::State> state = new osg::State;
    state->setContextID(context);
    _program->releaseGLObjects(state);
}

} // namespace osgTerrainLight
