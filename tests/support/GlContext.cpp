#include "support/GlContext.h"

#include <memory>

namespace osgTerrainLight
{

namespace
{
struct Shared
{
    std::unique_ptr<HeadlessContext> context;
    std::string reason;
    bool tried = false;
};

Shared& shared()
{
    static Shared instance;
    return instance;
}

/// Closes the context while everything that OSG needs for it still lives: after the tests, before
/// static destructors.
class Closing : public testing::Environment
{
    void TearDown() override { shared() = Shared{nullptr, "the tests have ended", true}; }
};
[[maybe_unused]] const testing::Environment* const closing =
    testing::AddGlobalTestEnvironment(new Closing);
} // namespace

HeadlessContext* sharedGlContext(std::string& reason)
{
    Shared& here = shared();
    if (!here.tried)
    {
        here.tried = true;
        here.context = HeadlessContext::create(16, 16, here.reason);
        const auto found = here.context ? GpuCapabilities::query(here.context->state())
                                        : Result<GpuCapabilities>(GpuCapabilities());
        if (!found)
        {
            here.reason = found.error().message;
            here.context = nullptr;
        }
    }
    reason = here.reason;
    if (here.context && !here.context->makeCurrent())
        reason = "the shared context cannot be made current again";
    return reason.empty() ? here.context.get() : nullptr;
}

std::string takeGlErrors()
{
    std::string found;
    // Bounded: without a current context some drivers report errors without end.
    for (int i = 0; i < 16; ++i)
    {
        const char* name = "an unknown error";
        switch (glGetError())
        {
        case GL_NO_ERROR:
            return found;
        case GL_INVALID_ENUM:
            name = "GL_INVALID_ENUM";
            break;
        case GL_INVALID_VALUE:
            name = "GL_INVALID_VALUE";
            break;
        case GL_INVALID_OPERATION:
            name = "GL_INVALID_OPERATION";
            break;
        case GL_OUT_OF_MEMORY:
            name = "GL_OUT_OF_MEMORY";
            break;
        default:
            break;
        }
        found += (found.empty() ? "" : ", ") + std::string(name);
    }
    return found;
}

} // namespace osgTerrainLight
