#include "io/ExrLayers.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using namespace osgTerrainLight;

namespace
{
using Names = std::vector<std::string>;

/// Names of R, G, B in each layer.
Names coloured(const Names& layers)
{
    Names names;
    for (const std::string& layer : layers)
        for (const char* channel : {"R", "G", "B"})
            names.push_back(layer + (layer.empty() ? "" : ".") + channel);
    return names;
}

std::string first(const Names& channels, const Names& views = {})
{
    const std::vector<ExrLayer> layers = lightLayers({{"", channels, views}});
    return layers.empty() ? "none" : layers.front().prefix;
}
} // namespace

// Names as Blender, Cycles, Nuke, Arnold, V-Ray and OpenEXR's own documents have them; the picture
// is what these programs show first.
TEST(ExrLayers, ThePictureOfEachProgram)
{
    EXPECT_EQ(first(coloured({"", "AO", "beauty"})), "");
    EXPECT_EQ(first(coloured({"View Layer.AO", "View Layer.Combined", "View Layer.DiffCol"})),
              "View Layer.Combined.");
    EXPECT_EQ(first(coloured({"albedo", "crypto_asset", "RGBA", "specular"})), "RGBA.");
    EXPECT_EQ(first(coloured({"Beauty", "coat", "N"})), "Beauty.");
    EXPECT_EQ(first(coloured({"diffuse", "specular"})), "diffuse."); // by name, and said
    EXPECT_EQ(first(coloured({"Normal", "sky"})), "sky.");
    EXPECT_EQ(first(coloured({"Normal"})), "Normal."); // nothing else: taken, and said
}

// Colours of surfaces, as Blender, Arnold, RenderMan, V-Ray, Redshift and Houdini name them, before
// light in the order of the alphabet: they are taken last.
TEST(ExrLayers, ColoursOfSurfacesAreNoLight)
{
    for (const char* name : {"diffuse_color", "diffuse color", "DiffCol", "Diffuse Color",
                             "specular_color", "GlossCol", "TransCol", "base_color", "basecolour",
                             "albedo", "diffuse_albedo", "VRayDiffuseFilter", "DiffuseFilter"})
    {
        EXPECT_EQ(first(coloured({name, "z_emission"})), "z_emission.") << name;
        EXPECT_TRUE(isNoLight({0, "", std::string(name) + ".", LayerKind::Colours})) << name;
    }
    for (const char* name : {"color", "final_color", "sky_colour", "diffuse", "specular_direct",
                             "collection", "Emit", "reflection"})
        EXPECT_FALSE(isNoLight({0, "", std::string(name) + ".", LayerKind::Colours})) << name;
}

TEST(ExrLayers, VectorsAndDepthAreNoLuminance)
{
    EXPECT_EQ(first({"normal.X", "normal.Y", "normal.Z"}), "none");
    EXPECT_EQ(first({"flow.X", "flow.Y", "sky.Y"}), "sky.");
    EXPECT_EQ(first({"Z", "A", "layer.Y"}), "layer.");
    EXPECT_EQ(first({"Y", "RY", "BY"}), "");
    EXPECT_EQ(lightLayers({{"", {"Y", "RY", "BY"}, {}}})[0].kind, LayerKind::LuminanceChroma);
    EXPECT_EQ(lightLayers({{"", {"Y", "RY"}, {}}})[0].kind, LayerKind::Luminance);
    EXPECT_EQ(lightLayers({{"", {"Y", "R", "G", "B"}, {}}})[0].kind, LayerKind::Colours);
    EXPECT_EQ(first({"Z", "A", "R", "G"}), "none");
}

// Attribute multiView: the first view is the default one, whose channels need not name it.
TEST(ExrLayers, TheFirstViewCounts)
{
    EXPECT_EQ(first(coloured({"left", "right"}), {"right", "left"}), "right.");
    EXPECT_EQ(first(coloured({"", "left"}), {"right", "left"}), "");
    EXPECT_EQ(first(coloured({"beauty.left", "beauty.right", "ao.right"}), {"right", "left"}),
              "beauty.right.");
    EXPECT_EQ(lightLayers({{"", coloured({"left", "right"}), {"right", "left"}}}).size(), 2u);
}

// In a file of several parts the part's name is the layer's (Nuke, Blender, Houdini), and a part
// may have a view of its own; of equals the first counts.
TEST(ExrLayers, PartsAreLayersByTheirNames)
{
    const Names rgb = {"B", "G", "R"};
    const auto taken = [](const std::vector<ExrPart>& parts)
    {
        const std::vector<ExrLayer> layers = lightLayers(parts);
        return layers.empty() ? std::string("none")
                              : parts[layers[0].part].name + "/" + layers[0].prefix;
    };
    EXPECT_EQ(taken({{"normal", rgb, {}}, {"sky", rgb, {}}, {"sun", rgb, {}}}), "sky/");
    EXPECT_EQ(taken({{"ao", rgb, {}}, {"specular", rgb, {}}, {"rgba", rgb, {}}}), "rgba/");
    EXPECT_EQ(taken({{"View Layer.DiffDir", rgb, {}}, {"View Layer.Combined", rgb, {}}}),
              "View Layer.Combined/");
    EXPECT_EQ(taken({{"rgba_1", rgb, {}}, {"rgba_2", rgb, {}}}), "rgba_1/");
    EXPECT_EQ(taken({{"C.right", rgb, {"right"}},
                     {"beauty.left", rgb, {"left"}},
                     {"beauty.right", rgb, {"right"}}}),
              "beauty.left/");
    EXPECT_EQ(taken({{"a", {"Z"}, {}}, {"b", {"beauty.B", "beauty.G", "beauty.R", "R"}, {}}}),
              "b/beauty.");
    EXPECT_EQ(taken({{"deep", {}, {}}, {"P", {"X", "Y", "Z"}, {}}}), "none");
    EXPECT_EQ(taken({{"N", rgb, {}}}), "N/"); // nothing else: taken, and said
}
