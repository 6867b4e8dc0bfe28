#pragma once

#include <osgViewer/GraphicsWindow>

/// An OpenGL context without a window, current on the calling thread, for a viewer's camera. Null
/// where neither EGL's surfaceless platform (Mesa) nor its first device (NVIDIA) gives one.
osg::ref_ptr<osgViewer::GraphicsWindowEmbedded> createHeadlessWindow(int width, int height);
