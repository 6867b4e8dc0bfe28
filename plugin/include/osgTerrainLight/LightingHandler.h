#pragma once

#include <osgTerrainLight/Export.h>
#include <osgTerrainLight/Viewpoint.h>

#include <osgGA/GUIEventHandler>

#include <memory>
#include <vector>

namespace osgTerrainLight
{
class TerrainLighting;

/// Keys in a viewer's window that change the light of a TerrainLighting. Where the lighting has a
/// place, keys run the day, too. Where the handler has viewpoints, keys lead to them. While its
/// getTime() has a time, the window shows the time and the place of the sun. The keys differ from
/// those of osgviewer and its camera manipulators, and the viewer's help lists them.
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

    /// Places to look from, in the frame of the lighting's children, in the order in which two keys
    /// lead through them; none by default. The first is where the viewer is taken to be at the
    /// beginning. They are not saved with the scene.
    void setViewpoints(const std::vector<Viewpoint>& viewpoints);
    const std::vector<Viewpoint>& getViewpoints() const;

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
