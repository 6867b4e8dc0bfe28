#include "scene/MeshFields.h"

#include "fields/FieldCache.h"
#include "io/CacheFolder.h"

#include <osg/Notify>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace osgTerrainLight
{

namespace
{

constexpr int cells = 48;

/// What the thread that samples and the objects share.
struct Job
{
    TriangleMesh mesh;
    std::string name;
    std::atomic<bool> isGivenUp{false}, isDone{false};
    std::shared_ptr<const DistanceGrid> grid; ///< once it is done
};

std::shared_ptr<const DistanceGrid> sample(const Job& job, const std::atomic<bool>& isOver)
{
    BakeOptions options;
    options.cells = cells;
    const auto isGivenUp = [&] { return job.isGivenUp || isOver; };
    options.progress = [&](double) { return !isGivenUp(); };
    const std::string folder = userCacheFolder();
    const FieldCache cache(folder.empty() ? "" : folder + "/objects");
    const Result<CachedField> baked = cache.bake(job.mesh, options);
    if (isGivenUp())
        return nullptr;
    if (!baked)
    {
        static std::atomic<bool> saidUnsupported{false};
        const bool isUnsupported = baked.error().code == ErrorCode::NotSupported;
        if (!isUnsupported || !saidUnsupported.exchange(true))
            OSG_WARN << "osgTerrainLight: object '" << job.name
                     << "' changes light as its box does: " << baked.error().message << std::endl;
        return nullptr;
    }
    if (!baked->field.isWellSigned())
        OSG_WARN << "osgTerrainLight: object '" << job.name
                 << "': inside and outside of its mesh cannot be told apart well: its shadow may "
                    "have holes; needs a mesh whose parts are closed"
                 << std::endl;
    return std::make_shared<const DistanceGrid>(baked->field.grid);
}

/// Samples meshes one after the other, since each takes all processors. Nobody waits for it but the
/// end of the program.
class Sampler
{
public:
    ~Sampler()
    {
        {
            const std::lock_guard<std::mutex> lock(_mutex);
            _isOver = true;
        }
        _changed.notify_all();
        if (_thread.joinable())
            _thread.join();
    }
    void add(std::shared_ptr<Job> job)
    {
        const std::lock_guard<std::mutex> lock(_mutex);
        _jobs.push_back(std::move(job));
        if (!_thread.joinable())
            _thread = std::thread([this] { run(); });
        _changed.notify_all();
    }

private:
    void run()
    {
        std::unique_lock<std::mutex> lock(_mutex);
        while (true)
        {
            _changed.wait(lock, [this] { return _isOver || !_jobs.empty(); });
            if (_isOver)
                return;
            const std::shared_ptr<Job> job = std::move(_jobs.front());
            _jobs.pop_front();
            if (job->isGivenUp)
                continue;
            lock.unlock();
            job->grid = sample(*job, _isOver);
            job->isDone = true;
            lock.lock();
        }
    }

    std::mutex _mutex; ///< of the jobs
    std::condition_variable _changed;
    std::deque<std::shared_ptr<Job>> _jobs;
    std::atomic<bool> _isOver{false};
    std::thread _thread;
};

class Sampling : public MeshSampling
{
public:
    explicit Sampling(std::shared_ptr<Job> job) : _job(std::move(job)) {}
    ~Sampling() override { _job->isGivenUp = true; }
    Sampling(const Sampling&) = delete;
    Sampling& operator=(const Sampling&) = delete;

    bool isDone() const override { return _job->isDone; }
    std::shared_ptr<const DistanceGrid> grid() const override
    {
        return isDone() ? _job->grid : nullptr;
    }

private:
    std::shared_ptr<Job> _job;
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
    {
        static Sampler sampler;
        const auto job = std::make_shared<Job>();
        job->mesh = std::move(mesh);
        job->name = name;
        sampler.add(job);
        sampling = std::make_shared<Sampling>(job);
    }
    shared = sampling;
    for (auto each = known.begin(); each != known.end();)
        each = each->second.expired() ? known.erase(each) : std::next(each);
    return sampling;
}

} // namespace osgTerrainLight
