#include "gpu/ShaderLibrary.h"
#include "gpu/Textures.h"
#include "lighting/nodes/HorizonNode.h"
#include "support/GlContext.h"

#include <osg/GLExtensions>
#include <osg/Program>
#include <osg/Shader>

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

using namespace osgTerrainLight;

namespace
{
struct Variant
{
    std::string pass;
    std::vector<std::string> defines;
};

/// Every combination of defines in use. One that is not listed does not exist.
const std::vector<Variant> variants = {
    {"bounce_finish", {}},
    {"bounce_own", {}},
    {"bounce_own", {"SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 5"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 5", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 5", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 5", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 6"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 6", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 6", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 6", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 7"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 7", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 7", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 7", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 8"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 8", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 8", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 8", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 9"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 9", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 9", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 9", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 10"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 10", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 10", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 10", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 11"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 11", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 11", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 11", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 12"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 12", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 12", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 12", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 13"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 13", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 13", "SUN"}},
    {"bounce_sweep", {"NEAR 2", "ENTRIES 2", "LEVELS 13", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 5"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 5", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 5", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 5", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 6"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 6", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 6", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 6", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 7"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 7", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 7", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 7", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 8"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 8", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 8", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 8", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 9"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 9", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 9", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 9", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 10"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 10", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 10", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 10", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 11"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 11", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 11", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 11", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 12"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 12", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 12", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 12", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 13"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 13", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 13", "SUN"}},
    {"bounce_sweep", {"NEAR 3", "ENTRIES 4", "LEVELS 13", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 5"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 5", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 5", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 5", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 6"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 6", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 6", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 6", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 7"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 7", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 7", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 7", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 8"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 8", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 8", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 8", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 9"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 9", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 9", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 9", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 10"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 10", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 10", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 10", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 11"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 11", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 11", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 11", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 12"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 12", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 12", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 12", "SURROUNDED", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 13"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 13", "SURROUNDED"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 13", "SUN"}},
    {"bounce_sweep", {"NEAR 4", "ENTRIES 8", "LEVELS 13", "SURROUNDED", "SUN"}},
    {"compose", {}},
    {"environment_harmonics", {"ORDER 2"}},
    {"environment_harmonics", {"ORDER 3"}},
    {"environment_harmonics", {"ORDER 4"}},
    {"environment_harmonics", {"ORDER 5"}},
    {"environment_harmonics", {"ORDER 6"}},
    {"environment_harmonics", {"ORDER 2", "CUBE"}},
    {"environment_harmonics", {"ORDER 3", "CUBE"}},
    {"environment_harmonics", {"ORDER 4", "CUBE"}},
    {"environment_harmonics", {"ORDER 5", "CUBE"}},
    {"environment_harmonics", {"ORDER 6", "CUBE"}},
    {"faces", {}},
    {"faces", {"DIRECT"}},
    {"faces", {"DIRECT", "SUN"}},
    {"faces", {"DIRECT", "KEY_LIGHTS"}},
    {"faces", {"DIRECT", "KEY_LIGHTS", "SUN"}},
    {"faces", {"DIRECT", "SKY_TABLE"}},
    {"faces", {"DIRECT", "SKY_TABLE", "SUN"}},
    {"faces", {"DIRECT", "SKY_TABLE", "KEY_LIGHTS"}},
    {"faces", {"DIRECT", "SKY_TABLE", "KEY_LIGHTS", "SUN"}},
    {"frame_heights", {}},
    {"gloss", {}},
    {"gloss", {"DIRECT"}},
    {"gloss", {"DIRECT", "HARMONICS"}},
    {"gloss", {"DIRECT", "KEY_LIGHTS"}},
    {"gloss", {"DIRECT", "HARMONICS", "KEY_LIGHTS"}},
    {"gloss", {"SCALAR"}},
    {"gloss_shade", {}},
    {"harmonics_sum", {}},
    {"horizon_near", {}},
    {"horizon_scan", {}},
    // The nearest line; one line per post (Draft, Normal), or more.
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 1", "PARITY 0"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 1", "PARITY 0", "SURROUNDED"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 1", "PARITY 0", "DENSE"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 1", "PARITY 0", "DENSE", "SURROUNDED"}},
    // Two lines: even ones, then odd ones (Best).
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 0"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 0", "SURROUNDED"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 1"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 1", "SURROUNDED"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 0", "DENSE"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 0", "DENSE", "SURROUNDED"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 1", "DENSE"}},
    {"horizon_sweep", {"HULL_SIZE 64", "ASKED 2", "PARITY 1", "DENSE", "SURROUNDED"}},
    {"irradiance_map", {"ORDER 2"}},
    {"irradiance_map", {"ORDER 3"}},
    {"irradiance_map", {"ORDER 4"}},
    {"irradiance_map", {"ORDER 5"}},
    {"irradiance_map", {"ORDER 6"}},
    {"irradiance_map", {"ORDER 2", "DISC"}},
    {"irradiance_map", {"ORDER 3", "DISC"}},
    {"irradiance_map", {"ORDER 4", "DISC"}},
    {"irradiance_map", {"ORDER 5", "DISC"}},
    {"irradiance_map", {"ORDER 6", "DISC"}},
    {"legendre_light", {}},
    {"legendre_light", {"SENDS_ON"}},
    {"legendre_light", {"SUBSAMPLED"}},
    {"legendre_light", {"SENDS_ON", "SUBSAMPLED"}},
    {"legendre_light", {"DIRECT"}},
    {"legendre_light", {"DIRECT", "HARMONICS"}},
    {"legendre_light", {"DIRECT", "SUBSAMPLED"}},
    {"legendre_light", {"DIRECT", "HARMONICS", "SUBSAMPLED"}},
    {"post_radiance", {}},
    {"object_factor", {"AMONG_OBJECTS"}},
    {"object_factor", {"AMONG_OBJECTS", "HORIZON"}},
    {"object_factor", {"AMONG_OBJECTS", "SKY_PICTURE"}},
    {"object_factor", {"AMONG_OBJECTS", "SUN_AMONG_OBJECTS"}},
    {"object_factor", {"AMONG_OBJECTS", "HORIZON", "SKY_PICTURE"}},
    {"object_factor", {"AMONG_OBJECTS", "HORIZON", "SUN_AMONG_OBJECTS"}},
    {"object_factor", {"AMONG_OBJECTS", "SKY_PICTURE", "SUN_AMONG_OBJECTS"}},
    {"object_factor", {"AMONG_OBJECTS", "HORIZON", "SKY_PICTURE", "SUN_AMONG_OBJECTS"}},
    {"object_radiosity", {"AMONG_OBJECTS"}},
    {"object_radiosity", {"AMONG_OBJECTS", "HORIZON"}},
    {"object_radiosity", {"AMONG_OBJECTS", "SKY_PICTURE"}},
    {"object_radiosity", {"AMONG_OBJECTS", "SUN_AMONG_OBJECTS"}},
    {"object_radiosity", {"AMONG_OBJECTS", "HORIZON", "SKY_PICTURE"}},
    {"object_radiosity", {"AMONG_OBJECTS", "HORIZON", "SUN_AMONG_OBJECTS"}},
    {"object_radiosity", {"AMONG_OBJECTS", "SKY_PICTURE", "SUN_AMONG_OBJECTS"}},
    {"object_radiosity", {"AMONG_OBJECTS", "HORIZON", "SKY_PICTURE", "SUN_AMONG_OBJECTS"}},
    {"object_volume", {}},
    {"probe_panorama", {}},
    {"probe_panorama", {"SKY_PICTURE"}},
    {"pyramid", {}},
    {"pyramid", {"FROM_CELLS"}},
    {"pyramid", {"HEIGHTS"}},
    {"pyramid", {"HEIGHTS", "FROM_POSTS"}},
    {"pyramid", {"ON_POSTS"}},
    {"pyramid", {"ON_POSTS", "LAYERED"}},
    {"pyramid_horizon", {}},
    {"radiance", {}},
    {"radiance", {"SUN"}},
    {"screen_edges", {}},
    {"screen_edges", {"SUN"}},
    {"shade", {}},
    {"shade", {"SUN"}},
    {"shade", {"SKY_TABLE"}},
    {"shade", {"SKY_TABLE", "SUN"}},
    {"shade", {"KEY_LIGHTS"}},
    {"shade", {"KEY_LIGHTS", "SUN"}},
    {"shade", {"SKY_TABLE", "KEY_LIGHTS"}},
    {"shade", {"SKY_TABLE", "KEY_LIGHTS", "SUN"}},
    {"shadow_edge", {}},
    {"shadow_lines", {}},
    {"shadow_lines", {"SURROUNDED"}},
    {"sky_environment", {}},
    {"sky_harmonics", {}},
    {"sky_model", {}},
    {"sky_model", {"CLEAR"}},
    {"sky_table", {}},
    {"sky_view", {}},
    {"sky_view", {"SKY_TABLE"}},
};

std::string nameOf(const Variant& variant)
{
    std::string name = variant.pass;
    for (const std::string& define : variant.defines)
        name += ", " + define;
    return name;
}
} // namespace

TEST(ShaderVariants, EveryPassIsListed)
{
    std::set<std::string> listed;
    for (const Variant& variant : variants)
        listed.insert("passes/" + variant.pass + ".comp");
    std::set<std::string> embedded;
    for (const std::string& name : ShaderLibrary::names())
        if (name.rfind("passes/", 0) == 0)
            embedded.insert(name);
    EXPECT_EQ(listed, embedded);
}

TEST(ShaderVariants, EveryDefineOfAPassIsListed)
{
    for (const std::string& file : ShaderLibrary::names())
    {
        if (file.rfind("passes/", 0) != 0)
            continue;
        const std::string text = *ShaderLibrary("").source(file);
        std::set<std::string> asked;
        static const std::regex line(R"re(#\s*(if|ifdef|ifndef|elif)\b([^\n]*))re");
        static const std::regex word(R"re([A-Z][A-Z0-9_]+)re");
        for (std::sregex_iterator i(text.begin(), text.end(), line), end; i != end; ++i)
        {
            const std::string condition = (*i)[2];
            for (std::sregex_iterator j(condition.begin(), condition.end(), word); j != end; ++j)
                asked.insert(j->str());
        }
        for (const std::string& define : asked)
            EXPECT_TRUE(std::any_of(variants.begin(), variants.end(),
                                    [&](const Variant& variant)
                                    {
                                        return file == "passes/" + variant.pass + ".comp" &&
                                               std::any_of(variant.defines.begin(),
                                                           variant.defines.end(),
                                                           [&](const std::string& defined) {
                                                               return defined.rfind(define, 0) == 0;
                                                           });
                                    }))
                << file << " asks for " << define << ", which no listed variant defines";
    }
}

TEST(ShaderVariants, EveryVariantCompilesAndLinks)
{
    OTL_NEED_GL(context);
    for (const Variant& variant : variants)
    {
        SCOPED_TRACE(nameOf(variant));
        const Result<ComposedShader> shader =
            ShaderLibrary("").compose("passes/" + variant.pass + ".comp", variant.defines);
        ASSERT_TRUE(shader.ok()) << shader.error().message;
        const osg::ref_ptr<osg::Program> program = new osg::Program;
        program->addShader(new osg::Shader(osg::Shader::COMPUTE, shader->text));
        program->compileGLObjects(context->state());
        std::string log;
        program->getShader(0)->getPCS(context->state())->getInfoLog(log);
        EXPECT_TRUE(program->getPCP(context->state())->isLinked()) << shader->mapLog(log);
        // A warning of one driver is an error of another.
        EXPECT_EQ(shader->mapLog(log).find("warning"), std::string::npos) << shader->mapLog(log);
        program->releaseGLObjects(&context->state());
    }
    EXPECT_EQ(takeGlErrors(), "");
}

// OpenGL 4.3, table 23.67: MAX_COMPUTE_UNIFORM_COMPONENTS is 1024 or more. Drivers that have no
// more exist. A vector may count as four components, an element of an array too.
TEST(ShaderVariants, EveryVariantFitsTheUniformsThatOpenGlGuarantees)
{
    OTL_NEED_GL(context);
    osg::State& state = context->state();
    const auto* extensions = state.get<osg::GLExtensions>();
    for (const Variant& variant : variants)
    {
        SCOPED_TRACE(nameOf(variant));
        const Result<ComposedShader> shader =
            ShaderLibrary("").compose("passes/" + variant.pass + ".comp", variant.defines);
        ASSERT_TRUE(shader.ok()) << shader.error().message;
        const osg::ref_ptr<osg::Program> program = new osg::Program;
        program->addShader(new osg::Shader(osg::Shader::COMPUTE, shader->text));
        program->compileGLObjects(state);
        const GLuint handle = program->getPCP(state)->getHandle();
        GLint count = 0;
        extensions->glGetProgramiv(handle, GL_ACTIVE_UNIFORMS, &count);
        GLint vectors = 0, images = 0;
        for (GLuint i = 0; i < static_cast<GLuint>(count); ++i)
        {
            GLint block = -1;
            extensions->glGetActiveUniformsiv(handle, 1, &i, GL_UNIFORM_BLOCK_INDEX, &block);
            if (block >= 0)
                continue;
            GLint size = 0;
            extensions->glGetActiveUniformsiv(handle, 1, &i, GL_UNIFORM_SIZE, &size);
            vectors += size;
            GLint type = 0;
            extensions->glGetActiveUniformsiv(handle, 1, &i, GL_UNIFORM_TYPE, &type);
            constexpr GLint firstImage = 0x904C; // GL_IMAGE_1D
            constexpr GLint lastImage = 0x906C;  // GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY
            images += type >= firstImage && type <= lastImage ? size : 0;
        }
        EXPECT_GT(vectors, 0);
        EXPECT_LE(4 * vectors, 1024);
        EXPECT_GE(images, 1); // what the pass writes
        EXPECT_LE(images, 8);
        program->releaseGLObjects(&state);
    }
    EXPECT_EQ(takeGlErrors(), "");
}

TEST(ShaderVariants, EveryQualityRunsWithListedOnes)
{
    OTL_NEED_GL(context);
    DemTile tile(9, 7, 10.0);
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x)
            tile.setHeight(x, y, float(x * y));
    for (const HorizonQuality quality :
         {HorizonQuality::Draft, HorizonQuality::Normal, HorizonQuality::Best})
    {
        const HorizonScheme scheme = HorizonScheme::of(quality);
        for (int parity = 0; parity < scheme.linesAsked; ++parity)
        {
            Variant used{"horizon_sweep",
                         {"HULL_SIZE 64", "ASKED " + std::to_string(scheme.linesAsked),
                          "PARITY " + std::to_string(parity)}};
            if (scheme.linesPerPost > 1)
                used.defines.push_back("DENSE");
            EXPECT_TRUE(std::any_of(variants.begin(), variants.end(),
                                    [&](const Variant& listed)
                                    { return nameOf(listed) == nameOf(used); }))
                << nameOf(used);
        }
        const osg::ref_ptr<TileSurface> surface = new TileSurface(tile, HorizonNode::frame);
        const osg::ref_ptr<HorizonNode> node =
            new HorizonNode("horizon", *surface, scheme, 2,
                            [] {
                                return std::vector<MapDirection>{{1.0, 0.0}, {-0.6, 0.8}};
                            });
        const Status done = node->run(context->state());
        EXPECT_TRUE(done.ok()) << (done ? "" : done.error().message);
        EXPECT_EQ(takeGlErrors(), "");
    }
}
