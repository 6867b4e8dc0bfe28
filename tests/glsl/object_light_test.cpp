#include "core/ConeSet.h"
#include "support/ConeLight.h"
#include "support/Precisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{

template <class Real>
class ObjectLightFunctions : public testing::Test
{
};
TYPED_TEST_SUITE(ObjectLightFunctions, Precisions);

constexpr double pi = 3.14159265358979323846;

/// An upright box that is turned about z, on the ground z = 0 or above it.
struct Box
{
    glm::dvec3 centre, half;
    double turn;

    glm::dvec3 toOwn(const glm::dvec3& v) const
    {
        const double c = std::cos(turn), s = std::sin(turn);
        return {c * v.x + s * v.y, c * v.y - s * v.x, v.z};
    }
    glm::dvec3 fromOwn(const glm::dvec3& v) const
    {
        const double c = std::cos(turn), s = std::sin(turn);
        return {c * v.x - s * v.y, c * v.y + s * v.x, v.z};
    }
    double distance(const glm::dvec3& place) const
    {
        const glm::dvec3 q = glm::abs(toOwn(place - centre)) - half;
        return glm::length(glm::max(q, glm::dvec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
    }
    /// By slabs: nothing of the code under test.
    bool stops(const glm::dvec3& place, const glm::dvec3& direction) const
    {
        const glm::dvec3 from = toOwn(place - centre), to = toOwn(direction);
        double first = 1.0e-9, last = 1.0e30;
        for (int axis = 0; axis < 3; ++axis)
        {
            const double a = (-half[axis] - from[axis]) / to[axis];
            const double b = (half[axis] - from[axis]) / to[axis];
            first = std::max(first, std::min(a, b));
            last = std::min(last, std::max(a, b));
        }
        return last > first;
    }
};
using Scene = std::vector<Box>;

constexpr double width = 32.0;
constexpr int voxels = 128;
constexpr double voxel = width / voxels;
constexpr double reach = 8.0 * voxel;

/// Houses, thin walls and slabs on posts, within 32 m; none is what the constants were fitted to.
Scene sceneOf(unsigned seed)
{
    std::mt19937 random(seed);
    const auto between = [&](double a, double b)
    { return a + (b - a) * (double(random() >> 5) / double(1u << 27)); };
    Scene scene;
    const int houses = 2 + int(random() % 5);
    for (int i = 0; i < houses; ++i)
    {
        const glm::dvec3 half(between(1, 3), between(1, 3), between(0.75, 3));
        scene.push_back({{between(7, 25), between(7, 25), half.z}, half, between(0, pi)});
    }
    for (unsigned i = 0; i < random() % 3; ++i)
    {
        const glm::dvec3 half(between(2, 5), between(0.15, 0.3), between(0.5, 1.5));
        scene.push_back({{between(8, 24), between(8, 24), half.z}, half, between(0, pi)});
    }
    for (unsigned i = 0; i < random() % 2; ++i)
    {
        const glm::dvec3 half(between(1.5, 3), between(1.5, 3), 0.25);
        scene.push_back({{between(8, 24), between(8, 24), between(2, 4)}, half, between(0, pi)});
    }
    return scene;
}

double distanceIn(const Scene& scene, const glm::dvec3& place)
{
    double distance = 1.0e30;
    for (const Box& box : scene)
        distance = std::min(distance, box.distance(place));
    return distance;
}

/// steps: that a distance is stored in, over the reach; 0: any.
template <class Real>
Volume<Real> volumeOf(const Scene& scene, double steps = 127.0)
{
    const int depth = 48;
    Volume<Real> volume(voxels, voxels, depth);
    for (int z = 0; z < depth; ++z)
        for (int y = 0; y < voxels; ++y)
            for (int x = 0; x < voxels; ++x)
            {
                const glm::dvec3 place = (glm::dvec3(x, y, z) + 0.5) * voxel;
                double stored = std::clamp(distanceIn(scene, place) / reach, -1.0, 1.0);
                if (steps > 0.0)
                    stored = std::round(stored * steps) / steps;
                volume.at(x, y, z) = Real(stored);
            }
    return volume;
}

template <class Real>
typename Glsl<Real>::DistanceField fieldOf(const Scene& scene)
{
    typename Glsl<Real>::DistanceField field;
    field.size = glm::vec<3, Real>(Real(width), Real(width), Real(48 * voxel));
    field.voxel = Real(voxel);
    field.reach = Real(reach);
    glm::dvec3 low(1.0e30), high(-1.0e30);
    for (const Box& box : scene)
        for (int corner = 0; corner < 8; ++corner)
        {
            const glm::dvec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            const glm::dvec3 place = box.centre + box.fromOwn(box.half * sign);
            low = glm::min(low, place);
            high = glm::max(high, place);
        }
    field.low = glm::vec<3, Real>(low);
    field.high = glm::vec<3, Real>(high);
    return field;
}

/// On the ground and on the boxes' faces, in the open.
std::vector<Receiver> receiversOf(const Scene& scene, int count, unsigned seed)
{
    std::mt19937 random(seed);
    const auto between = [&](double a, double b)
    { return a + (b - a) * (double(random() >> 5) / double(1u << 27)); };
    std::vector<Receiver> receivers;
    while (int(receivers.size()) < count)
    {
        Receiver receiver;
        if (receivers.size() % 2 == 0)
            receiver = {{between(4, 28), between(4, 28), 0.0}, {0, 0, 1}};
        else
        {
            const Box& box = scene[random() % scene.size()];
            const int face = int(random() % 5); // four walls, and the top
            glm::dvec3 own(between(-1, 1), between(-1, 1), between(-1, 1));
            glm::dvec3 normal(0.0);
            const int axis = face == 4 ? 2 : face / 2;
            own[axis] = face == 4 || face % 2 == 0 ? 1.0 : -1.0;
            normal[axis] = own[axis];
            receiver = {box.centre + box.fromOwn(own * box.half), box.fromOwn(normal)};
        }
        if (receiver.place.z >= 0.0 &&
            distanceIn(scene, receiver.place + receiver.normal * 1.0e-6) > 0.0)
            receivers.push_back(receiver);
    }
    return receivers;
}

/// Irradiance / pi by a sky of 1 above the horizontal: stratified rays, by the cosine's density.
/// The standard error of 64^2 strata is below 0.2 %.
double skyBy(const Scene& scene, const Receiver& receiver)
{
    constexpr int strata = 64;
    const glm::dvec3 side = glm::normalize(
        glm::cross(receiver.normal,
                   std::abs(receiver.normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 other = glm::cross(receiver.normal, side);
    int seen = 0;
    for (int i = 0; i < strata; ++i)
        for (int j = 0; j < strata; ++j)
        {
            const double r = std::sqrt((i + 0.5) / strata), turn = 2.0 * pi * (j + 0.5) / strata;
            const glm::dvec3 ray = side * (r * std::cos(turn)) + other * (r * std::sin(turn)) +
                                   receiver.normal * std::sqrt(1.0 - r * r);
            seen +=
                ray.z > 0.0 &&
                std::none_of(scene.begin(), scene.end(),
                             [&](const Box& box)
                             { return box.stops(receiver.place + receiver.normal * 1.0e-6, ray); });
        }
    return double(seen) / (strata * strata);
}

struct Errors
{
    double rms, p95, mean;
};

Errors errorsOf(const ConeSet& set, int scenes, double steps)
{
    std::vector<double> errors;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < scenes; ++i)
    {
        const Scene scene = sceneOf(100 + unsigned(i));
        const auto volume = volumeOf<double>(scene, steps);
        const auto field = fieldOf<double>(scene);
        for (const Receiver& receiver : receiversOf(scene, 60, 7 + unsigned(i)))
        {
            const double error = skyByCones(volume, field, receiver, set) - skyBy(scene, receiver);
            sum += error;
            squares += error * error;
            errors.push_back(std::abs(error));
        }
    }
    std::sort(errors.begin(), errors.end());
    const double count = double(errors.size());
    return {std::sqrt(squares / count), errors[std::size_t(0.95 * count)], sum / count};
}

} // namespace

// Asked: at most 4 % RMS of open level ground's light by default (16 cones), and 2.5 % at best, on
// scenes that the constants were not fitted to.
TEST(ObjectLight, SkyOnUnseenScenesIsWithinFourPercent)
{
    double last = 1.0;
    for (const int cones : {4, 6, 9, 12, 16, 32})
    {
        const Errors errors = errorsOf(ConeSet::of(cones), 16, 127.0);
        std::printf("%2d cones: RMS %.2f %%, 95th percentile %.2f %%, mean %+.2f %%\n", cones,
                    100.0 * errors.rms, 100.0 * errors.p95, 100.0 * errors.mean);
        EXPECT_LE(errors.rms, cones == 32 ? 0.025 : cones == 16 ? 0.04 : 1.0);
        EXPECT_LT(errors.rms, last) << "more cones must not err more";
        last = errors.rms;
    }
}

// 8 bits over 8 voxels to either side step by 1/16 of a voxel.
TEST(ObjectLight, EightBitsAreEnough)
{
    const ConeSet set = ConeSet::of(16);
    const Errors exact = errorsOf(set, 4, 0.0), stored = errorsOf(set, 4, 127.0);
    std::printf("RMS %.3f %% of exact distances, %.3f %% of 8 bits\n", 100.0 * exact.rms,
                100.0 * stored.rms);
    EXPECT_LT(std::abs(stored.rms - exact.rms), 0.002);
}

TEST(ObjectLight, WhereNothingIsSeenItIsExactlyWhole)
{
    const Scene scene = {{{16, 16, 1}, {1, 1, 1}, 0.3}};
    const auto volume = volumeOf<float>(scene);
    const auto field = fieldOf<float>(scene);
    const Receiver roof = {{16, 16, 2.0}, {0, 0, 1}};
    for (const int cones : {4, 6, 9, 12, 16, 32})
        EXPECT_EQ(skyByCones(volume, field, {{400, -300, 0}, {0, 0, 1}}, ConeSet::of(cones)), 1.0);
    EXPECT_GT(skyByCones(volume, field, roof, ConeSet::of(16)), 0.98);
}

TEST(ObjectLight, FloatIsAsGoodAsDouble)
{
    const Scene scene = sceneOf(3);
    const auto inFloat = volumeOf<float>(scene);
    const auto inDouble = volumeOf<double>(scene);
    const ConeSet set = ConeSet::of(16);
    // The same steps of 2^-24 along some 64 samples per cone; where they end one sample apart at
    // the box's edge, a cone differs by what the last sample adds.
    for (const Receiver& receiver : receiversOf(scene, 100, 5))
        EXPECT_NEAR(skyByCones(inFloat, fieldOf<float>(scene), receiver, set),
                    skyByCones(inDouble, fieldOf<double>(scene), receiver, set), 2.0e-3);
}

// Ground before a long wall 3 m high: the wall hides half of the sky at its foot, and sky in the
// angle atan(3 / d) at a distance d: light (1 + cos of that angle) / 2 of it where the wall is
// endless. This one is 24 m long; the rays know it. Cones are few, so what a wall takes depends on
// how it stands to them: it is turned. Asked: the 4 % of SkyOnUnseenScenesIsWithinFourPercent.
TEST(ObjectLight, BeforeAWallItIsDarkestAtTheFootAndHasNoHalo)
{
    const ConeSet set = ConeSet::of(16);
    const std::vector<double> distances = {0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0};
    constexpr int turns = 8;
    std::vector<double> truths(distances.size()), means(distances.size());
    std::vector<double> squares(distances.size()), worst(distances.size());
    for (int turn = 0; turn < turns; ++turn)
    {
        const double angle = pi * turn / turns;
        const Scene scene = {{{16, 16, 1.5}, {12, 0.25, 1.5}, angle}};
        const auto volume = volumeOf<double>(scene);
        const auto field = fieldOf<double>(scene);
        const glm::dvec3 ahead = scene[0].fromOwn({0, 1, 0});
        double last = 0.0;
        for (std::size_t i = 0; i < distances.size(); ++i)
        {
            const glm::dvec3 place = glm::dvec3(16, 16, 0) + ahead * (0.25 + distances[i]);
            const Receiver ground = {place, {0, 0, 1}};
            const double truth = skyBy(scene, ground);
            EXPECT_NEAR(truth, 0.5 * (1.0 + std::cos(std::atan(3.0 / distances[i]))), 0.02);
            const double light = skyByCones(volume, field, ground, set);
            truths[i] = truth;
            means[i] += light / turns;
            squares[i] += (light - truth) * (light - truth) / turns;
            worst[i] = std::max(worst[i], std::abs(light - truth));
            EXPECT_GT(light, last) << "light grows away from the wall";
            EXPECT_LT(light, 1.0) << "and never exceeds the open sky's";
            last = light;
        }
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < distances.size(); ++i)
    {
        std::printf("%.2f m: by rays %.3f, by cones %.3f, RMS %.1f %%, worst %.1f %%\n",
                    distances[i], truths[i], means[i], 100.0 * std::sqrt(squares[i]),
                    100.0 * worst[i]);
        sum += squares[i] / double(distances.size());
    }
    EXPECT_LE(std::sqrt(sum), 0.04);
}

namespace
{
CheckedGlsl<double>::DistanceField checkedFieldOf(const Scene& scene)
{
    const auto given = fieldOf<double>(scene);
    return {given.size, given.voxel, given.reach, given.low, given.high};
}
} // namespace

// The shadow of a box 3 m high under a sun of 45 degrees ends 3 m behind it.
TEST(ObjectLight, TheSunsShadowEndsWithinAVoxel)
{
    CheckedGlsl<double> glsl;
    const Scene scene = {{{16, 16, 1.5}, {2, 2, 1.5}, 0.0}};
    const auto volume = volumeOf<double>(scene);
    const auto field = checkedFieldOf(scene);
    const double sine = std::sin(0.2666 * pi / 180.0);
    const glm::dvec3 up(0, 0, 1), sun = glm::normalize(glm::dvec3(1, 0, 1));
    const auto seen = [&](const glm::dvec3& place)
    { return glsl.discAmongObjects(volume, field, place, up, sun, sine, 1.0e30); };
    // The sun stands in the east; the box's western face is at x = 14.
    double edge = 14.0;
    while (edge > 5.0 && seen({edge - 0.005, 16, 0}) < 0.5)
        edge -= 0.005;
    EXPECT_NEAR(edge, 11.0, voxel);
    for (double x = edge + voxel; x < 14.0 - voxel; x += 0.1)
        EXPECT_LT(seen({x, 16, 0}), 0.01) << x;
    for (double x = 5.0; x < edge - voxel; x += 0.1)
        EXPECT_GT(seen({x, 16, 0}), 0.99) << x;
    EXPECT_EQ(seen({25, 16, 0}), 1.0);
    EXPECT_EQ(seen({16, 4, 0}), 1.0);
    EXPECT_GT(glsl.discAmongObjects(volume, field, {16, 16, 3}, up, sun, sine, 1.0e30), 0.99)
        << "roof";
}

// The axes that are turned from +z stay unit vectors at the same angle from the normal.
TYPED_TEST(ObjectLightFunctions, ConesTurnRigidlyAboutTheNormal)
{
    CheckedGlsl<TypeParam> glsl;
    using vec3 = typename CheckedGlsl<TypeParam>::vec3;
    std::mt19937 random(1);
    const auto unit = [&]
    {
        std::normal_distribution<double> normal;
        return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    };
    for (int i = 0; i < 200; ++i)
    {
        const glm::dvec3 direction = unit(), normal = unit();
        const vec3 turned = glsl.aboutNormal(vec3(direction), vec3(normal));
        // 1 / (1 + z) magnifies the rounding near the nadir: there were none below -0.999.
        ASSERT_GT(normal.z, -0.999);
        const double room = 64.0 * roundoff<TypeParam> / (1.0 + normal.z);
        EXPECT_NEAR(glm::length(glm::dvec3(turned)), 1.0, room);
        EXPECT_NEAR(glm::dot(glm::dvec3(turned), normal), direction.z, room);
    }
    EXPECT_EQ(glsl.aboutNormal(vec3(1, 0, 0), vec3(0, 0, 1)), vec3(1, 0, 0));
}

TEST(ConeSets, ShareTheHemisphereByTheCosine)
{
    for (const int count : {4, 6, 9, 12, 16, 32})
    {
        const ConeSet set = ConeSet::of(count);
        ASSERT_EQ(int(set.cones.size()), count);
        double sum = 0.0;
        for (std::size_t i = 0; i < set.cones.size(); ++i)
        {
            const auto& axis = set.cones[i].axis;
            EXPECT_NEAR(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2], 1.0f, 1e-6f);
            EXPECT_TRUE(set.cones[i].around >> i & 1u) << "a cone is its own neighbour";
            sum += double(axis[2]);
        }
        // Cells of equal cosine measure: the mean cosine of that measure is 2/3; a ring's axis
        // stands in the middle of its measure, so the sum is a midpoint rule for it.
        EXPECT_NEAR(sum / count, 2.0 / 3.0, 0.05);
    }
    EXPECT_EQ(ConeSet::of(10).cones.size(), 12u);
    EXPECT_EQ(ConeSet::of(99).cones.size(), 32u);
    // The table of docs/methods/objects.md, as published with the constants: 1 + 6 + 9.
    const ConeSet set = ConeSet::of(16);
    EXPECT_NEAR(set.cones[0].sine, 0.201f, 5.0e-4f);
    EXPECT_NEAR(set.cones[1].sine, 0.215f, 5.0e-4f);
    EXPECT_NEAR(set.cones[7].sine, 0.323f, 5.0e-4f);
    EXPECT_NEAR(std::acos(double(set.cones[1].axis[2])) * 180.0 / pi, 30.0, 0.05);
    EXPECT_NEAR(std::acos(double(set.cones[7].axis[2])) * 180.0 / pi, 58.0, 0.05);
}

// With nothing in the way. Expected: by 400 x 400 directions of the sphere, those above the
// surface's horizon, with the cosine.
TEST(ObjectLight, OfALampIsThatOfASphere)
{
    CheckedGlsl<double> glsl;
    const Scene scene = {{{16, 16, 20.0}, {0.5, 0.5, 0.5}, 0.0}};
    const auto volume = volumeOf<double>(scene);
    const auto field = checkedFieldOf(scene);
    const glm::dvec3 place(16, 16, 1), normal(0, 0, 1);
    for (const double away : {1.5, 3.0, 8.0})
        for (const double elevation : {-20.0, -5.0, 0.0, 5.0, 20.0, 60.0, 90.0})
        {
            constexpr double radius = 0.5;
            const double up = elevation * pi / 180.0, sine = radius / away;
            const glm::dvec3 axis(std::cos(up), 0.0, std::sin(up));
            const glm::dvec3 other(-axis.z, 0.0, axis.x), third(0.0, 1.0, 0.0);
            const double depth = 1.0 - std::sqrt(1.0 - sine * sine); // 1 - cosine of its edge
            double expected = 0.0;
            constexpr int strata = 400;
            for (int i = 0; i < strata; ++i)
                for (int j = 0; j < strata; ++j)
                {
                    const double along = 1.0 - depth * (i + 0.5) / strata;
                    const double across = std::sqrt(1.0 - along * along);
                    const double turn = 2.0 * pi * (j + 0.5) / strata;
                    const glm::dvec3 ray =
                        axis * along + across * (other * std::cos(turn) + third * std::sin(turn));
                    expected += std::max(ray.z, 0.0);
                }
            expected *= 2.0 * depth / (strata * strata); // solid angle 2 pi depth, over pi
            const double found =
                glsl.lampAmongObjects(volume, field, place, normal, place + away * axis, radius);
            EXPECT_NEAR(found, expected, 0.02 * sine * sine * sine + 1.0e-4 * sine * sine)
                << away << " m, " << elevation << " degrees";
        }
    EXPECT_EQ(glsl.lampAmongObjects(volume, field, place, normal, place, 0.5), 0.0) << "itself";
}
