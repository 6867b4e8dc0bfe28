#include "gpu/ShaderLibrary.h"

#include "gpu/EmbeddedShaders.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace osgTerrainLight
{

namespace
{
/// File names of the #include lines of lib/all.glsl, in order.
std::vector<std::string> listed(const std::string& text)
{
    std::vector<std::string> names;
    static const std::regex line(R"re(#include\s+"([^"]+)")re");
    for (std::sregex_iterator i(text.begin(), text.end(), line), end; i != end; ++i)
        names.push_back((*i)[1]);
    return names;
}
} // namespace

std::string ComposedShader::mapLog(const std::string& log) const
{
    // Mesa writes "2:17(5): error", NVIDIA "2(17) : error".
    static const std::regex place(R"((^|\n)(ERROR: |WARNING: )?(\d+)[:(](\d+)\)?)");
    std::string mapped;
    std::size_t done = 0;
    for (std::sregex_iterator i(log.begin(), log.end(), place), end; i != end; ++i)
    {
        const std::smatch& match = *i;
        const std::size_t file = static_cast<std::size_t>(std::stoul(match[3]));
        mapped += log.substr(done, static_cast<std::size_t>(match.position()) - done);
        done = static_cast<std::size_t>(match.position() + match.length());
        if (file >= files.size())
            mapped += match.str();
        else
            mapped += match[1].str() + match[2].str() + files[file] + ":" + match[4].str();
    }
    return mapped + log.substr(done);
}

ShaderLibrary::ShaderLibrary(std::string folder) : _folder(std::move(folder)) {}

const ShaderLibrary& ShaderLibrary::instance()
{
    static const ShaderLibrary library(
        []
        {
            const char* folder = std::getenv("OSGTERRAINLIGHT_SHADERS");
            return std::string(folder ? folder : "");
        }());
    return library;
}

Result<std::string> ShaderLibrary::source(const std::string& name) const
{
    if (!_folder.empty())
    {
        std::ifstream file(_folder + "/" + name, std::ios::binary);
        if (file)
        {
            std::ostringstream text;
            text << file.rdbuf();
            return text.str();
        }
    }
    for (const EmbeddedShader& shader : embeddedShaders())
        if (name == shader.name)
            return std::string(shader.text);
    return Error{ErrorCode::NotFound, "shader '" + name + "': no such file is embedded" +
                                          (_folder.empty() ? "" : " or in '" + _folder + "'")};
}

Result<ComposedShader> ShaderLibrary::compose(const std::string& name,
                                              const std::vector<std::string>& defines) const
{
    Result<std::string> list = source("lib/all.glsl");
    if (!list)
        return list.error();
    std::vector<std::string> names = {"preamble.glsl"};
    for (const std::string& file : listed(*list))
        names.push_back("lib/" + file);
    names.push_back(name);

    ComposedShader shader;
    shader.text = "#version 430\n";
    for (const std::string& define : defines)
        shader.text += "#define " + define + "\n";
    for (const std::string& file : names)
    {
        Result<std::string> text = source(file);
        if (!text)
            return text.error();
        shader.text += "#line 1 " + std::to_string(shader.files.size()) + "\n" + *text + "\n";
        shader.files.push_back(file);
    }
    return shader;
}

long long ShaderLibrary::revision() const
{
    long long newest = 0;
    if (_folder.empty())
        return newest;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(_folder, ignored))
        if (entry.is_regular_file(ignored))
            newest = std::max<long long>(newest,
                                         entry.last_write_time(ignored).time_since_epoch().count());
    return newest;
}

std::vector<std::string> ShaderLibrary::names()
{
    std::vector<std::string> result;
    for (const EmbeddedShader& shader : embeddedShaders())
        result.emplace_back(shader.name);
    return result;
}

} // namespace osgTerrainLight
