#include "support/DirectLevels.h"

#include "core/Reach.h"

#include "core/AzimuthSet.h"
#include "core/MemorySource.h"
#include "core/SyntheticTerrain.h"
#include "reference/ExhaustiveHorizon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

using namespace osgTerrainLight;

namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double spacing = 30.0;
constexpr int all = 1 << 20; ///< a ring that no coarser level is needed beyond

/// Ground of one height with the same horizon all around.
Reach flatReach(const PostRect& place, double height, double horizonDegrees,
                const ReachScheme& scheme)
{
    DemTile tile(place.width, place.height, spacing);
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
            tile.setHeight(column, row, static_cast<float>(height));
    HorizonMap horizons(place.width, place.height, 32);
    for (std::uint16_t& code : horizons.codes())
        code = HorizonMap::encode(horizonDegrees);
    return Reach(tile, place, horizons, scheme);
}

TerrainEdit tower(int column, int row, double top)
{
    TerrainEdit edit;
    edit.posts = {column, row, 1, 1};
    edit.tops = {top};
    return edit;
}

/// The whole terrain in tiles that share their edges, with the exact horizons of every post.
class World
{
public:
    World(DemTile terrain, int tilePosts, int azimuths)
        : _terrain(std::move(terrain)), _azimuths(azimuths)
    {
        _horizons.resize(static_cast<std::size_t>(azimuths) * _terrain.postCount());
        reference::HorizonOptions options;
        options.highest = reference::highestPost(_terrain);
        for (int azimuth = 0; azimuth < azimuths; ++azimuth)
            for (int row = 0; row < _terrain.height(); ++row)
                for (int column = 0; column < _terrain.width(); ++column)
                    _horizons[index(azimuth, column, row)] = exact(azimuth, column, row, options);
        ReachScheme scheme;
        scheme.ring = all;
        scheme.always = 1; // no more than the surface between posts: the bound alone is tested
        for (int row = 0; row + 1 < _terrain.height(); row += tilePosts)
            for (int column = 0; column + 1 < _terrain.width(); column += tilePosts)
            {
                const PostRect place{column, row, tilePosts + 1, tilePosts + 1};
                _places.push_back(place);
                _reaches.push_back(reachOf(place, scheme));
            }
    }

    DemTile& terrain() { return _terrain; }
    std::size_t tileCount() const { return _places.size(); }
    const std::vector<PostRect>& places() const { return _places; }

    std::vector<bool> reached(const TerrainEdit& edit) const
    {
        std::vector<bool> set;
        for (const Reach& reach : _reaches)
            set.push_back(reach.isReached(edit));
        return set;
    }

    /// By how much the horizons of tiles differ from those of the start, after an edit of `posts`
    /// [degrees]; a tile with a changed post is taken as wholly changed.
    std::vector<double> changes(const PostRect& posts) const
    {
        std::vector<double> changes(_places.size(), 0.0);
        for (std::size_t i = 0; i < _places.size(); ++i)
            if (!_places[i].clippedTo(posts).empty())
                changes[i] = 90.0;
        reference::HorizonOptions options;
        options.highest = reference::highestPost(_terrain);
        for (int azimuth = 0; azimuth < _azimuths.count(); ++azimuth)
            for (int row = 0; row < _terrain.height(); ++row)
                for (int column = 0; column < _terrain.width(); ++column)
                {
                    if (posts.contains(column, row) || !_terrain.isValid(column, row) ||
                        !meets(posts, azimuth, column, row))
                        continue;
                    const double change = std::abs(exact(azimuth, column, row, options) -
                                                   _horizons[index(azimuth, column, row)]);
                    if (change > 0.0)
                        for (std::size_t i = 0; i < _places.size(); ++i)
                            if (_places[i].contains(column, row))
                                changes[i] = std::max(changes[i], change);
                }
        return changes;
    }

private:
    std::size_t index(int azimuth, int column, int row) const
    {
        return static_cast<std::size_t>(azimuth) * _terrain.postCount() +
               static_cast<std::size_t>(row * _terrain.width() + column);
    }

    double exact(int azimuth, int column, int row, const reference::HorizonOptions& options) const
    {
        return std::max(0.0, reference::exhaustiveHorizon(_terrain, column, row,
                                                          _azimuths.direction(azimuth), options)
                                 .elevationDegrees());
    }

    /// Whether a post's ray enters the rectangle and the cells around it.
    bool meets(const PostRect& posts, int azimuth, int column, int row) const
    {
        const MapDirection ray = _azimuths.direction(azimuth);
        double from = 0.0;
        double to = 1e9;
        const auto clip = [&from, &to](double first, double last, double step)
        {
            if (step == 0.0)
            {
                if (first > 0.0 || last < 0.0)
                    to = -1.0;
                return;
            }
            from = std::max(from, std::min(first / step, last / step));
            to = std::min(to, std::max(first / step, last / step));
        };
        clip(posts.column - 1.01 - column, posts.endColumn() + 0.01 - column, ray.east);
        clip(posts.row - 1.01 - row, posts.endRow() + 0.01 - row, ray.north);
        return from <= to;
    }

    Reach reachOf(const PostRect& place, const ReachScheme& scheme) const
    {
        DemTile tile(place.width, place.height, _terrain.northSpacing);
        HorizonMap horizons(place.width, place.height, _azimuths.count());
        for (int row = 0; row < place.height; ++row)
            for (int column = 0; column < place.width; ++column)
            {
                if (!_terrain.isValid(place.column + column, place.row + row))
                    continue;
                tile.setHeight(column, row,
                               _terrain.heightAt(place.column + column, place.row + row));
                for (int azimuth = 0; azimuth < _azimuths.count(); ++azimuth)
                    horizons.codes()[static_cast<std::size_t>(
                        (azimuth * place.height + row) * place.width + column)] =
                        HorizonMap::encode(
                            _horizons[index(azimuth, place.column + column, place.row + row)]);
            }
        return Reach(tile, place, horizons, scheme);
    }

    DemTile _terrain;
    AzimuthSet _azimuths;
    std::vector<double> _horizons;
    std::vector<PostRect> _places;
    std::vector<Reach> _reaches;
};

enum class EditKind
{
    Raise,
    Lower,
    Pits,
    Spikes,
    Hole
};
constexpr int kinds = 5;

/// An edit of 1 post to a quarter of a tile, by 0.5 to 10 times the spacing.
PostRect makeEdit(DemTile& terrain, int tilePosts, EditKind kind, std::mt19937& random)
{
    const auto uniform = [&random](double from, double to)
    { return from + (to - from) * (static_cast<double>(random()) / 4294967296.0); };
    const int longest = tilePosts / 2;
    PostRect posts;
    posts.width = static_cast<int>(std::exp(uniform(0.0, std::log(longest + 0.999))));
    posts.height = static_cast<int>(std::exp(uniform(0.0, std::log(longest + 0.999))));
    posts.column = static_cast<int>(uniform(0.0, terrain.width() - posts.width + 0.999));
    posts.row = static_cast<int>(uniform(0.0, terrain.height() - posts.height + 0.999));
    const double amount = spacing * 0.5 * std::exp(uniform(0.0, std::log(20.0)));
    for (int row = posts.row; row < posts.endRow(); ++row)
        for (int column = posts.column; column < posts.endColumn(); ++column)
        {
            const bool one = (column - posts.column) % 3 == 0 && (row - posts.row) % 3 == 0;
            const float height = terrain.heightAt(column, row);
            const float by = static_cast<float>(amount);
            if (kind == EditKind::Hole)
                terrain.setVoid(column, row);
            else if (kind == EditKind::Raise || (kind == EditKind::Spikes && one))
                terrain.setHeight(column, row, height + by);
            else if (kind == EditKind::Lower || (kind == EditKind::Pits && one))
                terrain.setHeight(column, row, height - by);
        }
    return posts;
}

/// Size of the sets of 50 edits, as parts of all tiles.
struct SetSizes
{
    double changed = 0.0;
    double reached = 0.0;
};

SetSizes checkRandomEdits(TerrainKind kind)
{
    constexpr int tilePosts = 32;
    constexpr int posts = 8 * tilePosts + 1;
    constexpr int edits = 50;
    std::mt19937 random(1414);
    // Blocks stand on the terrain, and some edits remove one: what was high is no more.
    const DemTile bare = *generateTerrain(kind, posts, posts, spacing, 14);
    DemTile original = bare;
    std::vector<PostRect> blocks;
    for (int i = 0; i < 20; ++i)
        blocks.push_back(makeEdit(original, tilePosts / 4, EditKind::Raise, random));
    const Raster<float> before = heightsOf(original);
    World world(original, tilePosts, 16);
    SetSizes sizes;
    double worst = 0.0;
    for (int i = 0; i < edits; ++i)
    {
        PostRect changed;
        if (i % (kinds + 1) == kinds)
        {
            changed = blocks[static_cast<std::size_t>(i / (kinds + 1))];
            for (int row = changed.row; row < changed.endRow(); ++row)
                for (int column = changed.column; column < changed.endColumn(); ++column)
                    world.terrain().setHeight(column, row, bare.heightAt(column, row));
        }
        else
            changed = makeEdit(world.terrain(), tilePosts, static_cast<EditKind>(i % (kinds + 1)),
                               random);
        const std::vector<bool> set = world.reached(
            terrainEdit(changed, {0, 0, posts, posts}, before, heightsOf(world.terrain())));
        const std::vector<double> changes = world.changes(changed);
        for (std::size_t tile = 0; tile < set.size(); ++tile)
        {
            const double part = 1.0 / static_cast<double>(edits * set.size());
            sizes.changed += changes[tile] > Reach::tolerance ? part : 0.0;
            sizes.reached += set[tile] ? part : 0.0;
            if (!set[tile])
                worst = std::max(worst, changes[tile]);
            EXPECT_TRUE(set[tile] || changes[tile] <= Reach::tolerance)
                << toString(kind) << ", edit " << i << ", tile " << tile << " changes by "
                << changes[tile];
        }
        world.terrain() = original;
    }
    const auto tiles = [&world](double part) { return part * double(world.tileCount()); };
    std::printf("%s: of %d tiles %.1f really change, %.1f are lit again; beyond them at most "
                "%.4f degrees\n",
                toString(kind), static_cast<int>(world.tileCount()), tiles(sizes.changed),
                tiles(sizes.reached), worst);
    return sizes;
}
} // namespace

// Every post of every tile, before and after 50 edits: no tile out of reach changes by more than
// 0.01 degrees, and reach is a small part of all.
TEST(Reach, HoldsAllThatRandomEditsChangeOnFractal)
{
    const SetSizes sizes = checkRandomEdits(TerrainKind::Fractal);
    EXPECT_LT(sizes.reached, 0.6);
    EXPECT_GT(sizes.changed, 0.1);
}

TEST(Reach, HoldsAllThatRandomEditsChangeOnCliffs)
{
    EXPECT_LT(checkRandomEdits(TerrainKind::Cliffs).reached, 0.7);
}

TEST(Reach, HoldsAllThatRandomEditsChangeInACrater)
{
    EXPECT_LT(checkRandomEdits(TerrainKind::Crater).reached, 0.7);
}

// The surface between a changed post and a higher one changes up to the higher one. A spike behind
// a ridge, whose flank is filled: the post that changes is hidden by the ridge, before and after.
TEST(Reach, AFlankCountsUpToItsSpike)
{
    constexpr int posts = 65;
    DemTile terrain(posts, posts, spacing);
    for (int row = 0; row < posts; ++row)
        for (int column = 0; column < posts; ++column)
            terrain.setHeight(column, row, column == 28 ? 100.0f : 0.0f);
    terrain.setHeight(40, 32, 300.0f);
    World world(terrain, 16, 16);
    const Raster<float> before = heightsOf(terrain);
    world.terrain().setHeight(40, 33, 40.0f);
    const PostRect changed{40, 33, 1, 1};
    const std::vector<bool> set = world.reached(
        terrainEdit(changed, {0, 0, posts, posts}, before, heightsOf(world.terrain())));
    const std::vector<bool> setOfPost = world.reached(tower(40, 33, 40.0));
    const std::vector<double> changes = world.changes(changed);
    int missed = 0; // by the top of the edit alone
    for (std::size_t i = 0; i < set.size(); ++i)
        if (changes[i] > Reach::tolerance)
        {
            EXPECT_TRUE(set[i]) << i;
            missed += setOfPost[i] ? 0 : 1;
        }
    EXPECT_GT(missed, 0);
}

// On flat ground what lies below the plane is out of reach, at whatever distance.
TEST(Reach, BelowTheHorizontalIsOutOfReach)
{
    ReachScheme scheme;
    scheme.always = 1;
    const Reach reach = flatReach({0, 0, 33, 17}, 100.0, 0.0, scheme);
    for (const int away : {40, 200, 1000, 50000})
    {
        EXPECT_FALSE(reach.isReached(tower(away, 8, 100.0))) << away;
        EXPECT_FALSE(reach.isReached(tower(16, -away, 99.0))) << away;
        EXPECT_TRUE(reach.isReached(tower(away, 8, 100.0 + away * spacing * 0.001))) << away;
    }
    // In the tile and beside it any edit counts.
    EXPECT_TRUE(reach.isReached(tower(32, 16, -500.0)));
    EXPECT_TRUE(reach.isReached(tower(33, 17, -500.0)));
    EXPECT_FALSE(reach.isReached(tower(34, 17, -500.0)));
    // Nothing changed.
    TerrainEdit nothing = tower(3, 3, 1e6);
    nothing.posts.width = 0;
    EXPECT_FALSE(reach.isReached(nothing));
}

// A tower of height H over a plane is seen up to H / tan 0.01 degrees; from within a basin with
// walls of 5 degrees up to H / tan 5 degrees.
TEST(Reach, ATowerIsReachedUpToAKnownDistance)
{
    ReachScheme scheme;
    scheme.ring = all;
    scheme.always = 1;
    const PostRect place{-7, 20, 5, 5};
    for (const double horizon : {0.0, 5.0})
    {
        const Reach reach = flatReach(place, 0.0, horizon, scheme);
        const double slope = horizon == 0.0 ? std::tan(Reach::tolerance * pi / 180.0)
                                            : std::tan(horizon * pi / 180.0);
        const double top = horizon == 0.0 ? 2.0 : 500.0;
        const int posts = static_cast<int>(top / slope / spacing);
        // Growth of the edit and rounding; the tolerance is 0.3 % at 5 degrees.
        const int margin = 3 + posts / 330;
        const int east = place.endColumn() - 1;
        const int north = place.endRow() - 1;
        EXPECT_TRUE(reach.isReached(tower(east + posts, 22, top))) << horizon;
        EXPECT_FALSE(reach.isReached(tower(east + posts + margin, 22, top))) << horizon;
        EXPECT_TRUE(reach.isReached(tower(place.column - posts, 22, top))) << horizon;
        EXPECT_FALSE(reach.isReached(tower(place.column - posts - margin, 22, top))) << horizon;
        EXPECT_TRUE(reach.isReached(tower(-5, north + posts, top))) << horizon;
        EXPECT_FALSE(reach.isReached(tower(-5, north + posts + margin, top))) << horizon;
        EXPECT_TRUE(reach.isReached(tower(-5, place.row - posts, top))) << horizon;
        EXPECT_FALSE(reach.isReached(tower(-5, place.row - posts - margin, top))) << horizon;
        // Diagonal, from corner to corner.
        const int across = static_cast<int>(posts / std::sqrt(2.0));
        EXPECT_TRUE(reach.isReached(tower(east + across, north + across, top))) << horizon;
        EXPECT_FALSE(reach.isReached(tower(east + across + margin, north + across + margin, top)));
    }
}

// Rows of different width: the narrowest row sees a tower from the most posts.
TEST(Reach, TheNarrowestRowCounts)
{
    const PostRect place{0, 0, 5, 5};
    DemTile tile(place.width, place.height, spacing);
    tile.eastSpacings = {30.0, 28.0, 26.0, 24.0, 22.0};
    HorizonMap horizons(place.width, place.height, 32);
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
            tile.setHeight(column, row, 0.0f);
    for (std::uint16_t& code : horizons.codes())
        code = HorizonMap::encode(5.0);
    ReachScheme scheme;
    scheme.ring = all;
    scheme.always = 1;
    const Reach reach(tile, place, horizons, scheme);
    const int posts = static_cast<int>(500.0 / std::tan(5.0 * pi / 180.0) / 22.0);
    EXPECT_TRUE(reach.isReached(tower(4 + posts, 2, 500.0)));
    EXPECT_FALSE(reach.isReached(tower(4 + posts + 4, 2, 500.0)));
}

// Far off, coarse levels mix an edit with what is higher beside it, and spread it.
TEST(Reach, CoarseLevelsMixAnEditWithWhatIsBesideIt)
{
    ReachScheme scheme;
    scheme.always = 1;
    const Reach reach = flatReach({0, 0, 33, 33}, 0.0, 0.0, scheme);
    TerrainEdit edit;
    edit.posts = {0, 16, 1, 1};
    edit.tops = {-10.0, -10.0, -10.0, 100.0};
    // Level k sees up to 128 * 2^k posts beyond the tile; 3 cells are to spare.
    for (const int away : {10, 125, 250, 500})
    {
        edit.posts.column = 32 + away;
        EXPECT_FALSE(reach.isReached(edit)) << away;
    }
    for (const int away : {501, 1000, 2000, 9000})
    {
        edit.posts.column = 32 + away;
        EXPECT_TRUE(reach.isReached(edit)) << away;
    }
}

// A planet's ground sinks: a tower of H over a plane is out of sight from sqrt(2 R H) on.
TEST(Reach, APlanetShortensReach)
{
    ReachScheme scheme;
    scheme.ring = all;
    scheme.always = 1;
    scheme.bodyRadius = 6.371e6;
    const Reach reach = flatReach({0, 0, 33, 33}, 0.0, 0.0, scheme);
    const double slope = std::tan(Reach::tolerance * pi / 180.0);
    const double radius = scheme.bodyRadius;
    const double top = 100.0;
    // top - d^2 / 2R = d * slope
    const double distance =
        -radius * slope + std::sqrt(radius * slope * (radius * slope) + 2.0 * radius * top);
    ASSERT_LT(distance, std::sqrt(2.0 * radius * top));
    const int posts = static_cast<int>(distance / spacing);
    EXPECT_TRUE(reach.isReached(tower(32 + posts, 16, top)));
    EXPECT_FALSE(reach.isReached(tower(32 + posts + 3, 16, top)));
}

// Horizons by azimuth: a wall in the north hides a tower there and no other.
TEST(Reach, AWallHidesWhatIsBehindIt)
{
    const PostRect place{0, 0, 33, 33};
    DemTile tile(place.width, place.height, spacing);
    HorizonMap horizons(place.width, place.height, 16);
    for (int row = 0; row < place.height; ++row)
        for (int column = 0; column < place.width; ++column)
        {
            tile.setHeight(column, row, 0.0f);
            for (int azimuth = 0; azimuth < 16; ++azimuth)
                horizons.codes()[static_cast<std::size_t>((azimuth * 33 + row) * 33 + column)] =
                    HorizonMap::encode(azimuth >= 2 && azimuth <= 6 ? 30.0 : 0.0);
        }
    ReachScheme scheme;
    scheme.always = 1;
    const Reach reach(tile, place, horizons, scheme);
    EXPECT_FALSE(reach.isReached(tower(16, 232, 100.0)));
    EXPECT_TRUE(reach.isReached(tower(16, 232, 6000.0)));
    EXPECT_TRUE(reach.isReached(tower(16, -200, 100.0)));
    EXPECT_TRUE(reach.isReached(tower(-200, 16, 100.0)));
    EXPECT_TRUE(reach.isReached(tower(232, 16, 100.0)));
    // One post that sees over the wall is enough; voids do not count.
    tile.setHeight(5, 7, 3000.0f);
    EXPECT_FALSE(Reach(tile, place, horizons, scheme).isReached(tower(16, 232, 100.0)));
    for (int azimuth = 0; azimuth < 16; ++azimuth)
        horizons.codes()[static_cast<std::size_t>((azimuth * 33 + 7) * 33 + 5)] =
            HorizonMap::levelCode;
    EXPECT_TRUE(Reach(tile, place, horizons, scheme).isReached(tower(16, 232, 3300.0)));
    tile.setVoid(5, 7);
    EXPECT_FALSE(Reach(tile, place, horizons, scheme).isReached(tower(16, 232, 3300.0)));
}

// Terrain that arrives where there was none, and departs again. By exact horizons.
TEST(Reach, TerrainArrivesAndDeparts)
{
    constexpr int posts = 65;
    const auto terrain = [](bool there, float height)
    {
        DemTile made(posts, posts, spacing);
        for (int row = 0; row < posts; ++row)
            for (int column = 0; column < posts; ++column)
                if (column < 33 || (there && column > 40))
                    made.setHeight(column, row, column < 33 ? 0.0f : height);
        return made;
    };
    const PostRect arrives{41, 0, 24, posts};
    const PostRect whole{0, 0, posts, posts};
    for (const float height : {50.0f, -50.0f})
    {
        const DemTile without = terrain(false, height);
        const DemTile with = terrain(true, height);
        const TerrainEdit arrival =
            terrainEdit(arrives, whole, heightsOf(without), heightsOf(with));
        const TerrainEdit departure =
            terrainEdit(arrives, whole, heightsOf(with), heightsOf(without));
        World empty(without, 32, 16);
        World full(with, 32, 16);
        const std::vector<bool> reachedByArrival = empty.reached(arrival);
        const std::vector<bool> reachedByDeparture = full.reached(departure);
        full.terrain() = without;
        const std::vector<double> changes = full.changes(arrives);
        ASSERT_EQ(empty.places().size(), 4u);
        for (std::size_t i = 0; i < 4; ++i)
        {
            // The western tiles see higher ground only; the eastern ones are what arrives.
            const bool expected = empty.places()[i].column > 0 || height > 0.0f;
            EXPECT_EQ(reachedByArrival[i], expected) << i;
            EXPECT_EQ(reachedByDeparture[i], expected) << i;
            EXPECT_EQ(changes[i] > Reach::tolerance, expected) << i;
        }
    }
}

// A tile that is wholly void receives nothing, unless the edit is its own.
TEST(Reach, AVoidTileIsOutOfReach)
{
    const PostRect place{10, 10, 9, 9};
    const Reach reach(DemTile(9, 9, spacing), place, HorizonMap(9, 9, 32));
    EXPECT_FALSE(reach.isReached(tower(20, 10, 1e5)));
    EXPECT_TRUE(reach.isReached(tower(18, 10, -1e5)));
}

TEST(Reach, TakesLittleMemory)
{
    const Reach reach = flatReach({0, 0, 5, 5}, 0.0, 0.0, {});
    EXPECT_GE(reach.bytes(), 32u * 9u * 4u);
    EXPECT_LE(reach.bytes(), 32u * 9u * 4u + 160u);
}

// Tops grow with what coarse levels mix in.
TEST(TerrainEdit, TopsAreOfGrowingSurroundings)
{
    const PostRect area{-20, -10, 41, 21};
    Raster<float> before(area.width, area.height, 0.0f);
    Raster<float> after = before;
    after.at(20, 10) = -3.0f;     // the edit
    before.at(20 + 2, 10) = 1.0f; // 2 posts beside it
    after.at(20, 10 - 4) = 2.0f;
    before.at(20 - 9, 10) = 5.0f;
    before.at(20 + 17, 10) = 7.0f;
    before.at(3, 3) = std::numeric_limits<float>::quiet_NaN();
    const TerrainEdit edit = terrainEdit({0, 0, 1, 1}, area, before, after);
    EXPECT_EQ(edit.tops, (std::vector<double>{1.0, 2.0, 2.0, 5.0, 7.0}));
    EXPECT_EQ(edit.top(9), 7.0);
}

// Coarse levels, by LevelReducer, change where coarsened() says and to no more than top() says; so
// do the posts between which their surface changes.
TEST(TerrainEdit, HoldsWhatCoarseLevelsSpread)
{
    constexpr int posts = 97;
    const DemTile original = *generateTerrain(TerrainKind::Cliffs, posts, posts, spacing, 3);
    MemorySource before(original);
    std::mt19937 random(7);
    for (int i = 0; i < 20; ++i)
    {
        DemTile edited = original;
        const PostRect changed = makeEdit(edited, 32, static_cast<EditKind>(i % kinds), random);
        const TerrainEdit edit =
            terrainEdit(changed, {0, 0, posts, posts}, heightsOf(original), heightsOf(edited));
        MemorySource after(edited);
        for (int level = 1; level <= 4; ++level)
        {
            const TerrainEdit coarse = edit.coarsened(level);
            const PostRect extent = before.extent(level);
            for (const CrestAxis axis : {CrestAxis::East, CrestAxis::North})
            {
                const Raster<float> old = *before.readLevel(level, axis, extent);
                const Raster<float> now = *after.readLevel(level, axis, extent);
                for (int row = 0; row < extent.height; ++row)
                    for (int column = 0; column < extent.width; ++column)
                    {
                        const float a = old.at(column, row);
                        const float b = now.at(column, row);
                        const int x = extent.column + column;
                        const int y = extent.row + row;
                        if (!(a == b || (std::isnan(a) && std::isnan(b))))
                        {
                            EXPECT_TRUE(coarse.posts.contains(x, y)) << level;
                        }
                        if (coarse.posts.grownBy(1).contains(x, y))
                        {
                            EXPECT_FALSE(double(std::fmax(a, b)) > edit.top(level)) << level;
                            EXPECT_FALSE(double(std::fmax(a, b)) > coarse.top(0)) << level;
                        }
                    }
            }
        }
    }
}
