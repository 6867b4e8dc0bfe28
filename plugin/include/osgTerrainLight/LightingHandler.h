#pragma once

#include <osgTerrainLight/Export.h>

#include <osgGA/GUIEventHandler>

#include <memory>

namespace osgTerrainLight
{
class TerrainLighting;

/// Keys in a viewer's window that change the light of a TerrainLighting, and that run the day where
/// it has a place. While its getTime() has one, the window shows the time and where the sun stands.
/// None of the keys is one of osgviewer or of its camera manipulators; they are listed with the
/// viewer's own.
///
/// Add it to a viewer (addEventHandler), with the lighting that it changes; or to a lighting itself
/// (addEventCallback), whose light it then changes. The second is saved with the scene.
class OSGTERRAINLIGHT_EXPORT LightingHandler : public osgGA::GUIEventHandler
{
public:
    /// lighting: the one to change, observed; not needed for an event callback of a lighting.
    explicit LightingHandler(TerrainLighting* lighting = nullptr);
    /// A copy has the same lighting, and a clock of its own that stands still.
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
