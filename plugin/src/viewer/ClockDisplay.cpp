#include "viewer/ClockDisplay.h"

namespace osgTerrainLight
{

namespace
{
constexpr float pixels = 20.0f; // height of the characters
}

ClockDisplay::ClockDisplay() : _text(new osgText::Text)
{
    setName("terrain light clock");
    setReferenceFrame(ABSOLUTE_RF);
    setRenderOrder(POST_RENDER);
    setClearMask(GL_DEPTH_BUFFER_BIT);
    setAllowEventFocus(false);
    setViewMatrix(osg::Matrix::identity());
    setProjectionMatrixAsOrtho2D(0.0, 1.0, 0.0, 1.0);
    getOrCreateStateSet()->setMode(GL_LIGHTING, osg::StateAttribute::OFF);
    getOrCreateStateSet()->setMode(GL_DEPTH_TEST, osg::StateAttribute::OFF);
    _text->setDataVariance(osg::Object::DYNAMIC); // a draw thread is waited for before it changes
    _text->setCharacterSizeMode(osgText::TextBase::SCREEN_COORDS);
    _text->setCharacterSize(pixels);
    _text->setAlignment(osgText::TextBase::LEFT_BOTTOM);
    _text->setPosition(osg::Vec3(0.02f, 0.02f, 0.0f));
    // Legible over snow and night, in OSG's own font too, whose points an outline would fill.
    _text->setDrawMode(osgText::TextBase::TEXT | osgText::TextBase::FILLEDBOUNDINGBOX);
    _text->setBoundingBoxColor(osg::Vec4(0.0f, 0.0f, 0.0f, 0.6f));
    _text->setBoundingBoxMargin(0.3f * pixels);
    addChild(_text);
    setNodeMask(0);
}

void ClockDisplay::show(const std::string& text)
{
    if (text == _shown)
        return;
    _shown = text;
    _text->setText(text);
    setNodeMask(text.empty() ? 0u : ~0u);
}

} // namespace osgTerrainLight
