#include "lighting/TileSurface.h"

#include "gpu/GlConstants.h"
#include "gpu/Textures.h"

namespace osgTerrainLight
{

TileSurface::TileSurface(const DemTile& tile, int frame, double bodyRadius, bool changing)
    : _tile(tile), _frame(frame), _bodyRadius(bodyRadius), _isChanging(changing),
      // Those that a pass writes have no image: it would be loaded in their place.
      _heights(own(
          changing ? new Resource("heights", TextureLayout{tile.width() + 2 * frame,
                                                           tile.height() + 2 * frame, 0, GL_R32F})
                   : new Resource("heights",
                                  [this]() -> osg::ref_ptr<osg::Texture>
                                  { return createHeightTexture(_tile, _frame, _bodyRadius); }))),
      _eastSpacings(own(new Resource("east spacings",
                                     [this]() -> osg::ref_ptr<osg::Texture>
                                     { return createSpacingTexture(_tile); })))
{
    _heights->make();
    _eastSpacings->make();
}

void TileSurface::bind(GpuPass& pass) const
{
    pass.reads("heights", _heights);
    pass.reads("eastSpacings", _eastSpacings);
    pass.set("size", width(), height());
    pass.set("frame", _frame);
    pass.set("northSpacing", static_cast<float>(_tile.northSpacing));
}

GpuPass::Groups TileSurface::groups(int stride) const
{
    return {GpuPass::groupsFor((width() - 1) / stride + 1, 8),
            GpuPass::groupsFor((height() - 1) / stride + 1, 8), 1};
}

TextureLayout TileSurface::perPost(GLint format, int layers) const
{
    return {width(), height(), layers, format};
}

} // namespace osgTerrainLight
