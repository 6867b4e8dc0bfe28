#include "scene/FadingLod.h"

#include <osg/CullStack>

namespace osgTerrainLight
{

void FadingLod::holdCoarser(unsigned frame)
{
    _coarserHeld = frame;
    // The pager says of what it has just added that it has been drawn.
    if (getFrameNumber(1) >= getFrameNumber(0) && getFrameNumber(0) > 0)
        setFrameNumber(1, getFrameNumber(0) - 1);
}

void FadingLod::traverse(osg::NodeVisitor& visitor)
{
    const osg::FrameStamp* stamp = visitor.getFrameStamp();
    osg::CullStack* cull = visitor.asCullStack();
    if (visitor.getVisitorType() != osg::NodeVisitor::CULL_VISITOR || !stamp || !cull ||
        getNumChildren() < 2)
        return osg::PagedLOD::traverse(visitor);
    const unsigned frame = stamp->getFrameNumber();
    if (!(cull->getLODScale() > 0.0f))
    {
        _finer = frame; // it draws the finest
        return osg::PagedLOD::traverse(visitor);
    }
    const bool finer = cull->clampedPixelSize(getBound()) / cull->getLODScale() >= getMinRange(1);
    (finer ? _finer : _coarser) = frame;
    const bool isFiner = getFrameNumber(1) >= getFrameNumber(0);
    const bool isHeld = isFiner ? !finer && _finerHeld == frame : finer && _coarserHeld == frame;
    if (!isHeld)
        return osg::PagedLOD::traverse(visitor);
    // As PagedLOD does for children in range.
    const unsigned child = isFiner ? 1 : 0;
    setFrameNumberOfLastTraversal(frame);
    setTimeStamp(child, stamp->getReferenceTime());
    setFrameNumber(child, frame);
    getChild(child)->accept(visitor);
}

} // namespace osgTerrainLight
