#include "support/Precisions.h"

#include <osgTerrainLight/HorizonMap.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;

template <class Real>
class AngleFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(AngleFunctions, Precisions);

/// The 16-bit code that a unorm texture stores for a value.
template <class Real>
int stored(Real code)
{
    return static_cast<int>(std::lround(static_cast<double>(code) * 65535.0));
}

template <class Real>
Real codeValue(int code)
{
    return static_cast<Real>(code) / Real(65535);
}
} // namespace

TYPED_TEST(AngleFunctions, ConstantsArePi)
{
    using G = CheckedGlsl<TypeParam>;
    EXPECT_EQ(G::PI, static_cast<TypeParam>(pi));
    EXPECT_EQ(G::HALF_PI, static_cast<TypeParam>(pi / 2.0));
}

TYPED_TEST(AngleFunctions, ElevationIsTheArcTangent)
{
    CheckedGlsl<TypeParam> glsl;
    // 2e-8 of the polynomial, and of rounding: the quotient, π/2, the last difference (in 1 … 2:
    // one roundoff each) and the polynomial's own, which weighs 0.2 at most.
    const double bound = 2e-8 + 4.0 * roundoff<TypeParam>;
    for (int i = -30 * 64; i <= 30 * 64; ++i)
        for (const double sign : {1.0, -1.0})
        {
            const TypeParam slope = static_cast<TypeParam>(sign * std::exp2(i / 64.0));
            ASSERT_NEAR(static_cast<double>(glsl.elevationOfSlope(slope)),
                        std::atan(static_cast<double>(slope)), bound)
                << "slope " << slope;
        }
}

TYPED_TEST(AngleFunctions, ElevationIsExactWhereItMustBe)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    EXPECT_EQ(glsl.elevationOfSlope(TypeParam(0)), TypeParam(0));
    EXPECT_EQ(glsl.elevationOfSlope(TypeParam(1e30)), G::HALF_PI);
    EXPECT_EQ(glsl.elevationOfSlope(TypeParam(-1e30)), -G::HALF_PI);
    EXPECT_EQ(glsl.elevationOfSlope(std::numeric_limits<TypeParam>::infinity()), G::HALF_PI);
    // Small slopes keep their relative precision: the cubic term is below a roundoff here.
    for (const double size : {1e-5, 1e-12, 1e-30})
    {
        const TypeParam slope = static_cast<TypeParam>(size);
        EXPECT_NEAR(static_cast<double>(glsl.elevationOfSlope(slope) / slope), 1.0,
                    2.0 * roundoff<TypeParam> + size * size);
    }
    for (const double size : {0.3, 0.99, 1.0, 1.01, 17.0})
    {
        const TypeParam slope = static_cast<TypeParam>(size);
        EXPECT_EQ(glsl.elevationOfSlope(-slope), -glsl.elevationOfSlope(slope));
    }
}

TYPED_TEST(AngleFunctions, LevelIsCode32768AndNothingAheadIsCode1)
{
    using G = CheckedGlsl<TypeParam>;
    G glsl;
    EXPECT_EQ(stored(glsl.codeOfElevation(TypeParam(0))), HorizonMap::levelCode);
    EXPECT_EQ(glsl.codeOfElevation(TypeParam(0)), codeValue<TypeParam>(32768));
    EXPECT_EQ(stored(glsl.codeOfElevation(glsl.elevationOfSlope(G::NO_HORIZON))), 1);
    EXPECT_EQ(stored(G::VOID_CODE), HorizonMap::voidCode);
    for (const double beyond : {1.0, 1.001, 2.0, 1e6})
    {
        const TypeParam up = static_cast<TypeParam>(pi / 2.0 * beyond);
        EXPECT_EQ(stored(glsl.codeOfElevation(up)), 65535);
        EXPECT_EQ(stored(glsl.codeOfElevation(-up)), 1);
    }
}

TYPED_TEST(AngleFunctions, EveryCodeComesBack)
{
    CheckedGlsl<TypeParam> glsl;
    for (int code = 1; code <= 65535; ++code)
    {
        const TypeParam elevation = glsl.elevationOfCode(codeValue<TypeParam>(code));
        ASSERT_EQ(stored(glsl.codeOfElevation(elevation)), code);
    }
}

TYPED_TEST(AngleFunctions, CodesAreThoseOfHorizonMap)
{
    CheckedGlsl<TypeParam> glsl;
    // code·65535 is rounded twice, at most 65535 large; then the product.
    const double steps = 3.0 * 65535.0 * roundoff<TypeParam>;
    const double step = pi / 2.0 / 32767.0;
    for (int code = 1; code <= 65535; code += 7)
    {
        const double degrees = HorizonMap::decode(static_cast<std::uint16_t>(code));
        ASSERT_NEAR(static_cast<double>(glsl.elevationOfCode(codeValue<TypeParam>(code))),
                    degrees * pi / 180.0, (steps + 32767.0 * 3.0 * roundoff<TypeParam>)*step);
        // Within half a step, less the 0.006 steps that float rounds 32767 by.
        for (const double off : {-0.49, 0.49})
        {
            const double elevation = degrees + off * 90.0 / 32767.0;
            ASSERT_EQ(stored(glsl.codeOfElevation(static_cast<TypeParam>(elevation * pi / 180.0))),
                      HorizonMap::encode(elevation))
                << "code " << code << " " << off;
        }
    }
}

TYPED_TEST(AngleFunctions, CodesNeverFall)
{
    CheckedGlsl<TypeParam> glsl;
    int last = 0;
    for (int i = -200000; i <= 200000; ++i)
    {
        const int code =
            stored(glsl.codeOfElevation(static_cast<TypeParam>(i / 200000.0 * pi / 2.0)));
        ASSERT_GE(code, last);
        last = code;
    }
    EXPECT_EQ(last, 65535);
}
