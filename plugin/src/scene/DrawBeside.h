#pragma once

#include <osg/Camera>
#include <osg/NodeCallback>
#include <osg/ref_ptr>
#include <osgUtil/CullVisitor>

namespace osgTerrainLight
{

/// Cull callback that draws a node with another one, of which it is no child: in the views of
/// viewers, not in mirrors and shadow maps of their scenes. Intersections, bounds and saved scenes
/// do not have it. Copies of the other node share the callback.
template <class Drawn>
class DrawBeside : public osg::NodeCallback
{
public:
    explicit DrawBeside(Drawn* drawn) : _drawn(drawn) {}
    // Files name it as the stock callback, which does nothing.

    Drawn& drawn() const { return *_drawn; }

    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override
    {
        traverse(node, visitor);
        osgUtil::CullVisitor* cull = visitor->asCullVisitor();
        if (cull && cull->getCurrentCamera()->getView())
            _drawn->accept(*visitor);
    }
    void resizeGLObjectBuffers(unsigned size) override
    {
        _drawn->resizeGLObjectBuffers(size);
        osg::resizeGLObjectBuffers(getNestedCallback(), size);
    }
    void releaseGLObjects(osg::State* state) const override
    {
        _drawn->releaseGLObjects(state);
        osg::releaseGLObjects(const_cast<osg::Callback*>(getNestedCallback()), state);
    }

private:
    ~DrawBeside() override = default;
    osg::ref_ptr<Drawn> _drawn;
};

} // namespace osgTerrainLight
