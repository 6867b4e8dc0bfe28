#include "fields/ObjectShape.h"
#include "fields/SampledForm.h"
#include "glsl_host.h"
#include "support/SampledBodies.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>

using namespace osgTerrainLight;

namespace
{

glm::dvec3 directionOf(const SampledForm& form, int x, int y)
{
    return Glsl<double>().octahedronDirection((glm::dvec2(x, y) + 0.5) * (2.0 / form.side) - 1.0);
}

/// A sheet z = height(x, y) over from … to along both axes.
TriangleMesh sheet(double from, double to, const std::function<double(double, double)>& height,
                   int cells = 16)
{
    TriangleMesh mesh;
    for (int y = 0; y <= cells; ++y)
        for (int x = 0; x <= cells; ++x)
        {
            const glm::dvec2 at = from + (to - from) / cells * glm::dvec2(x, y);
            mesh.vertices.emplace_back(at.x, at.y, height(at.x, at.y));
        }
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x)
        {
            const auto a = std::uint32_t(x + (cells + 1) * y), b = a + 1,
                       c = b + std::uint32_t(cells) + 1, d = c - 1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

} // namespace

// A ball whose triangles are 3.75 degrees wide lies within it by at most 0.11 %: 1 - cos of half
// that along both angles.
TEST(SampledForm, RadiiAreThoseOfTheMesh)
{
    TriangleMesh mesh = bodies::Blob{0.0, 0.0, 2.0}.mesh();
    for (glm::vec3& vertex : mesh.vertices)
        vertex += glm::vec3(100.0f, -50.0f, 7.0f);
    const auto form = sampleStar(mesh);
    ASSERT_TRUE(form);
    EXPECT_LT(glm::distance(form->centre, glm::dvec3(100, -50, 7)), 1.0e-4);
    ASSERT_EQ(form->values.width(), SampledForm::starSide);
    ASSERT_EQ(form->values.height(), SampledForm::starSide);
    for (const float radius : form->values.values())
    {
        EXPECT_LT(radius, 2.00002f);
        EXPECT_GT(radius, 2.0f * (1.0f - 0.0012f));
    }
    EXPECT_NEAR(form->range.x, 2.0, 0.002);
    EXPECT_NEAR(form->range.y, 2.0, 0.002);
    EXPECT_LT(glm::distance(form->high, glm::dvec3(2)), 1.0e-4);
    EXPECT_LT(glm::distance(form->low, glm::dvec3(-2)), 1.0e-4);
}

// In each direction the farthest surface, whichever way round its triangles run.
TEST(SampledForm, RadiiHaveNoGapsAndTakeTheOutermost)
{
    for (const bool isMirrored : {false, true})
    {
        const bodies::Blob blob{0.15, 1.0, 2.0};
        TriangleMesh mesh = blob.mesh(96);
        if (isMirrored)
            for (auto& triangle : mesh.triangles)
                std::swap(triangle[0], triangle[1]);
        const TriangleMesh inner = bodies::Blob{0.0, 0.0, 0.5}.mesh(8);
        const auto first = std::uint32_t(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
        for (const auto& triangle : inner.triangles)
            mesh.triangles.push_back(
                {triangle[0] + first, triangle[1] + first, triangle[2] + first});
        const auto form = sampleStar(mesh);
        ASSERT_TRUE(form);
        for (int y = 0; y < form->side; ++y)
            for (int x = 0; x < form->side; ++x)
            {
                const glm::dvec3 place =
                    form->centre + double(form->values.at(x, y)) * directionOf(*form, x, y);
                EXPECT_NEAR(glm::length(place), blob.radius(glm::normalize(place)), 0.01);
            }
    }
}

// A saucer whose rim bends up: from the middle of its box more of its surface is seen from outside.
TEST(SampledForm, ACentreSeesTheWholeSurface)
{
    TriangleMesh mesh = bodies::Blob{0.0, 0.0, 1.0}.mesh(24);
    for (glm::vec3& vertex : mesh.vertices)
        vertex = glm::vec3(2.0f * vertex.x, 0.7f * vertex.y,
                           0.5f * vertex.z + 0.35f * 4.0f * vertex.x * vertex.x);
    const auto form = sampleStar(mesh);
    ASSERT_TRUE(form);
    double worst = 1.0e30;
    for (const auto& triangle : mesh.triangles)
    {
        const glm::dvec3 a(mesh.vertices[triangle[0]]), b(mesh.vertices[triangle[1]]),
            c(mesh.vertices[triangle[2]]);
        const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
        worst = std::min(worst, glm::dot(normal, a - form->centre));
    }
    double ofMiddle = 1.0e30;
    for (const auto& triangle : mesh.triangles)
    {
        const glm::dvec3 a(mesh.vertices[triangle[0]]), b(mesh.vertices[triangle[1]]),
            c(mesh.vertices[triangle[2]]);
        const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
        ofMiddle =
            std::min(ofMiddle, glm::dot(normal, a - form->centre - 0.5 * (form->low + form->high)));
    }
    EXPECT_LT(ofMiddle, 0.0) << "the test is for where the middle does not";
    EXPECT_GT(worst, ofMiddle);
}

TEST(SampledForm, WhereAMeshIsOpenItsRadiusGoesOn)
{
    TriangleMesh mesh = bodies::Blob{0.0, 0.0, 2.0}.mesh();
    mesh.triangles.resize(mesh.triangles.size() * 3 / 4);
    const auto form = sampleStar(mesh);
    ASSERT_TRUE(form);
    for (const float radius : form->values.values())
        EXPECT_GT(radius, 0.5f);
    EXPECT_FALSE(sampleStar({}));
    TriangleMesh line;
    line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    line.triangles = {{0, 1, 2}};
    EXPECT_FALSE(sampleStar(line));
}

// An inclined sheet, exact but for floats; its first posts are its corners.
TEST(SampledForm, HeightsAreThoseOfTheMesh)
{
    const auto height = [](double x, double y) { return 3.0 + 0.5 * x - 0.25 * y; };
    const auto form = sampleHeights(sheet(10.0, 14.0, height), HeightSurfaces::Upper);
    ASSERT_TRUE(form);
    EXPECT_NEAR(form->centre.x + form->first.x, 10.0, 1.0e-5);
    EXPECT_NEAR(form->spacing.x * (form->side - 1), 4.0, 1.0e-5);
    const double lowest = height(10.0, 14.0);
    for (int y = 0; y < form->side; ++y)
        for (int x = 0; x < form->side; ++x)
        {
            const glm::dvec2 at =
                glm::dvec2(form->centre) + form->first + form->spacing * glm::dvec2(x, y);
            EXPECT_NEAR(double(form->values.at(x, y)) + form->centre.z, height(at.x, at.y), 1.0e-4);
            EXPECT_NEAR(double(form->values.at(x, form->side + y)) + form->centre.z, lowest,
                        1.0e-4);
        }
}

TEST(SampledForm, TwoHeightFieldsAreTheOutermostSurfaces)
{
    const bodies::Mound rock{2.0, 1.0, 3.0, true};
    const auto form = sampleHeights(rock.mesh(128), HeightSurfaces::Both);
    ASSERT_TRUE(form);
    int empty = 0;
    for (int y = 0; y < form->side; ++y)
        for (int x = 0; x < form->side; ++x)
        {
            const glm::dvec2 at =
                glm::dvec2(form->centre) + form->first + form->spacing * glm::dvec2(x, y);
            const double upper = double(form->values.at(x, y)) + form->centre.z;
            const double lower = double(form->values.at(x, form->side + y)) + form->centre.z;
            if (glm::length(at) > rock.size + 1.0e-4)
            {
                EXPECT_GT(lower, upper) << "nothing is solid";
                ++empty;
            }
            else if (glm::length(at) < 0.95 * rock.size)
            {
                // Triangles of 2.3 cm on forms whose radius of curvature is above 0.2 m.
                EXPECT_NEAR(upper, rock.top(at.x, at.y), 0.005);
                EXPECT_NEAR(lower, rock.bottom(at.x, at.y), 0.005);
            }
        }
    EXPECT_GT(empty, form->side);
    // A wall has no upper side.
    TriangleMesh wall;
    wall.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}};
    wall.triangles = {{0, 1, 2}};
    EXPECT_FALSE(sampleHeights(wall, HeightSurfaces::Both));
    EXPECT_FALSE(sampleHeights({}, HeightSurfaces::Upper));
}

TEST(SampledForm, ItsBoundsAreThoseOfTheBody)
{
    ObjectShape shape;
    shape.kind = ObjectShape::Kind::Star;
    shape.form = sampleStar(bodies::Blob{0.0, 0.0, 1.5}.mesh());
    shape.toScene = glm::scale(glm::translate(glm::dmat4(1.0), {5, 6, 7}), glm::dvec3(2.0));
    const ObjectBounds bounds = boundsOf(shape);
    EXPECT_LT(glm::distance(bounds.low, glm::dvec3(2, 3, 4)), 1.0e-3);
    EXPECT_LT(glm::distance(bounds.high, glm::dvec3(8, 9, 10)), 1.0e-3);
    EXPECT_NEAR(rigid(shape).scale, 2.0, 1.0e-12);
}

// What a form that deforms costs the processor in every frame.
TEST(SampledForm, DISABLED_Times)
{
    const auto time = [](const char* what, const TriangleMesh& mesh, const auto& sample)
    {
        constexpr int rounds = 50;
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < rounds; ++i)
            ASSERT_TRUE(sample(mesh));
        std::printf(
            "%-8s %6zu triangles: %.2f ms\n", what, mesh.triangles.size(),
            1000.0 / rounds *
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    };
    for (const int rows : {24, 48, 96})
    {
        time("star", bodies::Blob{0.3, 1.0, 2.5}.mesh(rows),
             [](const TriangleMesh& mesh) { return sampleStar(mesh); });
        time("heights", bodies::Mound{2.0, 1.0, 3.0, true}.mesh(rows),
             [](const TriangleMesh& mesh) { return sampleHeights(mesh, HeightSurfaces::Both); });
    }
}
