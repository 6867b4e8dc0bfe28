#include "FarRadiance.h"
#include "Join.h"
#include "Parts.h"
#include "Pipeline.h"
#include "Terrain.h"
#include "Windows.h"
#include "io/InputFiles.h"

#include <cpl_string.h>
#include <gdal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <limits>

namespace osgTerrainLight::tool
{
namespace
{
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What a file is told from a later one by.
/// However the path is spelt.
std::string canonical(const std::string& path)
{
    std::error_code failure;
    const fs::path result = fs::weakly_canonical(path, failure);
    return failure || path.compare(0, 4, "/vsi") == 0 ? path : result.string();
}

/// All that a window's values depend on. How they are joined does not matter, nor who computes
/// them; --memory counts where it is given, since it chooses the windows.
Lines fingerprintOf(const RasterOptions& options, const Product& product)
{
    constexpr const char* idle[] = {"--help", "--quiet", "--job", "--cache",
                                    "--of",   "--co",    "OUTPUT"};
    Lines lines = {
        {"the version", OSGTERRAINLIGHT_VERSION},
        {"the mode", product.mode},
        {"the kind of output", product.kind == Product::Kind::Floats ? "values" : "a picture"}};
    for (const CLI::Option* option : options.app->get_options())
    {
        const std::string name = option->get_name();
        if (option->count() > 0 &&
            std::none_of(std::begin(idle), std::end(idle),
                         [&name](const char* other) { return name == other; }))
            lines.emplace_back(name, name == "INPUT" ? canonical(options.input)
                                                     : CLI::detail::join(option->results(), " "));
    }
    std::vector<std::string> inputs = options.extent.surroundings;
    inputs.insert(inputs.begin(), {options.input, options.albedoFile, product.skyFile});
    for (const std::string& input : inputs)
        for (const std::string& file : input.empty() ? std::vector<std::string>() : filesOf(input))
            lines.emplace_back("file " + canonical(file), stateOfFile(file));
    return lines;
}

/// A run over the windows of a raster.
class WindowRun
{
public:
    WindowRun(const RasterOptions& options, const Product& product, const Setup& setup)
        : _options(options), _product(product), _setup(setup), _lines(options.output.quiet)
    {
    }

    Status run()
    {
        if (_setup.settings.bounceMethod != BounceMethod::Slices)
            return Error{ErrorCode::NotSupported,
                         "--bounce-method " + std::string(toString(_setup.settings.bounceMethod)) +
                             ": sees nothing beyond what is lit in one piece, and " +
                             _options.input +
                             " is lit in windows: needs slices, or a part that fits into --memory"};
        if (_product.kind == Product::Kind::Exr)
            return Error{ErrorCode::NotSupported,
                         _options.output.path +
                             ": an OpenEXR file is written in one piece, and this raster is lit "
                             "in windows, for --memory, --job or the light that bounces from "
                             "beyond it: needed GeoTIFF (.tif), or a part that fits and "
                             "--isolated"};
        GDALSetCacheMax64(
            std::min<GIntBig>(GDALGetCacheMax64(),
                              std::clamp<GIntBig>(static_cast<GIntBig>(_options.extent.memory / 8),
                                                  32 << 20, 256 << 20)));
        Result<std::unique_ptr<Parts>> parts =
            Parts::open(_options.output.path, fingerprintOf(_options, _product),
                        _options.extent.job, [this] { return decide(); });
        if (!parts)
            return parts.error();
        _parts = std::move(*parts);
        if (Status followed = follow(); !followed)
            return followed;
        if (Status lit = lightAll(); !lit)
            return stopped(lit.error());
        if (const auto& job = _options.extent.job)
        {
            say("job " + std::to_string(job->index) + " of " + std::to_string(job->count) +
                    " is done, " + state() + ": the same command without --job joins them",
                true);
            return Nothing{};
        }
        if (Status joined = join(); !joined)
            return stopped(joined.error());
        return Nothing{};
    }

private:
    const PixelWindow& part() const { return _setup.info.window; }

    void say(const std::string& sentence, bool mustBeSeen = false)
    {
        _lines.say(_product.mode + ": " + sentence, mustBeSeen);
    }

    /// What all runs and jobs keep to: the size of windows and, by a budget, the settings.
    Result<Lines> decide()
    {
        const int bands = static_cast<int>(_product.bands.size());
        const int side = _options.extent.windowSize > 0
                             ? _options.extent.windowSize
                             : windowSide(_options.extent.memory, _setup.costs, bands);
        Lines decided = {{"window size", std::to_string(side)}};
        if (!_options.maxError && !_options.maxMilliseconds)
            return decided;
        _grid.emplace(part().width, part().height, side);
        // The window in the middle or, where that is void, the next one that is not.
        const int count = _grid->count();
        const int middle = _grid->rows() / 2 * _grid->columns() + _grid->columns() / 2;
        Result<LitTile> lit = read(middle);
        for (int i = 1; lit && lit->tile().validCount() == 0 && i < count; ++i)
            lit = read((middle + i) % count);
        if (!lit)
            return lit.error();
        say("choosing settings on the window in the middle", true);
        if (Status chosen = choose(*lit, _options, _product, 1.0 / _grid->count(), [](double) {});
            !chosen)
            return Error{chosen.error().code, _options.input + ": " + chosen.error().message};
        lit->release();
        decided.emplace_back("azimuths", std::to_string(lit->settings.azimuths));
        decided.emplace_back("quality", toString(lit->settings.quality));
        decided.emplace_back("error", CPLSPrintf("%.17g", lit->choice->error));
        decided.emplace_back("milliseconds", CPLSPrintf("%.17g", lit->choice->milliseconds));
        return decided;
    }

    /// Takes what was decided, by this run or one before, and says how far that came.
    Status follow()
    {
        const int side = std::atoi(_parts->decided("window size").c_str());
        if (side < 1)
            return Error{ErrorCode::Invalid,
                         _parts->folder() + ": is damaged: needs to be removed"};
        _grid.emplace(part().width, part().height, side);
        if (const std::string azimuths = _parts->decided("azimuths"); !azimuths.empty())
        {
            SettingsChoice choice;
            choice.settings = _setup.settings;
            choice.settings.azimuths = std::atoi(azimuths.c_str());
            const Setting<LightingSettings>& quality = *findSetting<LightingSettings>("quality");
            const Result<SettingValue> value =
                quality.read(_parts->decided("quality"), quality.name);
            if (!value)
                return value.error();
            quality.set(choice.settings, *value);
            choice.error = std::atof(_parts->decided("error").c_str());
            choice.milliseconds = std::atof(_parts->decided("milliseconds").c_str());
            _choice = choice;
        }
        if (!_parts->whyAnew().empty())
            say("starting anew: " + _parts->whyAnew(), true);
        if (const int there = _parts->count(_grid->count()); there > 0)
            say("going on: " + std::to_string(there) + " of " + std::to_string(_grid->count()) +
                    (there == 1 ? " windows was done" : " windows were done"),
                true);
        else
            say(std::to_string(_grid->count()) + (_grid->count() == 1 ? " window" : " windows") +
                    " of at most " + std::to_string(_grid->windowWidth()) + " x " +
                    std::to_string(_grid->windowHeight()) + " posts",
                true);
        return Nothing{};
    }

    /// Opens what computing needs, once.
    Status equip()
    {
        if (_terrain)
            return Nothing{};
        Result<Gpu> gpu = openGpu();
        if (!gpu)
            return gpu.error();
        _gpu = std::make_shared<Gpu>(std::move(*gpu));
        Result<std::unique_ptr<RasterSource>> terrain =
            openTerrain(_options, [this](double done)
                        { say("coarse levels of the terrain, " + percent(done)); });
        if (!terrain)
            return terrain.error();
        _terrain = std::move(*terrain);
        return Nothing{};
    }

    /// Lights the coarse levels, where windows receive bounced light from them.
    Status lightAround()
    {
        if (_setup.settings.bounces == 0 || _radiance)
            return Nothing{};
        _radiance = std::make_unique<FileRadiance>(_parts->folder());
        FileLock lock(_parts->folder() + "/light.lock"); // jobs wait for the first of them
        lock.lock(FileLock::Kind::Exclusive, true);
        FarLighting lighting;
        lighting.settings = _setup.settings;
        if (_choice)
            lighting.settings = _choice->settings;
        lighting.sky = _product.sky;
        lighting.side = std::max(_grid->windowWidth(), _grid->windowHeight());
        if (!_options.albedoFile.empty())
            lighting.albedo = [this](int level, const PostRect& posts) {
                return albedoOfLevel(_options.albedoFile, _setup.info, level, posts,
                                     _setup.settings.albedo);
            };
        lighting.progress = [this](double done)
        { say("light of the terrain's coarse levels, " + percent(done)); };
        return lightLevels(_gpu->state(), *_terrain, lighting, *_radiance);
    }

    /// The window's tile, its margin with it, not lit yet.
    Result<LitTile> read(int index)
    {
        if (Status equipped = equip(); !equipped)
            return equipped.error();
        LitTile lit = tileFor(_options, _setup, _gpu);
        lit.isAlone = false;
        Result<std::shared_ptr<const TileWindows>> terrain =
            readWindows(*_terrain, 0, litAround(index),
                        _choice ? _choice->settings.quality : _setup.settings.quality);
        if (!terrain)
            return terrain.error();
        lit.terrain = *terrain;
        if (_radiance)
        {
            Result<std::shared_ptr<const FarLight>> light =
                readFarLight(*_radiance, 0, _setup.settings.bounces, *lit.terrain);
            if (!light)
                return light.error();
            lit.farLight = *light;
        }
        lit.frame = frameOf(_grid->at(index), _setup.info.frame);
        if (_choice)
        {
            lit.choice = _choice;
            lit.settings = _choice->settings;
        }
        if (_options.albedoFile.empty())
            return lit;
        Result<Raster<Rgb>> albedo = albedoOfLevel(_options.albedoFile, _setup.info, 0,
                                                   lit.terrain->place, _setup.settings.albedo);
        if (!albedo)
            return albedo.error();
        lit.albedo = std::move(*albedo);
        return lit;
    }

    /// A window with its margin, where there is terrain, beyond what is asked for too.
    PostRect litAround(int index) const
    {
        return postsOf(_grid->at(index), _setup.info.frame)
            .grownBy(marginOf(_setup.settings))
            .clippedTo(_terrain->extent(0));
    }

    /// The values of a window alone, of a band of the tile.
    Raster<float> core(int index, const Raster<float>& values) const
    {
        const RasterFrame& frame = _setup.info.frame;
        const PostRect inner = postsOf(_grid->at(index), frame);
        const PostRect outer = litAround(index);
        Raster<float> result(inner.width, inner.height);
        for (int row = 0; row < inner.height; ++row)
            for (int column = 0; column < inner.width; ++column)
                result.at(column, row) =
                    values.at(inner.column - outer.column + column, inner.row - outer.row + row);
        return result;
    }

    Status light(int index)
    {
        Result<LitTile> lit = read(index);
        if (!lit)
            return lit.error();
        BandValues values;
        if (lit->tile().validCount() == 0)
            values = [&lit](int)
            {
                return Raster<float>(lit->tile().width(), lit->tile().height(),
                                     std::numeric_limits<float>::quiet_NaN());
            };
        else
        {
            if (Status computed = compute(*lit, _product, [](double) {}); !computed)
                return computed;
            values = _product.values(*lit);
            _dropped += lit->lighting ? lit->lighting->readDroppedVertices(lit->state()) : 0;
            _azimuths = lit->azimuths;
            _seconds += lit->seconds;
        }
        const Status written = writeBands(
            partOptions(_parts->path(index)), lit->frame, _product.bands, _product.metadata(*lit),
            [&](int band) { return core(index, values(band)); }, [](double) {});
        lit->release();
        return written;
    }

    Status lightAll()
    {
        std::vector<int> missing;
        const int count = _grid->count();
        const auto& job = _options.extent.job;
        for (int index = 0; index < count; ++index)
            if ((!job || index % job->count == job->index - 1) && !_parts->has(index))
                missing.push_back(index);
        if (!missing.empty())
        {
            if (Status equipped = equip(); !equipped)
                return equipped;
            if (Status lit = lightAround(); !lit)
                return lit;
        }
        const int there = _parts->count(count);
        const auto start = Clock::now();
        const std::size_t all = missing.size();
        for (std::size_t i = 0; i < all; ++i)
        {
            const int index = missing[i];
            _words.set("interrupted: " + goesOn(there + static_cast<int>(i)));
            const std::string left =
                i == 0 ? ""
                       : ", " + timeLeft(secondsSince(start) / static_cast<double>(i) *
                                         static_cast<double>(all - i));
            say("window " + std::to_string(index + 1) + " of " + std::to_string(count) + left,
                i == 0 || i + 1 == all);
            if (Status lit = light(index); !lit)
                return Error{lit.error().code, "window " + std::to_string(index + 1) + " of " +
                                                   std::to_string(count) + " (" + place(index) +
                                                   "): " + lit.error().message};
            ++_windows;
            _posts += double(_grid->at(index).width) * _grid->at(index).height;
        }
        if (_terrain)
            sayNotes(_options.input, _terrain->notes(), _setup.info.notes.size());
        return Nothing{};
    }

    Status join()
    {
        LitTile lit = tileFor(_options, _setup, _gpu);
        lit.seconds = _seconds;
        lit.azimuths = _azimuths;
        if (_choice)
        {
            lit.choice = _choice;
            lit.settings = _choice->settings;
        }
        Metadata metadata = _product.metadata(lit);
        add(metadata, "WINDOWS",
            std::to_string(_grid->windowWidth()) + "," + std::to_string(_grid->windowHeight()));
        _words.set("interrupted: " + goesOn(_grid->count()));
        say("joining " + state(), true);
        if (Status joined =
                joinParts(*_parts, *_grid, _options.output, _product, _setup.info.frame, metadata,
                          [this](double done) { say("joining, " + percent(done)); });
            !joined)
            return joined;
        _parts->remove();
        if (_options.output.quiet)
            return Nothing{};
        say("done", true);
        if (_posts > 0.0)
            summarise(lit, _product, _posts,
                      " for " + std::to_string(_windows) +
                          (_windows < _grid->count() ? " of " + std::to_string(_grid->count())
                                                     : std::string()) +
                          " windows" +
                          (_dropped > 0 ? ", " + std::to_string(_dropped) + " hull vertices dropped"
                                        : ""));
        return Nothing{};
    }

    static std::string percent(double fraction) { return CPLSPrintf("%.0f %%", 100.0 * fraction); }

    /// In pixels of the raster.
    std::string place(int index) const
    {
        const PixelWindow window = infoOf(_grid->at(index), _setup.info).window;
        return "columns " + std::to_string(window.column) + " to " +
               std::to_string(window.column + window.width - 1) + ", rows " +
               std::to_string(window.row) + " to " +
               std::to_string(window.row + window.height - 1) + " of " + _options.input;
    }

    std::string state(int done) const
    {
        return std::to_string(done) + " of " + std::to_string(_grid->count()) + " windows";
    }
    std::string state() const { return state(_parts->count(_grid->count())); }
    std::string goesOn(int done) const
    {
        return state(done) + " are done; the same command goes on from there";
    }
    Error stopped(const Error& error) const
    {
        return {error.code, error.message + "; " + goesOn(_parts->count(_grid->count()))};
    }

    const RasterOptions& _options;
    const Product& _product;
    const Setup& _setup;
    ProgressLines _lines;
    LastWords _words;
    std::unique_ptr<Parts> _parts;
    std::optional<WindowGrid> _grid;
    std::optional<SettingsChoice> _choice;
    std::shared_ptr<Gpu> _gpu;
    std::unique_ptr<RasterSource> _terrain;
    std::unique_ptr<FileRadiance> _radiance; ///< null: no light comes from around windows
    // Of this run.
    int _windows = 0;
    double _posts = 0.0, _seconds = 0.0;
    int _azimuths = 0;
    unsigned _dropped = 0;
};

} // namespace

bool windowsWait(const RasterOptions& options, const Product& product)
{
    return Parts::wait(options.output.path, [&] { return fingerprintOf(options, product); });
}

Status processInWindows(const RasterOptions& options, const Product& product, const Setup& setup)
{
    return WindowRun(options, product, setup).run();
}

} // namespace osgTerrainLight::tool
