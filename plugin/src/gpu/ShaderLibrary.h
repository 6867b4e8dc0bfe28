#pragma once

#include "core/Result.h"

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A shader put together from files, and the way back from a compiler's line number to file and
/// line. The lines are counted through: a compiler may forget the source number of a #line (Mesa
/// does in all but syntax errors).
struct ComposedShader
{
    struct Part
    {
        std::string file;
        int firstLine; ///< of `text`, counted from 1
    };

    std::string text;
    std::vector<Part> parts;

    /// A compiler's log with "0:line" or "0(line)" replaced by "file:line".
    std::string mapLog(const std::string& log) const;
};

/// The shader sources: embedded in the library, or read from the folder that the environment
/// variable OSGTERRAINLIGHT_SHADERS names (for live editing; files it lacks are the embedded ones).
class ShaderLibrary
{
public:
    /// folder: the override folder; empty for none.
    explicit ShaderLibrary(std::string folder);

    /// The library with the folder from the environment.
    static const ShaderLibrary& instance();

    /// Text of one file, by its path below shaders/.
    Result<std::string> source(const std::string& name) const;

    /// preamble.glsl, one "#define" per define, every file that lib/all.glsl lists, the kinds of
    /// light in lights/ (which do not know each other), lights.glsl, then the file itself.
    Result<ComposedShader> compose(const std::string& name,
                                   const std::vector<std::string>& defines = {}) const;

    /// A number that changes when a file in the override folder comes, changes or goes; 0 without a
    /// folder.
    long long revision() const;

    static std::vector<std::string> names();

private:
    std::string _folder;
};

} // namespace osgTerrainLight
