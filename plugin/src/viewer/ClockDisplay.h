#pragma once

#include <osg/Camera>
#include <osgText/Text>

#include <string>

namespace osgTerrainLight
{

/// A line or two of text in the lower left corner of a window, over everything else. Nothing is
/// drawn while the text is empty.
class ClockDisplay : public osg::Camera
{
public:
    ClockDisplay();
    /// Where the scene graph may be changed.
    void show(const std::string& text);

private:
    ~ClockDisplay() override = default;
    osg::ref_ptr<osgText::Text> _text;
    std::string _shown;
};

} // namespace osgTerrainLight
