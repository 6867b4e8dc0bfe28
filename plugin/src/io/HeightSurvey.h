#pragma once

#include <cstddef>
#include <limits>

namespace osgTerrainLight
{

struct HeightRange
{
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
    std::size_t count = 0;

    void add(double value);
};

/// What all values of a raster say together: whether they are heights, or radii of the CRS's body.
class HeightSurvey
{
public:
    /// bodyRadius [m]: 0 where the CRS has none. knownUnit: that of the values was said.
    HeightSurvey(double bodyRadius, bool knownUnit) : _bodyRadius(bodyRadius), _knownUnit(knownUnit)
    {
    }

    /// A value [m] that is not void by nodata, mask or custom.
    void add(double metres);

    bool areRadii() const { return _radii.count > _count / 2; }
    /// Taken as metres, since no unit was said: all lie within 1 % of the radius in kilometres, of
    /// another body than the Earth, whose mountains are as high as that.
    bool areKilometres() const;
    /// Of a value that is no void [m].
    double lowest() const { return values().lowest; }
    double highest() const { return values().highest; }
    std::size_t heights() const { return values().count; }
    std::size_t voids() const { return _count - values().count; }
    /// What comes off a value [m].
    double radius() const { return areRadii() || areKilometres() ? _bodyRadius : 0.0; }

private:
    const HeightRange& values() const { return areRadii() ? _radii : _heights; }

    double _bodyRadius;
    bool _knownUnit;
    std::size_t _count = 0;
    HeightRange _heights, _radii;
};

} // namespace osgTerrainLight
