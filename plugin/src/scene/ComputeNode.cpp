#include "scene/ComputeNode.h"

#include <osg/Drawable>

namespace osgTerrainLight
{

namespace
{
class ComputeDrawable : public osg::Drawable
{
public:
    explicit ComputeDrawable(Scheduler* scheduler) : _scheduler(scheduler)
    {
        setCullingActive(false);
        setSupportsDisplayList(false);
        setUseDisplayList(false);
    }
    osg::Object* cloneType() const override { return new ComputeDrawable(_scheduler); }
    osg::Object* clone(const osg::CopyOp&) const override { return cloneType(); }
    const char* libraryName() const override { return "osgTerrainLight"; }
    const char* className() const override { return "ComputeDrawable"; }

    void drawImplementation(osg::RenderInfo& renderInfo) const override
    {
        _scheduler->compute(*renderInfo.getState());
    }
    void compileGLObjects(osg::RenderInfo&) const override {}
    osg::BoundingBox computeBoundingBox() const override { return {}; }

private:
    osg::ref_ptr<Scheduler> _scheduler;
};
} // namespace

ComputeNode::ComputeNode(Scheduler* scheduler)
{
    setRenderOrder(osg::Camera::PRE_RENDER, -1000);
    setReferenceFrame(osg::Transform::ABSOLUTE_RF);
    setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    setClearMask(0);
    setCullingActive(false);
    setAllowEventFocus(false);
    addChild(new ComputeDrawable(scheduler));
}

} // namespace osgTerrainLight
