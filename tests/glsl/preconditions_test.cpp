#include "support/Precisions.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;

namespace
{
template <class Real>
class PreconditionsDeathTest : public testing::Test
{
};
TYPED_TEST_SUITE(PreconditionsDeathTest, Precisions);
} // namespace

// The message is the condition as the shader file states it.
TYPED_TEST(PreconditionsDeathTest, ABrokenOneEndsTheProgram)
{
    CheckedGlsl<TypeParam> glsl;
    using real = TypeParam;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    EXPECT_DEATH(glsl.planeZenithAngle(real(0), real(1)),
                 "sky.glsl.*'nz > real.0.0.' does not hold");
    EXPECT_DEATH(glsl.mirrored(vec3(0, 0, 2), vec3(0, 0, 1)), "surface.glsl.*isUnit.direction.");
    EXPECT_DEATH(glsl.elevationOfCode(real(1.1)), "angle.glsl.*code <= real.1.0.");
}

TYPED_TEST(PreconditionsDeathTest, AKeptOneDoesNot)
{
    CheckedGlsl<TypeParam> glsl;
    using real = TypeParam;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    EXPECT_EQ(glsl.planeZenithAngle(real(1), real(0)), glsl.HALF_PI);
    EXPECT_EQ(glsl.mirrored(vec3(0, 0, 1), vec3(0, 0, 1)), vec3(0, 0, 1));
}
