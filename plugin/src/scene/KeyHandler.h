#pragma once

#include <osgTerrainLight/TerrainLighting.h>

#include <osg/observer_ptr>
#include <osgGA/GUIEventHandler>

namespace osgTerrainLight
{

/// Keys that change the light. Making one adds them to what a viewer's help lists. None of them is
/// a key of osgviewer or its camera manipulators.
class KeyHandler : public osgGA::GUIEventHandler
{
public:
    explicit KeyHandler(TerrainLighting& lighting);

    using osgGA::GUIEventHandler::handle;
    bool handle(const osgGA::GUIEventAdapter& event, osgGA::GUIActionAdapter& action) override;
    void getUsage(osg::ApplicationUsage& usage) const override;

private:
    ~KeyHandler() override = default;
    osg::observer_ptr<TerrainLighting> _lighting;
};

} // namespace osgTerrainLight
