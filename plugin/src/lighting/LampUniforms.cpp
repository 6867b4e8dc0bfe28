#include "lighting/LampUniforms.h"

namespace osgTerrainLight
{

namespace
{
osg::Vec3f vector(const glm::dvec3& v)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
} // namespace

std::vector<osg::ref_ptr<osg::Uniform>> lampUniforms(const std::vector<ObjectLamp>& lamps,
                                                     const std::string& prefix)
{
    constexpr auto most = static_cast<int>(ObjectLamp::most);
    const osg::ref_ptr<osg::Uniform> places =
        new osg::Uniform(osg::Uniform::FLOAT_VEC4, prefix + "lamps", most);
    const osg::ref_ptr<osg::Uniform> radiances =
        new osg::Uniform(osg::Uniform::FLOAT_VEC3, prefix + "lampRadiances", most);
    for (unsigned i = 0; i < lamps.size(); ++i)
    {
        places->setElement(
            i, osg::Vec4f(vector(lamps[i].centre), static_cast<float>(lamps[i].radius)));
        radiances->setElement(i, vector(lamps[i].radiance));
    }
    const std::string count = prefix + "lampCount";
    return {new osg::Uniform(count.c_str(), static_cast<int>(lamps.size())), places, radiances};
}

} // namespace osgTerrainLight
