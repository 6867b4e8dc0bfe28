#include "gpu/ShaderLibrary.h"

#include "gpu/GpuPass.h"
#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"

#include <osg/Notify>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

using namespace osgTerrainLight;

namespace
{
const std::filesystem::path sources = std::filesystem::path(OTL_SOURCE_DIR) / "shaders";

std::string contentOf(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// "file:line" of the only place where `text` stands in a library file.
std::string placeOf(const std::string& file, const std::string& text)
{
    const std::string content = contentOf(sources / file);
    const std::size_t at = content.find(text);
    EXPECT_NE(at, std::string::npos);
    const auto line =
        1 + std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return file + ":" + std::to_string(line);
}

/// A pass that writes one value.
std::string writes(const std::string& value)
{
    return "layout(local_size_x = 1) in;\n"
           "layout(r32f, binding = 0) writeonly uniform image2D result;\n"
           "void main() { imageStore(result, ivec2(0), vec4(" +
           value + ")); }\n";
}

/// OSG prints every log of a shader that does not compile; here that is what is asked for.
class QuietOsg
{
public:
    QuietOsg() { osg::setNotifyLevel(osg::ALWAYS); }
    ~QuietOsg() { osg::setNotifyLevel(_level); }

private:
    osg::NotifySeverity _level = osg::getNotifyLevel();
};

struct OneValue
{
    explicit OneValue(const std::string& name) : pass(new GpuPass(name))
    {
        pass->writes(0, target);
    }

    float run(osg::State& state)
    {
        const Status done = pass->dispatch(state, {});
        if (!done)
        {
            ADD_FAILURE() << done.error().message;
            return -1.0f;
        }
        return readFloats(state, *target, 1).front();
    }

    osg::ref_ptr<osg::Texture2D> target = createTarget(1, 1, GL_R32F);
    osg::ref_ptr<GpuPass> pass;
};
} // namespace

TEST(ShaderLibrary, EveryFileIsEmbeddedOnceAndAsItStands)
{
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(sources))
    {
        const std::string extension = entry.path().extension().string();
        if (entry.is_regular_file() && extension != ".cmake" && extension != ".h" &&
            extension != ".txt")
            files.insert(entry.path().lexically_relative(sources).generic_string());
    }
    ASSERT_GT(files.size(), 5u);
    const std::vector<std::string> names = ShaderLibrary::names();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), files);
    EXPECT_EQ(names.size(), files.size());
    for (const std::string& name : names)
    {
        const Result<std::string> text = ShaderLibrary("").source(name);
        ASSERT_TRUE(text.ok());
        EXPECT_EQ(*text, contentOf(sources / name)) << name;
    }
}

TEST(ShaderLibrary, EveryLibraryFileIsComposed)
{
    const Result<ComposedShader> shader = ShaderLibrary("").compose("passes/shade.comp", {"A 1"});
    ASSERT_TRUE(shader.ok());
    EXPECT_EQ(shader->text.substr(0, 25), "#version 430\n#define A 1\n");
    EXPECT_EQ(shader->parts.front().file, "preamble.glsl");
    EXPECT_EQ(shader->parts.front().firstLine, 3);
    EXPECT_EQ(shader->parts.back().file, "passes/shade.comp");
    std::multiset<std::string> files;
    for (const ComposedShader::Part& part : shader->parts)
        files.insert(part.file);
    std::size_t count = 0;
    for (const std::string& name : ShaderLibrary::names())
        if (name.rfind("lights/", 0) == 0 || (name.rfind("lib/", 0) == 0 && name != "lib/all.glsl"))
        {
            ++count;
            EXPECT_EQ(files.count(name), 1u) << name;
        }
    EXPECT_EQ(files.count("pieces.glsl"), 1u);
    EXPECT_EQ(files.count("windows.glsl"), 1u);
    EXPECT_EQ(files.count("lights.glsl"), 1u);
    EXPECT_EQ(files.count("objects.glsl"), 1u);
    EXPECT_EQ(files.size(), count + 6); // these, the preamble and the pass
    EXPECT_EQ(shader->text.find("#include"), std::string::npos);
}

TEST(ShaderLibrary, UnknownFilesAreErrorsThatNameThem)
{
    const Result<std::string> text = ShaderLibrary("").source("lib/absent.glsl");
    ASSERT_FALSE(text.ok());
    EXPECT_EQ(text.error().code, ErrorCode::NotFound);
    EXPECT_NE(text.error().message.find("'lib/absent.glsl'"), std::string::npos);

    const ShaderLibrary library(shaderFolder());
    const Result<ComposedShader> pass = library.compose("passes/absent.comp");
    ASSERT_FALSE(pass.ok());
    EXPECT_NE(pass.error().message.find("'passes/absent.comp'"), std::string::npos);
    EXPECT_NE(pass.error().message.find(shaderFolder()), std::string::npos);

    const ShaderFile list("lib/all.glsl", "#include \"angle.glsl\"\n#include \"absent.glsl\"\n");
    const Result<ComposedShader> shader = library.compose("passes/shade.comp");
    ASSERT_FALSE(shader.ok());
    EXPECT_NE(shader.error().message.find("'lib/absent.glsl'"), std::string::npos);
}

TEST(ShaderLibrary, FolderOverridesFileByFile)
{
    const ShaderLibrary library(shaderFolder());
    {
        const ShaderFile file("lib/sky.glsl", "// mine\n");
        EXPECT_EQ(*library.source("lib/sky.glsl"), "// mine\n");
        EXPECT_EQ(*library.source("lib/angle.glsl"), contentOf(sources / "lib/angle.glsl"));
        EXPECT_EQ(*ShaderLibrary("").source("lib/sky.glsl"), contentOf(sources / "lib/sky.glsl"));
    }
    EXPECT_EQ(*library.source("lib/sky.glsl"), contentOf(sources / "lib/sky.glsl"));
    EXPECT_EQ(*ShaderLibrary("/absent").source("lib/sky.glsl"),
              contentOf(sources / "lib/sky.glsl"));
}

TEST(ShaderLibrary, RevisionTellsEveryChange)
{
    EXPECT_EQ(ShaderLibrary("").revision(), 0);
    EXPECT_EQ(ShaderLibrary("/absent").revision(), 0);
    const ShaderLibrary library(shaderFolder());
    std::set<long long> seen = {library.revision()};
    const auto isNew = [&] { return seen.insert(library.revision()).second; };

    auto older = std::make_unique<ShaderFile>("lib/older.glsl", "a");
    EXPECT_TRUE(isNew());
    EXPECT_FALSE(isNew()) << "nothing happened";
    auto newer = std::make_unique<ShaderFile>("lib/newer.glsl", "b");
    EXPECT_TRUE(isNew());
    newer->write("c");
    EXPECT_TRUE(isNew());
    // Not the newest file: one that is put back to an old state, and one that goes.
    const std::filesystem::path path = shaderFolder() + "/lib/older.glsl";
    std::filesystem::last_write_time(path, std::filesystem::last_write_time(path) -
                                               std::chrono::hours(1));
    EXPECT_TRUE(isNew());
    older = nullptr;
    EXPECT_TRUE(isNew());
}

TEST(ShaderLibrary, LogsOfAllDriversNameFileAndLine)
{
    const ComposedShader shader{
        "", {{"preamble.glsl", 3}, {"lib/angle.glsl", 10}, {"passes/a.comp", 40}}};
    EXPECT_EQ(shader.mapLog("0:26(5): error: bad\n0:40(1): warning: odd\n"), // Mesa
              "lib/angle.glsl:17(5): error: bad\npasses/a.comp:1(1): warning: odd\n");
    EXPECT_EQ(shader.mapLog("0(56) : error C1008: bad\n0(3) : warning"), // NVIDIA
              "passes/a.comp:17 : error C1008: bad\npreamble.glsl:1 : warning");
    EXPECT_EQ(shader.mapLog("ERROR: 0:39: 'x' : bad\nWARNING: 0:43: odd"), // glslang
              "ERROR: lib/angle.glsl:30: 'x' : bad\nWARNING: passes/a.comp:4: odd");
    for (const char* other :
         {"", "link error\n", "error at 0:12\n", "1:12(1): no such source\n",
          "0:2(1): the version line\n", "0:99999999999999999999(1): no such line\n"})
        EXPECT_EQ(shader.mapLog(other), other);
}

TEST(ShaderLibrary, PassesAreBuiltAgainWhenAFileChanges)
{
    OTL_NEED_GL(context);
    ShaderFile file("passes/test_rebuild.comp", writes("1.0"));
    OneValue one("test_rebuild");
    EXPECT_EQ(one.run(context->state()), 1.0f);
    EXPECT_EQ(one.run(context->state()), 1.0f);
    file.write(writes("2.0"));
    EXPECT_EQ(one.run(context->state()), 2.0f);

    // A library file counts as well, and so does its going away.
    file.write(writes("elevationOfSlope(1.0)"));
    const float level = one.run(context->state());
    EXPECT_NEAR(level, 0.785398, 1e-6);
    {
        std::string angle = contentOf(sources / "lib/angle.glsl");
        const std::string last = "return slope < real(0.0) ? -angle : angle;";
        angle.replace(angle.find(last), last.size(), "return real(77.0);");
        const ShaderFile library("lib/angle.glsl", angle);
        EXPECT_EQ(one.run(context->state()), 77.0f);
    }
    EXPECT_EQ(one.run(context->state()), level);

    // A mistake while editing is an error each time, until it is mended.
    file.write(writes("2.0 +"));
    {
        const QuietOsg quiet;
        EXPECT_FALSE(one.pass->dispatch(context->state(), {}).ok());
        EXPECT_FALSE(one.pass->dispatch(context->state(), {}).ok());
    }
    file.write(writes("3.0"));
    EXPECT_EQ(one.run(context->state()), 3.0f);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(ShaderLibrary, ErrorsNameFileAndLine)
{
    OTL_NEED_GL(context);
    const QuietOsg quiet;
    const ShaderFile pass("passes/test_error.comp", writes("1.0"));
    for (const char* const name : {"lib/angle.glsl", "lib/sky.glsl"})
    {
        // In place of a whole line, so that the lines after it keep their numbers.
        const std::string line = name == std::string("lib/sky.glsl") ? "    real s = sin(theta);"
                                                                     : "    real y = x * x;";
        std::string text = contentOf(sources / name);
        text.replace(text.find(line), line.size(), "    real s = planted;");
        const ShaderFile library(name, text);
        const Status done = OneValue("test_error").pass->dispatch(context->state(), {});
        ASSERT_FALSE(done.ok());
        EXPECT_NE(done.error().message.find("passes/test_error.comp"), std::string::npos);
        EXPECT_NE(done.error().message.find(placeOf(name, line)), std::string::npos)
            << done.error().message;
        EXPECT_NE(done.error().message.find("planted"), std::string::npos);
    }
    const Status done = OneValue("test_absent").pass->dispatch(context->state(), {});
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(done.error().code, ErrorCode::NotFound);
    EXPECT_NE(done.error().message.find("passes/test_absent.comp"), std::string::npos);
}
