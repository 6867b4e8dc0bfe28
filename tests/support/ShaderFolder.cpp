#include "support/ShaderFolder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <unistd.h>

namespace osgTerrainLight
{

const std::string& shaderFolder()
{
    static const std::string folder =
        (std::filesystem::temp_directory_path() / ("otl_shaders_" + std::to_string(getpid())))
            .string();
    return folder;
}

namespace
{
class Folder : public testing::Environment
{
public:
    // Here, not in SetUp: the library reads the variable once, at its first use. What a folder that
    // the caller names holds, a planted fault of mutations.sh, counts here too.
    Folder()
    {
        std::error_code missing; // the folder of a program that starts this one may not be there
        if (const char* const theirs = getenv("OSGTERRAINLIGHT_SHADERS"))
            std::filesystem::copy(theirs, shaderFolder(), std::filesystem::copy_options::recursive,
                                  missing);
        setenv("OSGTERRAINLIGHT_SHADERS", shaderFolder().c_str(), 1);
    }
    void TearDown() override { std::filesystem::remove_all(shaderFolder()); }
};
[[maybe_unused]] const testing::Environment* const environment =
    testing::AddGlobalTestEnvironment(new Folder);
} // namespace

ShaderFile::ShaderFile(std::string name, const std::string& text)
    : _path(shaderFolder() + "/" + std::move(name))
{
    std::filesystem::create_directories(std::filesystem::path(_path).parent_path());
    write(text);
}

ShaderFile::~ShaderFile()
{
    std::filesystem::remove(_path);
}

void ShaderFile::write(const std::string& text)
{
    {
        std::ofstream file(_path, std::ios::binary | std::ios::trunc);
        file << text;
        ASSERT_TRUE(file.good()) << _path;
    }
    // A second apart, since a file system's clock may not tell two writes of a test apart.
    static int writes = 0;
    std::filesystem::last_write_time(_path, std::filesystem::file_time_type::clock::now() +
                                                std::chrono::seconds(++writes));
}

} // namespace osgTerrainLight
