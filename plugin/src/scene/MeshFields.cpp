#include "scene/MeshFields.h"

#include "fields/FieldCache.h"
#include "io/CacheFolder.h"

#include <osg/Notify>

#include <atomic>
#include <chrono>
#include <future>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

namespace osgTerrainLight
{

namespace
{

constexpr int cells = 48;

class Sampling : public MeshSampling
{
public:
    Sampling(TriangleMesh mesh, std::string name)
        : _grid(std::async(std::launch::async,
                           [this, mesh = std::move(mesh), name = std::move(name)]
                           { return sample(mesh, name); }))
    {
    }
    ~Sampling() override
    {
        _isGivenUp = true;
        _grid.wait();
    }
    Sampling(const Sampling&) = delete;
    Sampling& operator=(const Sampling&) = delete;

    bool isDone() const override
    {
        return _grid.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }
    std::shared_ptr<const DistanceGrid> grid() const override
    {
        return isDone() ? _grid.get() : nullptr;
    }

private:
    std::shared_ptr<const DistanceGrid> sample(const TriangleMesh& mesh, const std::string& name)
    {
        // Each uses all processors.
        static std::mutex oneAtATime;
        const std::lock_guard<std::mutex> lock(oneAtATime);
        BakeOptions options;
        options.cells = cells;
        options.progress = [this](double) { return !_isGivenUp; };
        if (_isGivenUp)
            return nullptr;
        const std::string folder = userCacheFolder();
        const FieldCache cache(folder.empty() ? "" : folder + "/objects");
        const Result<CachedField> baked = cache.bake(mesh, options);
        if (_isGivenUp)
            return nullptr;
        if (!baked)
        {
            static std::atomic<bool> saidUnsupported{false};
            const bool isUnsupported = baked.error().code == ErrorCode::NotSupported;
            if (!isUnsupported || !saidUnsupported.exchange(true))
                OSG_WARN << "osgTerrainLight: object '" << name
                         << "' changes light as its box does: " << baked.error().message
                         << std::endl;
            return nullptr;
        }
        if (!baked->field.isWellSigned())
            OSG_WARN << "osgTerrainLight: object '" << name
                     << "': inside and outside of its mesh cannot be told apart well: its shadow "
                        "may have holes; needs a mesh whose parts are closed"
                     << std::endl;
        return std::make_shared<const DistanceGrid>(baked->field.grid);
    }

    std::atomic<bool> _isGivenUp{false};
    std::shared_future<std::shared_ptr<const DistanceGrid>> _grid; ///< last: its thread has this
};

} // namespace

std::shared_ptr<const MeshSampling> sampleMesh(TriangleMesh mesh, const std::string& name)
{
    static std::map<std::string, std::weak_ptr<const MeshSampling>> known;
    BakeOptions options;
    options.cells = cells;
    // Named by its content, whether or not it is kept in a file.
    std::weak_ptr<const MeshSampling>& shared = known[FieldCache("m").pathOf(mesh, options)];
    std::shared_ptr<const MeshSampling> sampling = shared.lock();
    if (!sampling)
        sampling = std::make_shared<Sampling>(std::move(mesh), name);
    shared = sampling;
    for (auto each = known.begin(); each != known.end();)
        each = each->second.expired() ? known.erase(each) : std::next(each);
    return sampling;
}

} // namespace osgTerrainLight
