#pragma once

#include "core/Result.h"
#include "gpu/ShaderLibrary.h"

#include <osg/Program>
#include <osg/Referenced>
#include <osg/State>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A variant of a compute shader. All passes of that variant share it, in every tile: composing and
/// compiling it takes longer than to run it. It lives as long as one of them has it. Each of its
/// uniforms has the value that was applied last, so a pass applies all of its own per dispatch.
class ComputeProgram : public osg::Referenced
{
public:
    /// shaders/passes/<name>.comp with these defines, as the shader library has it now. In any
    /// thread. Errors: those of ShaderLibrary::compose().
    static Result<osg::ref_ptr<ComputeProgram>> shared(const std::string& name,
                                                       const std::vector<std::string>& defines);

    /// Whether the shader library has another text now.
    bool isOutdated() const;

    /// Compiles and links where that has not been done. Needs a current context. An error names
    /// file and line of the shader.
    Status link(osg::State& state);
    osg::Program& program() { return *_program; }

    /// `readonly uniform` images that the shader declares.
    const std::set<std::string>& imagesRead() const { return _imagesRead; }
    /// Whether it goes by INVOCATION or GROUP (pieces.glsl), and so can run in pieces.
    bool knowsPieces() const { return _knowsPieces; }

    /// A pass uses the program in a context from now on, …
    void addUser(unsigned context);
    /// … and does so no longer. The last one gives the program back to OSG, which deletes it in
    /// that context.
    void removeUser(unsigned context);

private:
    ComputeProgram(std::string file, const ComposedShader& shader, long long revision);
    ~ComputeProgram() override = default;

    std::string _file;
    long long _revision;
    std::vector<ComposedShader::Part> _parts;
    osg::ref_ptr<osg::Program> _program;
    std::set<std::string> _imagesRead;
    bool _knowsPieces = false;
    std::map<unsigned, int> _users; ///< passes by context
};

} // namespace osgTerrainLight
