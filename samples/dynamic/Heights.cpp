#include "Heights.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace
{
constexpr double pi = 3.14159265358979323846;

/// Deep-water waves: four trains, each as fast as its length tells.
class Waves : public Heights
{
public:
    explicit Waves(int posts)
    {
        tile = osgTerrainLight::DemTile(posts, posts, 2.0);
        for (int row = 0; row < posts; ++row)
            for (int column = 0; column < posts; ++column)
                tile.setHeight(column, row, 0.0f);
    }

    bool update(double time, int width, int height, float* heights) override
    {
        const struct
        {
            double length, amplitude, direction; // [m], [m], [rad]
        } trains[] = {{150.0, 7.0, 0.3}, {90.0, 4.0, 0.9}, {47.0, 1.6, -0.4}, {23.0, 0.7, 0.1}};
        std::fill(heights, heights + static_cast<std::ptrdiff_t>(width) * height, 0.0f);
        for (const auto& train : trains)
        {
            const double number = 2.0 * pi / train.length;
            const double turn = std::sqrt(9.81 * number) * time;
            for (int row = 0; row < height; ++row)
                for (int column = 0; column < width; ++column)
                {
                    const double way = 2.0 * (column * std::cos(train.direction) +
                                              row * std::sin(train.direction));
                    // Crests are sharper than troughs.
                    const double crest = 0.5 + 0.5 * std::sin(number * way - turn);
                    heights[row * width + column] +=
                        static_cast<float>(train.amplitude * (2.0 * crest * crest - 0.75));
                }
        }
        return true;
    }
};

/// Sand that the wind, from the west, carries slab by slab: B. T. Werner, Eolian dunes: computer
/// simulations and attractor interpretation, Geology 23 (1995).
class Dunes : public Heights
{
public:
    explicit Dunes(int posts) : _posts(posts)
    {
        tile = osgTerrainLight::DemTile(posts, posts, 4.0);
        for (int i = 0; i < posts * posts; ++i)
            _slabs.push_back(8 + static_cast<int>(_random() % 3u));
        for (int row = 0; row < posts; ++row)
            for (int column = 0; column < posts; ++column)
                tile.setHeight(column, row, smoothed(column, row));
    }

    bool update(double, int width, int height, float* heights) override
    {
        for (int i = 0; i < width * height / 2; ++i)
        {
            int column = pick();
            const int row = pick();
            if (at(column, row) == 0 || inLee(column, row))
                continue;
            take(column, row);
            bool down = false;
            while (!down)
            {
                column = wrap(column + 5);
                const int chance = at(column, row) > 0 ? 60 : 40; // percent
                down = inLee(column, row) || static_cast<int>(_random() % 100u) < chance;
            }
            put(column, row);
        }
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column)
                heights[row * width + column] = smoothed(column, row);
        return true;
    }

private:
    static constexpr float slab = 1.2f; // [m]; steps of 4 m by two of them are the angle of repose
    static constexpr int steepest = 2;

    /// Mean of 3 x 3: single slabs are not to be seen.
    float smoothed(int column, int row)
    {
        int sum = 0;
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                sum += at(column + x, row + y);
        return slab * static_cast<float>(sum) / 9.0f;
    }

    int pick() { return static_cast<int>(_random() % static_cast<unsigned>(_posts)); }
    int wrap(int place) const { return (place + _posts) % _posts; }
    int& at(int column, int row)
    {
        return _slabs[static_cast<std::size_t>(wrap(row) * _posts + wrap(column))];
    }
    /// Behind a crest that rises by 15 degrees.
    bool inLee(int column, int row)
    {
        for (int away = 1; away <= 24; ++away)
            if (at(column - away, row) - at(column, row) > 0.9 * away)
                return true;
        return false;
    }
    /// Calls with the neighbour that is lower (sign 1) or higher (-1) by more than the steepest.
    template <class F>
    void avalanche(int column, int row, int sign, F&& f)
    {
        const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
        for (const auto& step : steps)
            if (sign * (at(column, row) - at(column + step[0], row + step[1])) > steepest)
            {
                f(wrap(column + step[0]), wrap(row + step[1]));
                return;
            }
    }
    void put(int column, int row)
    {
        ++at(column, row);
        avalanche(column, row, 1,
                  [&](int x, int y)
                  {
                      --at(column, row);
                      put(x, y);
                  });
    }
    void take(int column, int row)
    {
        --at(column, row);
        avalanche(column, row, -1,
                  [&](int x, int y)
                  {
                      ++at(column, row);
                      take(x, y);
                  });
    }

    int _posts;
    std::mt19937 _random{1};
    std::vector<int> _slabs;
};

/// A DEM, or hills, that holes are dug in.
class Craters : public Heights
{
public:
    Craters(int posts, const osgTerrainLight::DemTile& dem)
    {
        tile = dem;
        if (tile.postCount() > 0)
            return;
        tile = osgTerrainLight::DemTile(posts, posts, 10.0);
        for (int row = 0; row < posts; ++row)
            for (int column = 0; column < posts; ++column)
            {
                double height = 0.0;
                for (int octave = 0; octave < 6; ++octave)
                {
                    const double turn = (0.02 + 0.003 * octave) * std::pow(1.9, octave);
                    height += 80.0 * std::pow(0.48, octave) *
                              std::sin(turn * column + 1.7 * octave + std::sin(turn * row * 0.7)) *
                              std::cos(turn * row - 0.9 * octave + std::sin(turn * column * 0.6));
                }
                tile.setHeight(column, row, static_cast<float>(height));
            }
    }

    void dig(double column, double row) override { _asked.push_back({column, row}); }

    bool update(double, int width, int height, float* heights) override
    {
        if (_asked.empty())
            return false;
        const auto [column, row] = _asked.front();
        _asked.pop_front();
        const double radius = std::max(3.0, 0.04 * std::min(width, height)); // posts
        const double depth = 0.35 * radius * tile.northSpacing;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
            {
                const double r = std::hypot(x - column, y - row) / radius;
                if (r > 3.0)
                    continue;
                // A bowl, and a rim of a fifth of its depth that falls off with the cube.
                const double rim = 0.2 * depth;
                const double change = r < 1.0 ? (depth + rim) * (r * r - 1.0) + rim
                                              : rim * std::pow(r, -3.0) * (1.5 - 0.5 * r);
                heights[y * width + x] += static_cast<float>(change);
            }
        return true;
    }

private:
    std::deque<std::pair<double, double>> _asked;
};
} // namespace

std::unique_ptr<Heights> createHeights(const std::string& name, int posts,
                                       const osgTerrainLight::DemTile& dem)
{
    if (name == "waves")
        return std::make_unique<Waves>(posts);
    if (name == "dunes")
        return std::make_unique<Dunes>(posts);
    if (name == "craters")
        return std::make_unique<Craters>(posts, dem);
    return nullptr;
}
