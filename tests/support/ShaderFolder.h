#pragma once

#include <string>

namespace osgTerrainLight
{

/// Folder that this program's shader library takes overrides from: a new one per process, named in
/// OSGTERRAINLIGHT_SHADERS before main() and removed after the tests. It begins with what the
/// folder holds that the caller named so, and is empty otherwise unless a test writes.
const std::string& shaderFolder();

/// A file in shaderFolder() while the object lives: an override, or a pass of a test's own.
class ShaderFile
{
public:
    /// name: path below shaders/, for instance "passes/mine.comp".
    ShaderFile(std::string name, const std::string& text);
    ~ShaderFile();
    ShaderFile(const ShaderFile&) = delete;
    ShaderFile& operator=(const ShaderFile&) = delete;

    void write(const std::string& text);

private:
    std::string _path;
};

} // namespace osgTerrainLight
