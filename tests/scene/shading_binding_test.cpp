#include "scene/ShadingBinding.h"

#include <osg/Texture2D>

#include <gtest/gtest.h>

using namespace osgTerrainLight;

namespace
{
osg::ref_ptr<osg::Texture2D> shadingTexture()
{
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D;
    texture->setTextureSize(5, 3);
    return texture;
}

/// Same content, down to the length of the lists.
void expectSame(const osg::StateSet& a, const osg::StateSet& b)
{
    EXPECT_EQ(a.compare(b, true), 0);
    EXPECT_EQ(a.getTextureAttributeList().size(), b.getTextureAttributeList().size());
    EXPECT_EQ(a.getTextureModeList(), b.getTextureModeList());
    EXPECT_EQ(a.getUniformList(), b.getUniformList());
    EXPECT_EQ(a.getAttributeList(), b.getAttributeList());
    EXPECT_EQ(a.getModeList(), b.getModeList());
    EXPECT_EQ(a.getDataVariance(), b.getDataVariance());
}

osg::ref_ptr<osg::StateSet> copyOf(const osg::StateSet& stateSet)
{
    return new osg::StateSet(stateSet, osg::CopyOp::SHALLOW_COPY);
}
} // namespace

TEST(ShadingBinding, LeavesAnEmptyStateSetEmpty)
{
    osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    const auto before = copyOf(*stateSet);
    for (osg::Program* program : {static_cast<osg::Program*>(nullptr), new osg::Program})
    {
        ShadingBinding binding(stateSet, shadingTexture(), 7, {}, program);
        EXPECT_TRUE(stateSet->getUniform(ShadingTexture::sampler));
        EXPECT_TRUE(stateSet->getTextureAttribute(7, osg::StateAttribute::TEXTURE));
    }
    expectSame(*stateSet, *before);
}

TEST(ShadingBinding, GivesBackWhatItReplaced)
{
    osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    stateSet->setTextureAttributeAndModes(1, new osg::Texture2D, osg::StateAttribute::ON);
    stateSet->setTextureAttributeAndModes(3, new osg::Texture2D,
                                          osg::StateAttribute::ON | osg::StateAttribute::OVERRIDE);
    stateSet->addUniform(new osg::Uniform(ShadingTexture::sampler, 4),
                         osg::StateAttribute::OVERRIDE);
    stateSet->addUniform(new osg::Uniform("theirs", 1.0f));
    stateSet->setAttributeAndModes(new osg::Program, osg::StateAttribute::PROTECTED);
    stateSet->setMode(GL_BLEND, osg::StateAttribute::ON);
    stateSet->setDataVariance(osg::Object::STATIC);
    const auto before = copyOf(*stateSet);
    for (unsigned unit : {0u, 1u, 3u, 9u})
    {
        {
            ShadingBinding binding(stateSet, shadingTexture(), unit, {}, new osg::Program);
            EXPECT_NE(stateSet->compare(*before, true), 0);
            const osg::ref_ptr<osg::Texture2DArray> gloss = new osg::Texture2DArray;
            binding.setGloss(gloss, ShadingTexture::glossUnit);
            EXPECT_EQ(stateSet->getTextureAttribute(ShadingTexture::glossUnit,
                                                    osg::StateAttribute::TEXTURE),
                      gloss);
            const osg::ref_ptr<osg::Texture2D> edges = shadingTexture();
            const auto edgeSampler = [&]
            {
                int found = -1;
                stateSet->getUniform(ShadingTexture::edgeSampler)->get(found);
                return static_cast<unsigned>(found);
            };
            EXPECT_EQ(edgeSampler(), unit); // a sampler2D, as that of the shading
            binding.setEdges(edges);
            EXPECT_EQ(edgeSampler(), ShadingTexture::edgeUnit);
            EXPECT_EQ(stateSet->getTextureAttribute(ShadingTexture::edgeUnit,
                                                    osg::StateAttribute::TEXTURE),
                      edges);
            if (unit == 3u)
            {
                binding.setEdges(nullptr);
                EXPECT_EQ(edgeSampler(), unit);
                EXPECT_FALSE(stateSet->getTextureAttribute(ShadingTexture::edgeUnit,
                                                           osg::StateAttribute::TEXTURE));
            }
            FormerLight former;
            former.shading = shadingTexture();
            former.edges = shadingTexture();
            const auto numberOf = [&](const char* name)
            {
                float found = -1.0f;
                stateSet->getUniform(name)->get(found);
                return found;
            };
            const auto unitOf = [&](const char* name)
            {
                int found = -1;
                stateSet->getUniform(name)->get(found);
                return static_cast<unsigned>(found);
            };
            EXPECT_EQ(unitOf(ShadingTexture::formerSampler), unit);
            EXPECT_EQ(unitOf(ShadingTexture::formerEdgeSampler), unit);
            EXPECT_EQ(numberOf(ShadingTexture::formerPart), 0.0f);
            if (unit != ShadingTexture::formerUnit) // TileFades leaves it alone
            {
                binding.setFormer(former, osg::Matrixd());
                EXPECT_EQ(numberOf(ShadingTexture::formerPart), 1.0f);
                EXPECT_EQ(unitOf(ShadingTexture::formerSampler), ShadingTexture::formerUnit);
                EXPECT_EQ(unitOf(ShadingTexture::formerEdgeSampler),
                          ShadingTexture::formerEdgeUnit);
                binding.setFade(0.25);
                EXPECT_EQ(numberOf(ShadingTexture::formerPart), 0.75f);
            }
            if (unit == 3u)
            {
                binding.setFade(1.0);
                EXPECT_EQ(numberOf(ShadingTexture::formerPart), 0.0f);
                EXPECT_EQ(unitOf(ShadingTexture::formerSampler), unit);
                for (const unsigned each :
                     {ShadingTexture::formerUnit, ShadingTexture::formerEdgeUnit})
                    EXPECT_FALSE(stateSet->getTextureAttribute(each, osg::StateAttribute::TEXTURE));
                EXPECT_EQ(former.shading->referenceCount(), 1);
            }
            if (unit == 1u) // taken off with the rest, and before it
                binding.setGloss(nullptr, ShadingTexture::glossUnit);
            EXPECT_EQ(stateSet->getDataVariance(), osg::Object::DYNAMIC);
        }
        expectSame(*stateSet, *before);
    }
}

TEST(ShadingBinding, LeavesWhatTheHostChangedMeanwhile)
{
    osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    osg::ref_ptr<osg::Texture2D> theirs = new osg::Texture2D;
    {
        ShadingBinding binding(stateSet, shadingTexture(), 7, {}, nullptr);
        stateSet->setTextureAttribute(7, theirs);
        stateSet->addUniform(new osg::Uniform("theirs", 1.0f));
    }
    EXPECT_EQ(stateSet->getTextureAttribute(7, osg::StateAttribute::TEXTURE), theirs);
    EXPECT_TRUE(stateSet->getUniform("theirs"));
    EXPECT_FALSE(stateSet->getUniform(ShadingTexture::sampler));
}

TEST(ShadingBinding, MapsPostsToTexelCentres)
{
    osg::ref_ptr<osg::StateSet> stateSet = new osg::StateSet;
    ShadingCoordinates coordinates;
    coordinates.source = ShadingCoordinates::Source::Vertex;
    coordinates.toTile = osg::Matrixd::scale(0.01, 0.02, 1.0);
    const ShadingBinding binding(stateSet, shadingTexture(), 7, coordinates, nullptr);
    osg::Matrixf matrix;
    ASSERT_TRUE(stateSet->getUniform(ShadingTexture::matrix)->get(matrix));
    // 5 x 3 texels: (u (W - 1) + 0.5) / W.
    const osg::Vec3f middle = osg::Vec3f(25.0f, 25.0f, 0.0f) * matrix;
    EXPECT_NEAR(middle.x(), (0.25 * 4 + 0.5) / 5, 1e-6);
    EXPECT_NEAR(middle.y(), (0.5 * 2 + 0.5) / 3, 1e-6);
}
