#include "BenchOptions.h"

#include "BenchTruth.h"
#include "core/SyntheticTerrain.h"

#include <algorithm>

namespace osgTerrainLight::tool::bench
{
namespace
{

std::string listOfMethods()
{
    std::string list;
    for (const Method& method : allMethods())
        list += (list.empty() ? "" : ", ") + method.name + " (" + method.meaning + ")";
    return list;
}

void addMethods(CLI::App& app, std::vector<const Method*>& chosen)
{
    for (const Method& method : allMethods())
        if (method.byDefault)
            chosen.push_back(&method);
    const auto read = [&chosen](const std::string& given)
    {
        const std::vector<Method>& all = allMethods();
        chosen.clear();
        for (const std::string& name : CLI::detail::split(given, ','))
        {
            const auto found = std::find_if(all.begin(), all.end(),
                                            [&](const Method& m) { return m.name == name; });
            if (found == all.end())
                throw CLI::ValidationError("--methods",
                                           "'" + name + "' is no method: needs " + listOfMethods());
            if (std::find(chosen.begin(), chosen.end(), &*found) == chosen.end())
                chosen.push_back(&*found);
        }
    };
    app.add_option_function<std::string>(
           "--methods", read,
           "Methods, separated by commas; default all but the last three: " + listOfMethods())
        ->type_name("LIST");
}

void addAzimuthList(CLI::App& app, std::vector<int>& azimuths)
{
    const auto read = [&azimuths](const std::string& given)
    {
        azimuths.clear();
        for (const std::string& part : CLI::detail::split(given, ','))
        {
            double value = 0.0;
            if (!CLI::detail::lexical_cast(part, value))
                throw CLI::ValidationError("--azimuths", "'" + given + "': needs numbers, LIST");
            if (const std::string wrong =
                    findSetting<LightingSettings>("azimuths")->complaint(value);
                !wrong.empty())
                throw CLI::ValidationError("--azimuths", wrong);
            azimuths.push_back(static_cast<int>(value));
        }
        std::sort(azimuths.begin(), azimuths.end());
        azimuths.erase(std::unique(azimuths.begin(), azimuths.end()), azimuths.end());
    };
    app.add_option_function<std::string>(
           "--azimuths", read,
           "Numbers of azimuths, each a multiple of 4, 4 ... 256; default 8,16,32,64")
        ->type_name("LIST");
}

/// --bounces, --albedo, --paths.
void addIndirect(CLI::App& app, Options& options)
{
    CLI::Option* bounces = addSetting(app, "bounces", options.settings);
    addSetting(app, "albedo", options.settings)->needs(bounces);
    addLimitedNumbers(app, "--paths", "N", {{"paths", 64.0, 67108864.0, true}},
                      "Paths per post that the light of bounces is compared with, rounded up to a "
                      "power of 2; default: until their noise is a fifth of the smallest error, at "
                      "most " +
                          std::to_string(IndirectTruth::mostPaths),
                      [&options](const auto& v)
                      { options.paths = static_cast<std::uint64_t>(v[0]); })
        ->needs(bounces);
}

CLI::Option* addGenerated(CLI::App& app, Options& options)
{
    const auto read = [&options](const std::string& given)
    {
        const std::vector<std::string> parts = CLI::detail::split(given, ',');
        TerrainKind kind = TerrainKind::Fractal;
        double seed = 1.0;
        if (parts.size() > 2 || !fromString(parts[0], kind) ||
            (parts.size() == 2 && !CLI::detail::lexical_cast(parts[1], seed)))
            throw CLI::ValidationError("--generate", "'" + given +
                                                         "': needs fractal, crater, cliffs or "
                                                         "spikes, and a seed where wanted");
        if (const std::string wrong = Limits{"seed", 0.0, 4294967295.0, true}.complaint(seed);
            !wrong.empty())
            throw CLI::ValidationError("--generate", wrong);
        options.generated = parts[0];
        options.terrainSeed = static_cast<std::uint32_t>(seed);
    };
    return app
        .add_option_function<std::string>(
            "--generate", read, "Measures a generated terrain: fractal, crater, cliffs or spikes")
        ->type_name("KIND[,SEED]");
}

CLI::Option* addSpacing(CLI::App& app, Options& options)
{
    return addLimitedNumbers(app, "--spacing", "METRES", {{"spacing", 0.001, 10000.0, false}},
                             "Distance between generated posts, 0.001 ... 10000; default 30",
                             [&options](const auto& v) { options.spacing = v[0]; });
}

/// --posts, --seed, --repeats.
void addEffort(CLI::App& app, Options& options)
{
    addLimitedNumbers(
        app, "--posts", "N", {{"posts", 0.0, 1000000.0, true}},
        "Random posts at which the error is measured (the sun's at 10 N, that of bounces "
        "at N/10); 0: cost alone; default " +
            std::to_string(options.posts),
        [&options](const auto& v) { options.posts = static_cast<std::size_t>(v[0]); });
    addLimitedNumbers(app, "--seed", "N", {{"seed", 0.0, 4294967295.0, true}},
                      "Which random posts, or scenes of --objects; default 1",
                      [&options](const auto& v)
                      { options.seed = static_cast<std::uint32_t>(v[0]); });
    addLimitedNumbers(
        app, "--repeats", "N", {{"repeats", 1.0, 1000.0, true}},
        "Rounds, in each of which every row runs twice, the first time to warm up (once "
        "where that takes 20 s); times are medians; default 5",
        [&options](const auto& v) { options.repeats = static_cast<int>(v[0]); });
}

/// --objects, --scenes, --places. Of the mode's other options those that say what of a terrain is
/// measured do not go with them.
void addObjects(CLI::App& app, Options& options)
{
    CLI::Option* objects = app.add_flag(
        "--objects", options.objects,
        "Measures sky light on and around placed objects, in place of a terrain: how the library's "
        "cones, an ambient cube and samples along the normal (Evans 2006) compare with rays, in "
        "generated scenes on a plain, in a valley and on rough ground");
    for (CLI::Option* option : app.get_options())
        if (option != objects && !option->check_lname("seed") && !option->check_lname("repeats") &&
            !option->check_lname("help") && !option->check_lname("csv") &&
            !option->check_lname("json") && !option->check_lname("plot") &&
            !option->check_lname("quiet") && !option->check_lname("config"))
            objects->excludes(option);
    addLimitedNumbers(app, "--scenes", "N", {{"scenes", 1.0, 256.0, true}},
                      "Scenes with objects on each ground, of four kinds in turn; default " +
                          std::to_string(options.scenes),
                      [&options](const auto& v) { options.scenes = static_cast<int>(v[0]); })
        ->needs(objects);
    addLimitedNumbers(app, "--places", "N", {{"places", 4.0, 10000.0, true}},
                      "Places in each scene, half of them on the ground and a quarter each on "
                      "walls and roofs; default " +
                          std::to_string(options.places),
                      [&options](const auto& v) { options.places = static_cast<int>(v[0]); })
        ->needs(objects);
}

/// --csv, --json, --plot.
void addFiles(CLI::App& app, Options& options)
{
    app.add_option("--csv", options.csv, "Table to write, a line per row")->type_name("FILE");
    app.add_option("--json", options.json, "The same with device, date and terrain")
        ->type_name("FILE");
    app.add_option("--plot", options.plot, "Picture to write; needs the program gnuplot")
        ->type_name("FILE.svg");
}

} // namespace

const std::vector<Method>& allMethods()
{
    // A new method is a line here.
    static const std::vector<Method> methods = {
        {"sweep-draft", "--quality draft",
         [](LightingSettings& s) { s.quality = HorizonQuality::Draft; }},
        {"sweep-normal", "--quality normal",
         [](LightingSettings& s) { s.quality = HorizonQuality::Normal; }},
        {"sweep-best", "--quality best",
         [](LightingSettings& s) { s.quality = HorizonQuality::Best; }},
        {"legendre", "--bounce-method legendre",
         [](LightingSettings& s) { s.bounceMethod = BounceMethod::Legendre; }, true},
        {"legendre-bspline", "--bounce-method legendre-bspline",
         [](LightingSettings& s) { s.bounceMethod = BounceMethod::LegendreBSpline; }, true, false},
        {"legendre-2", "legendre with --subsampling 2",
         [](LightingSettings& s)
         {
             s.bounceMethod = BounceMethod::Legendre;
             s.subsampling = 2;
         },
         true, false},
        {"legendre-4", "legendre with --subsampling 4",
         [](LightingSettings& s)
         {
             s.bounceMethod = BounceMethod::Legendre;
             s.subsampling = 4;
         },
         true, false},
    };
    return methods;
}

void addOptions(CLI::App& app, Options& options)
{
    CLI::Option* input =
        app.add_option("INPUT", options.input, "DEM: any raster that GDAL reads")->type_name("");
    addReadOptions(app, options.read);
    CLI::Option* generate = addGenerated(app, options)->excludes(input);
    addSize(app, options.width, options.height,
            "Posts of the generated terrain; one number: a square; default 1024");
    CLI::Option* spacing = addSpacing(app, options);
    for (CLI::Option* option : {app.get_option("--size"), spacing})
        option->needs(generate);
    for (const char* option : {"--srcwin", "--band", "--cell-size"})
        app.get_option(option)->excludes(generate);
    addMethods(app, options.methods);
    addSetting(app, "quality", options.settings);
    addAzimuthList(app, options.azimuths);
    addSun(app, options.sky);
    addSetting(app, "sun-radius", options.sky);
    app.add_flag_function(
        "--no-sun", [&options](std::int64_t) { options.sky.sunEnabled = false; }, "Sky light only");
    addIndirect(app, options);
    addEffort(app, options);
    addFiles(app, options);
    app.add_flag("-q,--quiet", options.quiet, "No progress; the table stays");
    addObjects(app, options);
    addConfig(app);
}

} // namespace osgTerrainLight::tool::bench
