#include "gpu/GlConstants.h"
#include "gpu/GpuPass.h"

#include "gpu/Textures.h"
#include "support/GlContext.h"
#include "support/ShaderFolder.h"

#include <osg/GLObjects>
#include <osg/Program>
#include <osg/Shader>
#include <osg/StateSet>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>

#ifndef GL_CURRENT_PROGRAM
#define GL_CURRENT_PROGRAM 0x8B8D
#endif

#ifndef GL_SHADER_STORAGE_BUFFER_BINDING
#define GL_SHADER_STORAGE_BUFFER_BINDING 0x90D3
#endif

using namespace osgTerrainLight;

namespace
{
/// result = values * gain + offset + bias
const char* const combine = R"(
layout(local_size_x = 4, local_size_y = 2) in;
uniform sampler2D values;
uniform sampler2D offsets;
layout(r32f, binding = 0) writeonly uniform image2D result;
uniform ivec2 size;
uniform float gain;
uniform vec3 bias;
void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (at.x < size.x && at.y < size.y)
        imageStore(result, at, gain * texelFetch(values, at, 0) + texelFetch(offsets, at, 0) +
                                   vec4(bias.x + bias.y + bias.z));
}
)";

class GpuPassTest : public testing::Test
{
protected:
    static constexpr int width = 7, height = 5;

    osg::ref_ptr<osg::Texture2D> ramp(float first) const
    {
        Raster<float> values(width, height);
        std::iota(values.values().begin(), values.values().end(), first);
        return createFloatTexture(values);
    }

    /// A combine pass, all inputs set: result = 2·values + offsets.
    osg::ref_ptr<GpuPass> makePass(osg::Texture* values, osg::Texture* offsets,
                                   osg::Texture* result) const
    {
        osg::ref_ptr<GpuPass> pass = new GpuPass("test_combine");
        pass->reads("values", values);
        pass->reads("offsets", offsets);
        pass->writes(0, result);
        pass->set("size", width, height);
        pass->set("gain", 2.0f);
        pass->set("bias", osg::Vec3f(0.0f, 0.0f, 0.0f));
        return pass;
    }

    static void run(GpuPass& pass, osg::State& state)
    {
        const Status done =
            pass.dispatch(state, {GpuPass::groupsFor(width, 4), GpuPass::groupsFor(height, 2), 1});
        EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
        EXPECT_EQ(takeGlErrors(), "");
    }

    static std::vector<float> expected(float first, float gain, float offset)
    {
        std::vector<float> values;
        for (int i = 0; i < width * height; ++i)
            values.push_back(gain * (first + float(i)) + offset + float(i));
        return values;
    }

private:
    ShaderFile _combine{"passes/test_combine.comp", combine};
};

GLint integer(GLenum name)
{
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}
} // namespace

TEST(GpuPassGroups, CoverTheCount)
{
    EXPECT_EQ(GpuPass::groupsFor(0, 8), 0u);
    EXPECT_EQ(GpuPass::groupsFor(1, 8), 1u);
    EXPECT_EQ(GpuPass::groupsFor(8, 8), 1u);
    EXPECT_EQ(GpuPass::groupsFor(9, 8), 2u);
}

TEST_F(GpuPassTest, WritesWhatItsInputsSay)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto result = createTarget(width, height, GL_R32F);
    const auto pass = makePass(ramp(10.0f), ramp(500.0f), result);
    run(*pass, state);
    EXPECT_EQ(readFloats(state, *result, 1), expected(10.0f, 2.0f, 500.0f));
    EXPECT_EQ(takeGlErrors(), "");

    // Each declaration can be replaced, and the replacement counts at once.
    pass->set("gain", 4.0f);
    run(*pass, state);
    EXPECT_EQ(readFloats(state, *result, 1), expected(10.0f, 4.0f, 500.0f));
    pass->set("bias", osg::Vec3f(1.0f, 20.0f, 300.0f));
    pass->reads("values", ramp(0.0f));
    run(*pass, state);
    EXPECT_EQ(readFloats(state, *result, 1), expected(0.0f, 4.0f, 821.0f));
    const auto other = createTarget(width, height, GL_R32F);
    pass->writes(0, other);
    pass->set("gain", 1.0f);
    run(*pass, state);
    EXPECT_EQ(readFloats(state, *other, 1), expected(0.0f, 1.0f, 821.0f));
    EXPECT_EQ(readFloats(state, *result, 1), expected(0.0f, 4.0f, 821.0f));
}

TEST_F(GpuPassTest, OnePassReadsWhatAnotherWrote)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    // Twenty dispatches in a row, each upon the last: the barrier between them is the pass's own.
    osg::ref_ptr<osg::Texture2D> from = ramp(0.0f);
    const auto zero = createFloatTexture(Raster<float>(width, height, 0.0f));
    for (int i = 0; i < 20; ++i)
    {
        const auto to = createTarget(width, height, GL_R32F);
        run(*makePass(from, zero, to), state);
        from = to;
    }
    std::vector<float> values;
    for (int i = 0; i < width * height; ++i)
        values.push_back(float(i) * 1048576.0f);
    EXPECT_EQ(readFloats(state, *from, 1), values);
}

TEST_F(GpuPassTest, UniformsSetTwiceBetweenRunsHoldTheLastValue)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto result = createTarget(width, height, GL_R32F);
    const auto pass = makePass(ramp(1.0f), ramp(1.0f), result);
    run(*pass, state);
    // New uniform objects, each as often modified as the last, one perhaps at a freed one's
    // address.
    for (int i = 0; i < 20; ++i)
    {
        pass->set("size", 0, 0);
        pass->set("size", width, i % 2);
        const auto fresh = createFloatTexture(Raster<float>(width, height, -1.0f));
        pass->writes(0, fresh);
        run(*pass, state);
        EXPECT_EQ(readFloats(state, *fresh, 1)[0], i % 2 == 1 ? 3.0f : -1.0f);
    }
}

TEST_F(GpuPassTest, PassesOfAVariantShareAProgramAndNoValues)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto result = createTarget(width, height, GL_R32F);
    osg::ref_ptr<GpuPass> twice = makePass(ramp(10.0f), ramp(500.0f), result);
    osg::ref_ptr<GpuPass> thrice = makePass(ramp(20.0f), ramp(0.0f), result);
    thrice->set("gain", 3.0f);
    run(*twice, state);
    const auto program = [&state]
    {
        const auto shared = ComputeProgram::shared("test_combine", {});
        EXPECT_TRUE(shared);
        return (*shared)->program().getPCP(state)->getHandle();
    };
    const GLuint handle = program();
    EXPECT_TRUE(state.get<osg::GLExtensions>()->glIsProgram(handle));
    for (int i = 0; i < 2; ++i)
    {
        run(*thrice, state);
        EXPECT_EQ(readFloats(state, *result, 1), expected(20.0f, 3.0f, 0.0f));
        run(*twice, state);
        EXPECT_EQ(readFloats(state, *result, 1), expected(10.0f, 2.0f, 500.0f));
    }
    EXPECT_EQ(program(), handle);

    // A pass that goes takes nothing from the other one.
    const auto flush = [&state]
    {
        double plenty = 10.0;
        osg::flushDeletedGLObjects(state.getContextID(), 1.0e9, plenty);
    };
    twice->releaseGLObjects(&state);
    flush();
    EXPECT_EQ(program(), handle);
    twice = nullptr;
    run(*thrice, state);
    EXPECT_EQ(readFloats(state, *result, 1), expected(20.0f, 3.0f, 0.0f));
    EXPECT_EQ(program(), handle);

    // The last one takes the program with it.
    thrice->releaseGLObjects(&state);
    flush();
    EXPECT_FALSE(state.get<osg::GLExtensions>()->glIsProgram(handle));
    run(*thrice, state);
    EXPECT_EQ(readFloats(state, *result, 1), expected(20.0f, 3.0f, 0.0f));
}

TEST_F(GpuPassTest, NewTextureAtADeletedOnesAddressIsSeen)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto result = createTarget(width, height, GL_R32F);
    const auto pass = makePass(ramp(0.0f), ramp(0.0f), result);
    const auto zero = createFloatTexture(Raster<float>(width, height, 0.0f));
    pass->reads("offsets", zero);
    std::set<const void*> addresses;
    int again = 0;
    for (int i = 0; i < 50; ++i)
    {
        // The allocator gives the address of the one that the line before freed.
        pass->reads("values", nullptr);
        const auto values = createFloatTexture(Raster<float>(width, height, float(i)));
        again += !addresses.insert(values.get()).second;
        pass->reads("values", values);
        run(*pass, state);
        ASSERT_EQ(readFloats(state, *result, 1).front(), 2.0f * float(i));
        ASSERT_EQ(readFloats(state, *values, 1).front(), float(i));
    }
    EXPECT_GT(again, 0) << "no address came twice: nothing was tested";
}

TEST_F(GpuPassTest, NewOutputAtADeletedOnesAddressIsAllocated)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto pass = makePass(ramp(3.0f), ramp(4.0f), nullptr);
    std::set<const void*> addresses;
    int again = 0;
    for (int i = 0; i < 50; ++i)
    {
        pass->writes(0, static_cast<osg::Texture*>(nullptr));
        // Other sizes: a stale allocation would be too small.
        const auto result = createTarget(width + i, height + i, GL_R32F);
        again += !addresses.insert(result.get()).second;
        pass->writes(0, result);
        run(*pass, state);
        const std::vector<float> found = readFloats(state, *result, 1);
        ASSERT_EQ(found.size(), static_cast<std::size_t>((width + i) * (height + i)));
        ASSERT_EQ(found.front(), 10.0f);
    }
    EXPECT_GT(again, 0) << "no address came twice: nothing was tested";
}

TEST_F(GpuPassTest, LayersAndCountersAreReadAndWritten)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const ShaderFile file("passes/test_layers.comp", R"(
layout(local_size_x = 1) in;
layout(r16, binding = 0) uniform image2DArray codes;
layout(r32ui, binding = 1) uniform uimage2D counter;
uniform bool first;
void main()
{
    ivec3 at = ivec3(gl_GlobalInvocationID);
    float value = float(at.x + 10 * at.y + 100 * at.z) / 65535.0;
    if (!first)
        value = imageLoad(codes, at).x + 1.0 / 65535.0;
    imageStore(codes, at, vec4(value));
    imageAtomicAdd(counter, ivec2(0), 1u);
}
)");
    const osg::ref_ptr<GpuPass> pass = new GpuPass("test_layers");
    const auto codes = createLayeredTarget(3, 2, 4, GL_R16);
    const auto counter = createTarget(1, 1, GL_R32UI);
    pass->writes(0, codes, GpuPass::Access::ReadWrite);
    pass->writes(1, counter, GpuPass::Access::ReadWrite);
    for (const bool first : {true, false})
    {
        pass->set("first", first);
        const Status done = pass->dispatch(state, {3, 2, 4});
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(takeGlErrors(), "");
        std::vector<std::uint16_t> expected;
        for (int z = 0; z < 4; ++z)
            for (int y = 0; y < 2; ++y)
                for (int x = 0; x < 3; ++x)
                    expected.push_back(
                        static_cast<std::uint16_t>(x + 10 * y + 100 * z + (first ? 0 : 1)));
        EXPECT_EQ(readUnorm16(state, *codes), expected);
        EXPECT_EQ(readUints(state, *counter), std::vector<std::uint32_t>{first ? 24u : 48u});
        EXPECT_EQ(takeGlErrors(), "");
    }
}

TEST_F(GpuPassTest, ReadsItsBlock)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const ShaderFile file("passes/test_block.comp", R"(
layout(local_size_x = 1) in;
layout(r32f, binding = 0) writeonly uniform image2D result;
layout(std140, binding = 0) uniform Table
{
    vec4 first[2];
    vec4 second[3];
};
void main()
{
    int i = int(gl_GlobalInvocationID.x);
    vec4 row = i < 2 ? first[i] : second[i - 2];
    imageStore(result, ivec2(i, 0), vec4(dot(row, vec4(1.0, 10.0, 100.0, 1000.0))));
}
)");
    const osg::ref_ptr<GpuPass> pass = new GpuPass("test_block");
    const auto result = createTarget(5, 1, GL_R32F);
    pass->writes(0, result);
    // The scene's own block, in the same place.
    const osg::ref_ptr<osg::FloatArray> theirs = new osg::FloatArray(4);
    theirs->setBufferObject(new osg::UniformBufferObject);
    const osg::ref_ptr<osg::StateSet> scene = new osg::StateSet;
    scene->setAttribute(new osg::UniformBufferBinding(0, theirs));
    for (int round = 0; round < 3; ++round)
    {
        std::vector<osg::Vec4f> values;
        std::vector<float> expected;
        for (int i = 0; i < 5; ++i)
        {
            values.emplace_back(float(i), float(round), 2.0f, 3.0f);
            expected.push_back(float(i + 10 * round + 3200));
        }
        pass->setBlock(values);
        const Status done = pass->dispatch(state, {5, 1, 1});
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(readFloats(state, *result, 1), expected);
        EXPECT_EQ(integer(GL_UNIFORM_BUFFER_BINDING), 0);
        state.apply(scene);
        const auto* object = theirs->getBufferObject()->getGLBufferObject(state.getContextID());
        EXPECT_EQ(static_cast<GLuint>(integer(GL_UNIFORM_BUFFER_BINDING)), object->getGLObjectID());
        if (round == 1)
            pass->releaseGLObjects(&state);
        EXPECT_EQ(takeGlErrors(), "");
    }
    const osg::ref_ptr<osg::StateSet> nothing = new osg::StateSet;
    state.apply(nothing);
}

TEST_F(GpuPassTest, WritesAndReadsAllSlicesOfAVolume)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const ShaderFile fill("passes/test_volume_fill.comp", R"(
layout(local_size_x = 1) in;
layout(r32f, binding = 0) writeonly uniform image3D volume;
void main()
{
    ivec3 at = ivec3(gl_GlobalInvocationID);
    imageStore(volume, at, vec4(at.x + 10 * at.y + 100 * at.z));
}
)");
    // Reads a volume as a sampler, filtered half-way to the next slice, and as an image.
    const ShaderFile use("passes/test_volume_use.comp", R"(
layout(local_size_x = 1) in;
uniform sampler3D volume;
layout(r32f, binding = 0) uniform image3D sum;
void main()
{
    ivec3 at = ivec3(gl_GlobalInvocationID);
    vec3 place = (vec3(at) + vec3(0.5, 0.5, 1.0)) / vec3(textureSize(volume, 0));
    float value = imageLoad(sum, at).x + textureLod(volume, place, 0.0).x;
    imageStore(sum, at, vec4(value));
}
)");
    const int columns = 3, rows = 2, slices = 4;
    const osg::ref_ptr<GpuPass> first = new GpuPass("test_volume_fill");
    const osg::ref_ptr<GpuPass> second = new GpuPass("test_volume_use");
    const auto volume = createVolumeTarget(columns, rows, slices, GL_R32F);
    const auto sum = createVolumeTarget(columns, rows, slices, GL_R32F);
    EXPECT_EQ(textureBytes(*volume), std::size_t(4 * columns * rows * slices));
    for (int round = 0; round < 2; ++round) // the second with textures that were released
    {
        first->writes(0, volume);
        ASSERT_TRUE(first->dispatch(state, {columns, rows, slices}).ok());
        first->writes(0, sum);
        ASSERT_TRUE(first->dispatch(state, {columns, rows, slices}).ok());
        second->reads("volume", volume);
        second->writes(0, sum, GpuPass::Access::ReadWrite);
        const Status done = second->dispatch(state, {columns, rows, slices});
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(takeGlErrors(), "");
        std::vector<float> written, summed;
        for (int z = 0; z < slices; ++z)
            for (int y = 0; y < rows; ++y)
                for (int x = 0; x < columns; ++x)
                {
                    // Beyond the last slice's middle is the last slice.
                    const float next = float(std::min(z + 1, slices - 1));
                    written.push_back(float(x + 10 * y + 100 * z));
                    summed.push_back(2.0f * float(x + 10 * y) + 100.0f * float(z) +
                                     50.0f * (float(z) + next));
                }
        EXPECT_EQ(readFloats(state, *volume, 1), written);
        EXPECT_EQ(readFloats(state, *sum, 1), summed);
        EXPECT_EQ(takeGlErrors(), "");
        volume->releaseGLObjects(&state);
        sum->releaseGLObjects(&state);
    }
}

TEST_F(GpuPassTest, PassesShareAStorageBuffer)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const ShaderFile file("passes/test_storage.comp", R"(
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Added { float added[]; };
layout(std430, binding = 3) buffer Sums { float sums[]; };
layout(std430, binding = 1) buffer Counter { uint counter; };
void main()
{
    uint i = gl_GlobalInvocationID.x;
    sums[i] += added[i];
    atomicAdd(counter, 1u);
}
)");
    const osg::ref_ptr<osg::FloatArray> added = new osg::FloatArray;
    const osg::ref_ptr<osg::FloatArray> sums = new osg::FloatArray;
    const osg::ref_ptr<osg::UIntArray> counter = new osg::UIntArray(1);
    for (int i = 0; i < 5; ++i)
    {
        added->push_back(float(i));
        sums->push_back(100.0f);
    }
    const auto makePass = [&]
    {
        osg::ref_ptr<GpuPass> pass = new GpuPass("test_storage");
        pass->setStorage(0, added);
        pass->setStorage(3, sums);
        pass->setStorage(1, counter);
        return pass;
    };
    readStorage(state, *counter); // no pass has used it
    EXPECT_EQ((*counter)[0], 0u);
    // Two passes in turn, each upon what the other left: the barrier between them is the pass's.
    const osg::ref_ptr<GpuPass> passes[] = {makePass(), makePass()};
    for (int i = 0; i < 10; ++i)
    {
        const Status done = passes[i % 2]->dispatch(state, {5, 1, 1});
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(integer(GL_SHADER_STORAGE_BUFFER_BINDING), 0);
    }
    readStorage(state, *sums);
    readStorage(state, *counter);
    EXPECT_EQ((*counter)[0], 50u);
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ((*sums)[static_cast<std::size_t>(i)], 100.0f + 10.0f * float(i));
    // A dirty array is uploaded anew; the others keep what the GPU has.
    for (float& value : *added)
        value = -1.0f;
    added->dirty();
    ASSERT_TRUE(passes[0]->dispatch(state, {5, 1, 1}).ok());
    readStorage(state, *sums);
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ((*sums)[static_cast<std::size_t>(i)], 99.0f + 10.0f * float(i));
    // Buffers go with a pass's other objects.
    const unsigned id = state.getContextID();
    EXPECT_NE(sums->getBufferObject()->getGLBufferObject(id), nullptr);
    passes[0]->releaseGLObjects(&state);
    EXPECT_EQ(sums->getBufferObject()->getGLBufferObject(id), nullptr);
    EXPECT_EQ(takeGlErrors(), "");
}

TEST_F(GpuPassTest, ReadsSeveralBlocks)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const ShaderFile file("passes/test_blocks.comp", R"(
layout(local_size_x = 1) in;
layout(r32f, binding = 0) writeonly uniform image2D result;
layout(std140, binding = 0) uniform First { vec4 first[2]; };
layout(std140, binding = 2) uniform Second { vec4 second[3]; };
void main()
{
    int i = int(gl_GlobalInvocationID.x);
    imageStore(result, ivec2(i, 0), vec4((i < 2 ? first[i] : second[i - 2]).y));
}
)");
    const osg::ref_ptr<GpuPass> pass = new GpuPass("test_blocks");
    const auto result = createTarget(5, 1, GL_R32F);
    pass->writes(0, result);
    for (int round = 0; round < 2; ++round)
    {
        const float base = 10.0f * float(round);
        pass->setBlock({{0.0f, base + 1.0f, 0.0f, 0.0f}, {0.0f, base + 2.0f, 0.0f, 0.0f}});
        pass->setBlock({{0.0f, base + 3.0f, 0.0f, 0.0f},
                        {0.0f, base + 4.0f, 0.0f, 0.0f},
                        {0.0f, base + 5.0f, 0.0f, 0.0f}},
                       2);
        const Status done = pass->dispatch(state, {5, 1, 1});
        ASSERT_TRUE(done.ok()) << done.error().message;
        EXPECT_EQ(
            readFloats(state, *result, 1),
            (std::vector<float>{base + 1.0f, base + 2.0f, base + 3.0f, base + 4.0f, base + 5.0f}));
        pass->releaseGLObjects(&state);
        EXPECT_EQ(takeGlErrors(), "");
    }
}

TEST_F(GpuPassTest, StateOfOsgHoldsAfterwards)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    // The scene's own program and textures, applied lazily as OSG does.
    const osg::ref_ptr<osg::Program> program = new osg::Program;
    program->addShader(new osg::Shader(osg::Shader::VERTEX,
                                       "#version 130\nvoid main() { gl_Position = vec4(0.0); }\n"));
    program->addShader(new osg::Shader(
        osg::Shader::FRAGMENT, "#version 130\nuniform sampler2D a;\nuniform float level;\n"
                               "void main() { gl_FragColor = level * texture(a, vec2(0.5)); }\n"));
    const osg::ref_ptr<osg::StateSet> scene = new osg::StateSet;
    scene->setAttributeAndModes(program);
    const osg::ref_ptr<osg::Texture2D> textures[] = {ramp(1.0f), ramp(2.0f), ramp(3.0f)};
    for (unsigned unit = 0; unit < 3; ++unit)
        scene->setTextureAttributeAndModes(unit, textures[unit]);
    scene->addUniform(new osg::Uniform("level", 0.25f));
    const auto expectScene = [&](const char* when)
    {
        SCOPED_TRACE(when);
        state.apply(scene);
        const auto* linked = program->getPCP(state);
        EXPECT_EQ(static_cast<GLuint>(integer(GL_CURRENT_PROGRAM)), linked->getHandle());
        EXPECT_EQ(state.getLastAppliedProgramObject(), linked);
        for (unsigned unit = 0; unit < 3; ++unit)
        {
            state.setActiveTextureUnit(unit);
            EXPECT_EQ(static_cast<GLuint>(integer(GL_TEXTURE_BINDING_2D)),
                      textures[unit]->getTextureObject(state.getContextID())->id())
                << unit;
        }
        const auto* extensions = state.get<osg::GLExtensions>();
        GLfloat level = 0.0f;
        extensions->glGetUniformfv(linked->getHandle(),
                                   extensions->glGetUniformLocation(linked->getHandle(), "level"),
                                   &level);
        EXPECT_EQ(level, 0.25f);
        EXPECT_EQ(takeGlErrors(), "");
    };
    expectScene("before");
    const auto result = createTarget(width, height, GL_R32F);
    const auto pass = makePass(ramp(0.0f), ramp(0.0f), result);
    for (const char* when : {"after the first run", "after the second"})
    {
        run(*pass, state);
        EXPECT_EQ(integer(GL_CURRENT_PROGRAM), 0);
        expectScene(when);
    }
    readFloats(state, *result, 1);
    expectScene("after reading back");
    // And the other way about: the scene's textures do not stand in for the pass's.
    run(*pass, state);
    EXPECT_EQ(readFloats(state, *result, 1), expected(0.0f, 2.0f, 0.0f));
    // The scene's textures go out of scope: nothing of them stays applied.
    const osg::ref_ptr<osg::StateSet> nothing = new osg::StateSet;
    state.apply(nothing);
}

TEST_F(GpuPassTest, RunsOnAfterItsObjectsAreReleased)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto result = createTarget(width, height, GL_R32F);
    const auto values = ramp(0.0f);
    const auto pass = makePass(values, values, result);
    for (int i = 0; i < 3; ++i)
    {
        run(*pass, state);
        EXPECT_EQ(readFloats(state, *result, 1), expected(0.0f, 2.0f, 0.0f));
        pass->releaseGLObjects(&state);
        pass->resizeGLObjectBuffers(4);
        values->releaseGLObjects(&state);
        result->releaseGLObjects(&state);
    }
    EXPECT_EQ(takeGlErrors(), "");
}
