#include "io/EarthViewpoint.h"

#include "io/EarthKeys.h"
#include "io/EarthXml.h"

#include <initializer_list>

namespace osgTerrainLight
{

Result<EarthViewpoint> readViewpoint(const pugi::xml_node& element)
{
    EarthViewpoint viewpoint;
    viewpoint.name = valueOf(element, "name");
    const Result<EarthPoint> place = readPoint(element, false);
    if (!place)
        return place.error();
    viewpoint.longitude = place->x;
    viewpoint.latitude = place->y;
    double height = 0.0;
    const Result<bool> hasHeight =
        readKey(element, {"height", "alt", "z"},
                {metresOf, -1.0e7, 1.0e9, "a height in metres, or with a unit"}, height);
    if (!hasHeight)
        return hasHeight.error();
    if (*hasHeight)
        viewpoint.height = height;
    const struct
    {
        std::initializer_list<const char*> keys;
        KeyNeed need;
        double& value;
    } others[] = {
        {{"heading"}, {degreesOf, -720.0, 720.0, "degrees, -720 ... 720"}, viewpoint.heading},
        {{"pitch"}, {degreesOf, -90.0, 90.0, "degrees, -90 ... 90"}, viewpoint.pitch},
        {{"range"},
         {metresOf, 1.0e-3, 1.0e9, "a length more than 0, in metres or with a unit, as 5km"},
         viewpoint.range}};
    for (const auto& other : others)
        if (const Result<bool> read = readKey(element, other.keys, other.need, other.value); !read)
            return read.error();
    return viewpoint;
}

} // namespace osgTerrainLight
