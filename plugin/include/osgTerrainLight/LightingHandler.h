#pragma once

#include <osgTerrainLight/Export.h>

#include <osgGA/GUIEventHandler>

#include <memory>

namespace osgTerrainLight
{
class TerrainLighting;

/// Keys in a viewer's window that change the light of a TerrainLighting. Where the lighting has a
/// place, keys run the day, too. While its getTime() has a time, the window shows the time and the
/// place of the sun. The keys differ from those of osgviewer and its camera manipulators, and the
/// viewer's help lists them.
///
/// Add the handler to a viewer (addEventHandler), with the lighting that it changes, or to the
/// lighting itself (addEventCallback). The handler of a lighting is saved with the scene.
class OSGTERRAINLIGHT_EXPORT LightingHandler : public osgGA::GUIEventHandler
{
public:
    /// lighting: the lighting that the keys change, which may go before the handler does. An event
    /// callback of a lighting needs none.
    explicit LightingHandler(TerrainLighting* lighting = nullptr);
    /// A copy has the same lighting, and its own clock, which stands still.
    LightingHandler(const LightingHandler& other,
                    const osg::CopyOp& copyop = osg::CopyOp::SHALLOW_COPY);
    META_Object(osgTerrainLight, LightingHandler);

    using osgGA::GUIEventHandler::handle;
    bool handle(const osgGA::GUIEventAdapter& event, osgGA::GUIActionAdapter& action,
                osg::Object* object, osg::NodeVisitor* visitor) override;
    void getUsage(osg::ApplicationUsage& usage) const override;

protected:
    ~LightingHandler() override;

private:
    struct Implementation;
    std::unique_ptr<Implementation> _implementation;
};

} // namespace osgTerrainLight
