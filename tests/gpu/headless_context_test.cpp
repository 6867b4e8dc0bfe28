#include <osgTerrainLight/HeadlessContext.h>

#include "gpu/GpuPass.h"
#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#ifndef GL_MAJOR_VERSION
#define GL_MAJOR_VERSION 0x821B
#define GL_MINOR_VERSION 0x821C
#endif

using namespace osgTerrainLight;

namespace
{
const char* const doubling = R"(
layout(local_size_x = 4) in;
uniform sampler2D values;
layout(r32f, binding = 0) writeonly uniform image2D result;
void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    imageStore(result, at, 2.0 * texelFetch(values, at, 0));
}
)";

/// Four values and twice them, in one context.
struct Doubled
{
    explicit Doubled(float value)
        : values(createFloatTexture(Raster<float>(4, 1, value))), twice(createTarget(4, 1, GL_R32F))
    {
    }

    std::vector<float> run(GpuPass& pass, HeadlessContext& context)
    {
        EXPECT_TRUE(context.makeCurrent());
        pass.reads("values", values);
        pass.writes(0, twice);
        const Status done = pass.dispatch(context.state(), {});
        EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
        EXPECT_EQ(takeGlErrors(), "");
        return readFloats(context.state(), *twice, 1);
    }

    osg::ref_ptr<osg::Texture2D> values;
    osg::ref_ptr<osg::Texture2D> twice;
};

/// Output of this program, run anew with other environment variables for the one test `name`.
std::string runAgain(const std::string& environment, const std::string& name)
{
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    std::FILE* output =
        popen((environment + " '" + program + "' --gtest_filter=" + name + " 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 512> part = {};
    while (output && std::fgets(part.data(), static_cast<int>(part.size()), output))
        text += part.data();
    if (output)
        pclose(output);
    return text;
}
} // namespace

TEST(HeadlessContext, IsSharedByTheTestsOfAProgram)
{
    OTL_NEED_GL(context);
    EXPECT_FALSE(context->platform().empty());
    EXPECT_EQ(takeGlErrors(), "");
    glEnable(0xFFFF);
    EXPECT_EQ(takeGlErrors(), "GL_INVALID_ENUM");
    EXPECT_EQ(takeGlErrors(), "");
    std::string reason;
    EXPECT_EQ(sharedGlContext(reason), context);
    EXPECT_EQ(reason, "");
}

TEST(HeadlessContext, ItsFramebufferIsAsLargeAsAsked)
{
    OTL_NEED_GL(shared);
    std::string problem;
    const auto context = HeadlessContext::create(33, 21, problem);
    ASSERT_TRUE(context) << problem;
    ASSERT_TRUE(context->window());
    EXPECT_EQ(context->window()->getTraits()->width, 33);
    EXPECT_EQ(context->window()->getTraits()->height, 21);
    glViewport(0, 0, 33, 21);
    glClearColor(0.0f, 1.0f, 0.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    std::vector<unsigned char> pixel(4);
    glReadPixels(32, 20, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
    EXPECT_EQ(pixel, (std::vector<unsigned char>{0, 255, 0, 255}));
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(HeadlessContext, TwoAtOnceDoNotMix)
{
    OTL_NEED_GL(first);
    std::string problem;
    auto second = HeadlessContext::create(16, 16, problem);
    ASSERT_TRUE(second) << problem;
    EXPECT_NE(first->state().getContextID(), second->state().getContextID());

    // One pass, and with it one program, in both; textures of their own and one that both use.
    const ShaderFile file("passes/test_double.comp", doubling);
    const osg::ref_ptr<GpuPass> pass = new GpuPass("test_double");
    Doubled a(1.0f);
    Doubled b(10.0f);
    Doubled both(100.0f);
    for (int turn = 0; turn < 3; ++turn)
    {
        EXPECT_EQ(a.run(*pass, *first), std::vector<float>(4, 2.0f));
        EXPECT_EQ(b.run(*pass, *second), std::vector<float>(4, 20.0f));
        EXPECT_EQ(both.run(*pass, *first), std::vector<float>(4, 200.0f));
        EXPECT_EQ(both.run(*pass, *second), std::vector<float>(4, 200.0f));
    }
    // The first works on when the second is gone.
    second = nullptr;
    EXPECT_EQ(a.run(*pass, *first), std::vector<float>(4, 2.0f));
    EXPECT_EQ(both.run(*pass, *first), std::vector<float>(4, 200.0f));
}

TEST(HeadlessContext, CanBeMadeAndDestroyedAgainAndAgain)
{
    OTL_NEED_GL(shared);
    const ShaderFile file("passes/test_double.comp", doubling);
    unsigned highest = 0;
    for (int turn = 0; turn < 8; ++turn)
    {
        std::string problem;
        const auto context = HeadlessContext::create(8, 8, problem);
        ASSERT_TRUE(context) << turn << ": " << problem;
        highest = std::max(highest, context->state().getContextID());
        const osg::ref_ptr<GpuPass> pass = new GpuPass("test_double");
        EXPECT_EQ(Doubled(3.0f).run(*pass, *context), std::vector<float>(4, 6.0f));
    }
    // The number of a closed context is free for the next one.
    EXPECT_LE(highest, shared->state().getContextID() + 2);
    EXPECT_TRUE(shared->makeCurrent());
}

TEST(GpuCapabilities, AreThoseOfTheContext)
{
    OTL_NEED_GL(context);
    const auto found = GpuCapabilities::query(context->state());
    ASSERT_TRUE(found.ok()) << found.error().message;
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    EXPECT_EQ(found->major, major);
    EXPECT_EQ(found->minor, minor);
    EXPECT_GE(found->major * 10 + found->minor, 43);
    EXPECT_FALSE(found->vendor.empty());
    EXPECT_FALSE(found->renderer.empty());
    // OpenGL 4.3 promises these.
    EXPECT_GE(found->maxTextureSize, 16384);
    EXPECT_GE(found->maxArrayLayers, 2048);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(GpuCapabilities, SoftwareIsKnownByName)
{
    GpuCapabilities found;
    found.renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
    EXPECT_TRUE(found.isSoftware());
    found.renderer = "softpipe";
    EXPECT_TRUE(found.isSoftware());
    found.renderer = "NVIDIA H100 80GB HBM3/PCIe/SSE2";
    EXPECT_FALSE(found.isSoftware());
}

TEST(GpuCapabilities, AnOlderOpenGlIsRefusedAndTestsSkip)
{
    OTL_NEED_GL(context);
    const auto found = GpuCapabilities::query(context->state());
    if (!found || found->version.find("Mesa") == std::string::npos)
        GTEST_SKIP()
            << "skipped: this OpenGL driver ignores MESA_GL_VERSION_OVERRIDE; needs Mesa's";
    const std::string text =
        runAgain("MESA_GL_VERSION_OVERRIDE=3.3", "HeadlessContext.IsSharedByTheTestsOfAProgram");
    EXPECT_NE(text.find("[  SKIPPED ] 1 test"), std::string::npos) << text;
    EXPECT_NE(text.find("needs OpenGL 4.3 (compute shaders); this context is OpenGL '3.3"),
              std::string::npos)
        << text;
}

TEST(HeadlessContext, WithoutADriverTestsSkipWithTheReason)
{
    OTL_NEED_GL(context);
    const std::string text =
        runAgain("__EGL_VENDOR_LIBRARY_FILENAMES=/absent __EGL_VENDOR_LIBRARY_DIRS=/absent "
                 "EGL_PLATFORM=absent",
                 "HeadlessContext.IsSharedByTheTestsOfAProgram");
    EXPECT_NE(text.find("[  SKIPPED ] 1 test"), std::string::npos) << text;
    EXPECT_NE(text.find("no OpenGL context without a display"), std::string::npos) << text;
}
