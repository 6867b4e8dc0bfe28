#include "support/ScenePicture.h"

#include "osgdb/Register.h"

#include <cmath>

namespace osgTerrainLight
{

namespace
{
std::unique_ptr<HeadlessContext> newContext()
{
    std::string problem;
    return HeadlessContext::create(ScenePicture::size, ScenePicture::size, problem);
}
} // namespace

ScenePicture::ScenePicture(osg::Node* scene, double halfSide)
    : _context(newContext()), _viewer(new osgViewer::Viewer)
{
    HeadlessContext& context = *_context;
    context.state().setCheckForGLErrors(osg::State::ONCE_PER_ATTRIBUTE);
    osg::Camera& camera = *_viewer->getCamera();
    camera.setGraphicsContext(context.window());
    camera.setViewport(0, 0, size, size);
    camera.setClearColor(osg::Vec4(0.0f, 0.0f, 1.0f, 1.0f));
    camera.setProjectionMatrixAsOrtho(-halfSide, halfSide, -halfSide, halfSide, 1.0, 1.0e6);
    camera.setViewMatrixAsLookAt(osg::Vec3d(0.0, 0.0, 5.0e5), osg::Vec3d(),
                                 osg::Vec3d(0.0, 1.0, 0.0));
    camera.setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    _viewer->setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    _viewer->setReleaseContextAtEndOfFrameHint(false);
    _viewer->setSceneData(scene);
}

ScenePicture::~ScenePicture()
{
    _context->makeCurrent();
    _viewer->getSceneData()->releaseGLObjects(&_context->state());
    _viewer = nullptr;
}

void ScenePicture::draw(int count)
{
    _context->makeCurrent();
    for (int i = 0; i < count; ++i)
        _viewer->frame();
    _pixels.resize(4 * size * size);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size, size, GL_RGBA, GL_UNSIGNED_BYTE, _pixels.data());
}

double ScenePicture::redAt(double x, double y) const
{
    const int column = static_cast<int>(std::lround((0.5 + 0.5 * x) * (size - 1)));
    const int row = static_cast<int>(std::lround((0.5 + 0.5 * y) * (size - 1)));
    double sum = 0.0;
    for (int j = row - 3; j <= row + 3; ++j)
        for (int i = column - 3; i <= column + 3; ++i)
            sum += _pixels.at(static_cast<std::size_t>(4 * (j * size + i)));
    return sum / 49.0;
}

osg::ref_ptr<TerrainLighting> lightingWithBudget(double milliseconds, int azimuths)
{
    osg::ref_ptr<TerrainLighting> lighting = new TerrainLighting;
    lighting->setTimeBudget(milliseconds);
    LightingSettings settings;
    settings.azimuths = azimuths;
    lighting->setSettings(settings);
    return lighting;
}

class Said::Handler : public osg::NotifyHandler
{
public:
    void notify(osg::NotifySeverity, const char* message) override
    {
        std::lock_guard<std::mutex> lock(_mutex);
        _text += message;
    }
    std::string text() const
    {
        std::lock_guard<std::mutex> lock(_mutex);
        return _text;
    }

private:
    mutable std::mutex _mutex;
    std::string _text;
};

Said::Said() : _handler(new Handler), _before(osg::getNotifyHandler())
{
    osg::setNotifyHandler(_handler);
}

Said::~Said()
{
    osg::setNotifyHandler(_before);
}

std::string Said::text() const
{
    return _handler->text();
}

int Said::count(const std::string& part) const
{
    int count = 0;
    const std::string all = text();
    for (std::size_t at = all.find(part); at != std::string::npos; at = all.find(part, at + 1))
        ++count;
    return count;
}

void useOwnPlugins()
{
    registerReader();
    registerSerializers();
}

} // namespace osgTerrainLight
