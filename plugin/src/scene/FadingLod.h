#pragma once

#include <osg/PagedLOD>

#include <atomic>

namespace osgTerrainLight
{

/// A PagedLOD that may go on to draw what it draws although its size on the screen asks for the
/// other: finer children while their light fades over to that of the coarser tile that takes their
/// place, and the coarser tile while its own light fades in (TileFades). Where nothing is held it
/// is a plain PagedLOD, and it is saved as one.
class FadingLod : public osg::PagedLOD
{
public:
    /// In this frame finer children that have been drawn so far stay. In update traversal.
    void holdFiner(unsigned frame) { _finerHeld = frame; }
    /// In this frame they are not drawn yet. In update traversal, before they have been.
    void holdCoarser(unsigned frame);
    /// False where the node was too small for finer children in all views of the last frame that
    /// it was seen in.
    bool wantsFiner() const { return _finer >= _coarser; }

    void traverse(osg::NodeVisitor& visitor) override;

protected:
    ~FadingLod() override = default;

private:
    // Numbers of frames.
    std::atomic<unsigned> _finerHeld{~0u}, _coarserHeld{~0u}, _finer{0}, _coarser{0};
};

} // namespace osgTerrainLight
