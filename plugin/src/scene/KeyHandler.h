#pragma once

#include "scene/ClockDisplay.h"
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/observer_ptr>
#include <osgGA/GUIEventHandler>

namespace osgTerrainLight
{

/// Keys that change the light, and that run the day where the lighting has a place. Making one adds
/// them to what a viewer's help lists. None of them is a key of osgviewer or its camera
/// manipulators.
class KeyHandler : public osgGA::GUIEventHandler
{
public:
    explicit KeyHandler(TerrainLighting& lighting);

    using osgGA::GUIEventHandler::handle;
    bool handle(const osgGA::GUIEventAdapter& event, osgGA::GUIActionAdapter& action) override;
    void getUsage(osg::ApplicationUsage& usage) const override;

    /// What shows time and sun, to be drawn with the scene.
    osg::Node* clock() { return _clock; }

private:
    ~KeyHandler() override = default;
    bool handleKey(int key, TerrainLighting& lighting);
    void runClock(double now, TerrainLighting& lighting, osgGA::GUIActionAdapter& action);

    osg::observer_ptr<TerrainLighting> _lighting;
    osg::ref_ptr<ClockDisplay> _clock;
    bool _running = false;
    double _speed = 600.0;   ///< seconds of the day per second
    double _lastFrame = 0.0; ///< while it runs [s]
};

} // namespace osgTerrainLight
