#include "gpu/ShaderLibrary.h"

#include "gpu/EmbeddedShaders.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
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
    // Mesa writes "0:17(5): error", NVIDIA "0(17) : error", others "ERROR: 0:17:".
    static const std::regex place(R"((^|\n)(ERROR: |WARNING: )?0[:(](\d{1,6})(?!\d)\)?)");
    std::string mapped;
    std::size_t done = 0;
    for (std::sregex_iterator i(log.begin(), log.end(), place), end; i != end; ++i)
    {
        const std::smatch& match = *i;
        const int line = std::stoi(match[3]);
        const auto after = std::find_if(parts.begin(), parts.end(),
                                        [line](const Part& part) { return part.firstLine > line; });
        mapped += log.substr(done, static_cast<std::size_t>(match.position()) - done);
        done = static_cast<std::size_t>(match.position() + match.length());
        if (after == parts.begin())
            mapped += match.str();
        else
            mapped += match[1].str() + match[2].str() + std::prev(after)->file + ":" +
                      std::to_string(line - std::prev(after)->firstLine + 1);
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
    names.insert(names.end(), {"pieces.glsl", "windows.glsl"});
    for (const EmbeddedShader& shader : embeddedShaders())
        if (const std::string file = shader.name; file.rfind("lights/", 0) == 0)
            names.push_back(file);
    names.insert(names.end(), {"lights.glsl", "objects.glsl", name});

    ComposedShader shader;
    shader.text = "#version 430\n";
    for (const std::string& define : defines)
        shader.text += "#define " + define + "\n";
    for (const std::string& file : names)
    {
        Result<std::string> text = source(file);
        if (!text)
            return text.error();
        const auto lines = std::count(shader.text.begin(), shader.text.end(), '\n');
        shader.parts.push_back({file, static_cast<int>(lines) + 1});
        shader.text += *text + "\n";
    }
    return shader;
}

long long ShaderLibrary::revision() const
{
    // The newest time alone would miss an older file that goes or is put back.
    std::size_t sum = 0;
    if (_folder.empty())
        return 0;
    std::error_code error;
    std::filesystem::recursive_directory_iterator entry(_folder, error);
    for (; !error && entry != std::filesystem::end(entry); entry.increment(error))
    {
        std::error_code gone; // while we look: an editor's file for a moment
        const auto time = entry->last_write_time(gone).time_since_epoch().count();
        if (entry->is_regular_file(gone))
            sum += std::hash<std::string>()(entry->path().string() + ":" + std::to_string(time));
    }
    return static_cast<long long>(sum);
}

std::vector<std::string> ShaderLibrary::names()
{
    std::vector<std::string> result;
    for (const EmbeddedShader& shader : embeddedShaders())
        result.emplace_back(shader.name);
    return result;
}

} // namespace osgTerrainLight
