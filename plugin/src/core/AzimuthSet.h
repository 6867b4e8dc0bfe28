#pragma once

namespace osgTerrainLight
{

/// A horizontal unit vector.
struct MapDirection
{
    double east = 1.0;
    double north = 0.0;
};

/// Direction of a compass azimuth (degrees clockwise from north). Exact at multiples of 90°.
MapDirection directionOfCompass(double degrees);

/// The m equally spaced azimuths that horizons are stored for, and the only place that converts
/// between the two ways to count them: inside, φ_k = 2πk/m counter-clockwise from east (index k);
/// for people, degrees clockwise from north (band 0, 1, … from north).
class AzimuthSet
{
public:
    /// count: a multiple of 4, 4 … 256.
    explicit AzimuthSet(int count);

    static bool isValidCount(int count);

    int count() const { return _count; }

    /// Direction of index k, exact at multiples of 90°, and direction(k + m/2) = −direction(k) to
    /// the last bit.
    MapDirection direction(int index) const;

    /// Index of the azimuth that is band/m·360° clockwise from north, band 0 … m − 1. Its own
    /// inverse.
    int indexOfBand(int band) const;

    double compassDegreesOfBand(int band) const;

private:
    int _count;
};

} // namespace osgTerrainLight
