// bench: what it measures against what the other modes write and the reference says; its files.
#include "ToolRun.h"

#include <osgTerrainLight/SkyLight.h>

#include "io/DemReader.h"
#include "reference/ReferenceLight.h"

#include <cpl_json.h>
#include <ogrsf_frmts.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>
#include <map>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

const std::vector<std::string> quantities = {"horizon", "sky", "sun", "light"};
const std::vector<std::string> allMethods = {"sweep-draft", "sweep-normal", "sweep-best"};

/// The columns that docs/TOOL.md promises.
const char* const columns =
    "method,azimuths,gpu_horizon_ms,gpu_sky_ms,gpu_sun_ms,gpu_shade_ms,gpu_ms,wall_ms,memory_bytes,"
    "horizon_mean_deg,horizon_rms_deg,horizon_p99_deg,horizon_max_deg,horizon_bias_deg,"
    "horizon_relative_rms,horizon_front,"
    "sky_mean_factor,sky_rms_factor,sky_p99_factor,sky_max_factor,sky_bias_factor,"
    "sky_relative_rms,sky_front,"
    "sun_mean_fraction,sun_rms_fraction,sun_p99_fraction,sun_max_fraction,sun_bias_fraction,"
    "sun_relative_rms,sun_front,"
    "light_mean_luminance,light_rms_luminance,light_p99_luminance,light_max_luminance,"
    "light_bias_luminance,light_relative_rms,light_front,skipped";

/// And with --bounces.
std::string withBounces(std::string names)
{
    names.insert(names.find("gpu_ms"), "gpu_pyramid_ms,gpu_bounce_ms,");
    names.insert(names.find("skipped"),
                 "indirect_mean_luminance,indirect_rms_luminance,indirect_p99_luminance,"
                 "indirect_max_luminance,indirect_bias_luminance,indirect_relative_rms,"
                 "indirect_relative_noise,indirect_front,");
    return names;
}

/// Fields of CSV; quotes go.
std::vector<std::string> split(const std::string& line)
{
    std::vector<std::string> parts(1);
    bool inQuotes = false;
    for (const char c : line)
        if (c == '"')
            inQuotes = !inQuotes;
        else if (c == ',' && !inQuotes)
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

/// A row of the CSV by column.
using Record = std::map<std::string, std::string>;

std::vector<Record> readCsv(const std::string& path, bool bounces = false)
{
    std::istringstream file(contentOf(path));
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, bounces ? withBounces(columns) : columns);
    const std::vector<std::string> names = split(line);
    std::vector<Record> records;
    while (std::getline(file, line))
    {
        const std::vector<std::string> values = split(line);
        EXPECT_EQ(values.size(), names.size()) << line;
        Record record;
        for (std::size_t k = 0; k < std::min(names.size(), values.size()); ++k)
            record[names[k]] = values[k];
        records.push_back(record);
    }
    return records;
}

double number(const Record& record, const std::string& column)
{
    return record.at(column).empty() ? std::nan("") : std::stod(record.at(column));
}

/// The error that a quantity's front is about.
std::string mainColumn(const std::string& quantity)
{
    return quantity == "horizon" ? "horizon_mean_deg"
           : quantity == "sun"   ? "sun_rms_fraction"
                                 : quantity + "_relative_rms";
}

/// Columns of errors: the same in every run with the same posts.
bool isError(const std::string& column)
{
    for (const std::string& quantity : quantities)
        if (column.rfind(quantity + "_", 0) == 0 && column != quantity + "_front")
            return true;
    return false;
}

Record errorsOf(const Record& record)
{
    Record errors;
    for (const auto& [column, value] : record)
        if (isError(column))
            errors[column] = value;
    return errors;
}

bool has(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

/// All text of a well-formed SVG, each between bars.
std::string labelsOf(const std::string& path)
{
    pugi::xml_document picture;
    const pugi::xml_parse_result parsed = picture.load_file(path.c_str());
    EXPECT_TRUE(parsed) << parsed.description();
    EXPECT_STREQ(picture.document_element().name(), "svg");
    std::string labels = "|";
    for (const pugi::xpath_node& node : picture.select_nodes("//*[local-name()='text']"))
        labels += std::string(node.node().first_child().text().get()) + "|";
    return labels;
}

/// What the tool says of errors, computed anew.
struct Errors
{
    std::vector<double> sizes;
    double sum = 0.0, squares = 0.0, expectedSquares = 0.0;

    void add(double found, double expected)
    {
        sizes.push_back(std::abs(found - expected));
        sum += found - expected;
        squares += (found - expected) * (found - expected);
        expectedSquares += expected * expected;
    }
    void expectIn(const Record& record, const std::string& name, const std::string& unit,
                  double tolerance)
    {
        SCOPED_TRACE(name);
        std::sort(sizes.begin(), sizes.end());
        const double count = static_cast<double>(sizes.size());
        double mean = 0.0;
        for (const double size : sizes)
            mean += size / count;
        const auto expectNear = [&](const std::string& statistic, double expected)
        {
            EXPECT_NEAR(number(record, name + "_" + statistic + "_" + unit), expected, tolerance)
                << statistic;
        };
        expectNear("mean", mean);
        expectNear("rms", std::sqrt(squares / count));
        expectNear("p99", sizes[sizes.size() * 99 / 100]);
        expectNear("max", sizes.back());
        expectNear("bias", sum / count);
        EXPECT_NEAR(number(record, name + "_relative_rms"), std::sqrt(squares / expectedSquares),
                    tolerance / std::sqrt(expectedSquares / count));
    }
};

using BenchMistakes = ToolTest;
using Bench = GlToolTest;

TEST_F(BenchMistakes, AreRefusedBeforeTheWork)
{
    std::filesystem::copy_file(jacksboro, path("dem.tif"));
    std::filesystem::create_symlink("dem.tif", path("link.csv"));
    const auto before = left();
    const struct
    {
        const char* arguments;
        int status;
        std::vector<const char*> complaints;
    } mistakes[] = {
        {"", 2, {"INPUT", "--generate"}},
        {"dem.tif more.tif", 2, {"more.tif"}},
        {"dem.tif --generate fractal", 2, {"INPUT", "--generate"}},
        {"--generate hills", 2, {"--generate", "hills", "fractal, crater, cliffs or spikes"}},
        {"--generate fractal,1,2", 2, {"--generate", "fractal,1,2"}},
        {"--generate fractal,x", 2, {"--generate", "fractal,x"}},
        {"--generate fractal,1.5", 2, {"seed", "1.5", "whole"}},
        {"--generate fractal -srcwin 0 0 4 4", 2, {"-srcwin", "--generate"}},
        {"--generate fractal --band 2", 2, {"--band", "--generate"}},
        {"dem.tif --size 8", 2, {"--size", "--generate"}},
        {"dem.tif --spacing 8", 2, {"--spacing", "--generate"}},
        {"dem.tif --azimuths 8,30", 2, {"--azimuths", "30", "multiple of 4, 4 ... 256"}},
        {"dem.tif --azimuths 8,,16", 2, {"--azimuths", "8,,16"}},
        {"dem.tif --azimuths many", 2, {"--azimuths", "many"}},
        {"dem.tif --methods sweep-best,slow", 2, {"'slow'", "sweep-draft", "sweep-best"}},
        {"dem.tif --posts -1", 2, {"posts", "-1", "0 ... 1000000"}},
        {"dem.tif --posts 0 --plot p.svg", 2, {"--plot", "needs --posts 1 or more"}},
        {"dem.tif --repeats 0", 2, {"repeats", "0", "1 ... 1000"}},
        {"dem.tif --seed -1", 2, {"seed", "-1"}},
        {"dem.tif --sun 315", 2, {"--sun", "AZ,EL"}},
        {"dem.tif --bounces 9", 2, {"bounces", "9", "0 ... 8"}},
        {"dem.tif --bounces 1 --albedo 1.5", 2, {"albedo", "1.5", "0 ... 1"}},
        {"dem.tif --bounces 1 --albedo 0.5,0.5", 2, {"--albedo", "one number or three"}},
        {"dem.tif --bounces 1 --albedo grey", 2, {"--albedo", "grey"}},
        {"dem.tif --bounces 1 --albedo 0,0,0", 2, {"--albedo", "nothing bounces"}},
        {"dem.tif --albedo 0.5", 2, {"--albedo", "--bounces"}},
        {"dem.tif --paths 1000", 2, {"--paths", "--bounces"}},
        {"--generate fractal --size 32 --methods legendre", 2, {"--methods", "--bounces"}},
        {"dem.tif --bounces 1 --paths 10", 2, {"paths", "10", "64 ... 67108864"}},
        {"dem.tif --plot p.png", 2, {"--plot", "p.png", ".svg"}},
        {"dem.tif --csv dem.tif", 2, {"--csv", "dem.tif is the file of INPUT"}},
        {"dem.tif --csv link.csv", 2, {"--csv", "link.csv is the file of INPUT"}},
        {"dem.tif --csv a --json ./a", 2, {"--json", "./a is the file of --csv"}},
        {"dem.tif --csv nowhere/a.csv", 1, {"nowhere/a.csv", "existing folder"}},
        {"dem.tif --json .", 1, {"is a folder"}},
        {"dem.tif --json /dev/null", 1, {"/dev/null", "device"}},
        {"missing.tif", 1, {"missing.tif", "no such file"}},
    };
    for (const auto& mistake : mistakes)
    {
        SCOPED_TRACE(mistake.arguments);
        const ToolRun result = run(std::string("bench ") + mistake.arguments);
        EXPECT_EQ(result.status, mistake.status);
        EXPECT_EQ(result.out.find("Cost"), std::string::npos);
        EXPECT_EQ(result.err.rfind("terrainlight: ", 0), 0u) << result.err;
        for (const char* complaint : mistake.complaints)
            EXPECT_TRUE(result.complains(complaint)) << complaint << " not in: " << result.err;
        EXPECT_EQ(left(), before);
    }
}

TEST_F(BenchMistakes, PictureNeedsGnuplot)
{
    const ToolRun result =
        run("bench " + jacksboro + " --plot p.svg --csv c.csv", "export PATH=/nowhere");
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.complains("--plot needs the program gnuplot")) << result.err;
    EXPECT_TRUE(left().empty());
}

/// Times and bytes of a row of 2 runs over 70 x 50 posts.
void expectCosts(const Record& record)
{
    double sum = 0.0;
    for (const char* stage : {"horizon", "sky", "sun", "shade"})
    {
        const double milliseconds = number(record, std::string("gpu_") + stage + "_ms");
        EXPECT_GT(milliseconds, 0.0) << stage;
        sum += milliseconds;
    }
    // A median of sums is no sum of medians, but of 2 runs the median is the mean.
    EXPECT_NEAR(number(record, "gpu_ms"), sum, 1e-9 * sum);
    // Wall clock holds the timer queries and what the driver does around them, too.
    EXPECT_GT(number(record, "wall_ms"), 0.99 * sum);
    EXPECT_GT(number(record, "memory_bytes"), 70.0 * 50.0 * 2.0 * number(record, "azimuths"));
}

void expectSameRow(const CPLJSONObject& row, const Record& record)
{
    for (const std::string& column : split(columns))
    {
        const std::string& field = record.at(column);
        if (column == "method")
            EXPECT_EQ(row.GetString(column), field);
        else if (field.empty())
            EXPECT_EQ(row.GetObj(column).GetType(), CPLJSONObject::Type::Null) << column;
        else
            // GDAL rounds to 15 digits where the 17 look like one that was rounded.
            EXPECT_NEAR(row.GetDouble(column), std::stod(field), 1e-14 * std::abs(std::stod(field)))
                << column;
    }
}

/// What it says of the run of the test below; printed: what the tool printed.
void expectFactsOfTheRun(const CPLJSONObject& root, const std::string& printed)
{
    EXPECT_EQ(root.GetInteger("terrain/width"), 70);
    EXPECT_EQ(root.GetInteger("terrain/valid_posts"), 3500);
    EXPECT_EQ(root.GetInteger("reference/posts"), 40);
    EXPECT_EQ(root.GetInteger("reference/sun_posts"), 400);
    EXPECT_EQ(root.GetInteger("reference/seed"), 1);
    EXPECT_EQ(root.GetInteger("repeats"), 2);
    EXPECT_EQ(root.GetDouble("sun/elevation_deg"), 35.0);
    EXPECT_TRUE(has(printed, root.GetString("device/renderer")));
    EXPECT_TRUE(has(printed, root.GetString("date")));
}

void expectPicture(const std::string& file)
{
    const std::string labels = labelsOf(file);
    for (const char* label :
         {"sweep-draft", "sweep-normal", "sweep-best", "Pareto front", "GPU milliseconds",
          "horizon elevation: mean error in degrees", "sky-view factor: relative RMS error",
          "visible fraction of the sun: RMS error", "luminance of the shading: relative RMS error",
          "8", "16"})
        EXPECT_TRUE(has(labels, std::string("|") + label + "|")) << label << " not in " << labels;
    EXPECT_TRUE(has(labels, "generated fractal, seed 3: 70 x 50 posts, ")) << labels;
    EXPECT_LT(std::filesystem::file_size(file), 60000u);
}

TEST_F(Bench, TableCsvJsonAndPictureHaveEveryRow)
{
    const ToolRun result = run("bench --generate fractal,3 --size 70,50 --azimuths 16,8,16 "
                               "--posts 40 --repeats 2 --csv c.csv --json j.json --plot p.svg");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(left(), (std::set<std::string>{"c.csv", "j.json", "p.svg"}));
    EXPECT_EQ(result.out.substr(0, result.out.find('\n')),
              "0...10...20...30...40...50...60...70...80...90...100 - done.");
    for (const char* fact :
         {"generated fractal, seed 3, 70 x 50 posts, 3500 of them valid, 30 x 30 m",
          "40 random posts (sun: 400), seed 1", "median of 2 rounds", "azimuth 315, elevation 35"})
        EXPECT_TRUE(has(result.out, fact)) << fact << " not in\n" << result.out;
    EXPECT_TRUE(has(result.out, "(software), OpenGL 4") || has(result.out, "(hardware), OpenGL 4"));

    const std::vector<Record> records = readCsv(path("c.csv"));
    ASSERT_EQ(records.size(), 6u);
    CPLJSONDocument json;
    ASSERT_TRUE(json.Load(path("j.json")));
    expectFactsOfTheRun(json.GetRoot(), result.out);
    const CPLJSONArray rows = json.GetRoot().GetArray("rows");
    ASSERT_EQ(rows.Size(), 6);
    for (std::size_t i = 0; i < records.size(); ++i)
    {
        EXPECT_EQ(records[i].at("method"), allMethods[i / 2])
            << "methods, and in each the azimuths";
        EXPECT_EQ(records[i].at("azimuths"), i % 2 == 0 ? "8" : "16");
        EXPECT_EQ(records[i].at("skipped"), "");
        expectCosts(records[i]);
        expectSameRow(rows[static_cast<int>(i)], records[i]);
    }
    // A line of each table for each row.
    for (const std::string& method : allMethods)
    {
        std::size_t lines = 0;
        for (std::size_t at = 0; (at = result.out.find(method + " ", at)) != std::string::npos;
             ++at)
            ++lines;
        EXPECT_EQ(lines, 2 * (1 + quantities.size())) << method;
    }

    // GDAL reads the CSV as a table.
    GDALAllRegister();
    const GDALDatasetUniquePtr table(GDALDataset::Open(path("c.csv").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(table);
    EXPECT_EQ(table->GetLayer(0)->GetFeatureCount(), 6);
    EXPECT_EQ(table->GetLayer(0)->GetLayerDefn()->GetFieldCount(), 38);
    expectPicture(path("p.svg"));
}

// All posts of a small tile, so that nothing depends on which were drawn. What the GPU gives comes
// from the other modes.
TEST_F(Bench, ErrorsAreThoseOfTheOtherModes)
{
    ASSERT_EQ(run("generate cliffs c.tif --size 31,23 --seed 5 -q").status, 0);
    const std::string sun = " --sun 60,10";
    const std::string settings = " --quality draft --azimuths 12 -q";
    ASSERT_EQ(run("horizon c.tif h.tif" + settings).status, 0);
    ASSERT_EQ(run("svf c.tif v.tif" + settings).status, 0);
    ASSERT_EQ(run("shadow c.tif s.tif --quality draft -q" + sun).status, 0);
    ASSERT_EQ(run("shade c.tif l.tif" + settings + sun).status, 0);
    const ToolRun result =
        run("bench c.tif --azimuths 8,12,24 --methods sweep-draft --posts 100000 "
            "--repeats 1 -q --csv b.csv" +
            sun);
    ASSERT_EQ(result.status, 0) << result.err;
    const std::vector<Record> records = readCsv(path("b.csv"));
    ASSERT_EQ(records.size(), 3u);
    ASSERT_EQ(records[1].at("azimuths"), "12");

    const DemTile tile = readDem(path("c.tif"))->tile;
    const ReadRaster horizon(path("h.tif")), sky(path("v.tif")), shadow(path("s.tif")),
        light(path("l.tif"));
    const SkyLight defaults;
    const auto luminance = [](double r, double g, double b)
    { return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
    const auto luminanceOf = [&](const Rgb& c)
    { return luminance(double(c[0]), double(c[1]), double(c[2])); };
    SkyLight placed;
    placed.sunAzimuth = 60.0;
    placed.sunElevation = 10.0;
    const std::array<double, 3> towards = placed.sunDirection();
    Errors horizonErrors, skyErrors, sunErrors, lightErrors;
    for (int row = 0; row < 23; ++row)
        for (int column = 0; column < 31; ++column)
        {
            const int fileRow = 22 - row;
            for (int band = 1; band <= 12; ++band)
                horizonErrors.add(
                    std::max(double(horizon.at(band, column, fileRow)), 0.0),
                    std::max(reference::exhaustiveHorizon(tile, column, row,
                                                          directionOfCompass((band - 1) * 30.0))
                                 .elevationDegrees(),
                             0.0));
            const auto normal = reference::surfaceNormal(tile, column, row);
            const double view =
                reference::skyViewFactor(reference::horizonRing(tile, column, row, 720),
                                         reference::SkyViewDefinition::Surface, normal);
            skyErrors.add(double(sky.at(1, column, fileRow)), view);
            const double visible =
                reference::sunFraction(tile, column, row, {60.0, 10.0, 0.2666}, 33);
            sunErrors.add(double(shadow.at(1, column, fileRow)), visible);
            const double facing =
                normal[0] * towards[0] + normal[1] * towards[1] + normal[2] * towards[2];
            lightErrors.add(luminance(double(light.at(1, column, fileRow)),
                                      double(light.at(2, column, fileRow)),
                                      double(light.at(3, column, fileRow))),
                            luminanceOf(defaults.skyRadiance) * view +
                                luminanceOf(defaults.sunIrradiance) * visible *
                                    std::max(facing, 0.0) / 3.14159265358979323846);
        }
    EXPECT_GT(horizonErrors.squares, 0.0);
    EXPECT_GT(sunErrors.squares, 0.0);
    // The bands are floats of at most 90 degrees: each is rounded by up to 2^-18. The others are
    // floats that the GPU gave, so only sums in another order differ, by 1e-16 a term.
    horizonErrors.expectIn(records[1], "horizon", "deg", 4e-6);
    skyErrors.expectIn(records[1], "sky", "factor", 1e-12);
    sunErrors.expectIn(records[1], "sun", "fraction", 1e-12);
    lightErrors.expectIn(records[1], "light", "luminance", 1e-12);
}

// By the definition that the help gives, found another way: in order of time, a row is on the front
// where its error is lower than that of every faster one.
TEST_F(Bench, FrontHoldsWhatNoOtherRowBeats)
{
    ASSERT_EQ(run("bench --generate fractal --size 64 --azimuths 4,8,16,32 --posts 60 --repeats 3 "
                  "-q --sun 90,10 --csv b.csv")
                  .status,
              0);
    const std::vector<Record> records = readCsv(path("b.csv"));
    ASSERT_EQ(records.size(), 12u);
    for (const std::string& quantity : quantities)
    {
        SCOPED_TRACE(quantity);
        std::map<double, std::vector<Record>> byTime;
        for (const Record& record : records)
            byTime[number(record, "gpu_ms")].push_back(record);
        double lowest = std::numeric_limits<double>::infinity();
        for (const auto& [time, together] : byTime)
        {
            double here = std::numeric_limits<double>::infinity();
            for (const Record& record : together)
                here = std::min(here, number(record, mainColumn(quantity)));
            for (const Record& record : together)
                EXPECT_EQ(record.at(quantity + "_front") == "1",
                          here < lowest && number(record, mainColumn(quantity)) == here)
                    << record.at("method") << ' ' << record.at("azimuths");
            lowest = std::min(lowest, here);
        }
    }
}

TEST_F(Bench, SameSeedSameErrors)
{
    const auto errors = [&](const std::string& seed)
    {
        EXPECT_EQ(run("bench " + jacksboro +
                      " -srcwin 50 60 90 80 --azimuths 8 --methods sweep-best,sweep-draft --posts "
                      "50 --repeats 1 -q --sun 100,5 --csv b.csv --seed " +
                      seed)
                      .status,
                  0);
        std::vector<Record> result;
        for (const Record& record : readCsv(path("b.csv")))
            result.push_back(errorsOf(record));
        return result;
    };
    const auto first = errors("1");
    ASSERT_EQ(first.size(), 2u);
    EXPECT_EQ(first[0].size(), 24u);
    EXPECT_EQ(first, errors("1"));
    EXPECT_NE(first, errors("2"));
}

// Under a limit on memory that 4 azimuths just keep to, the map of 256 finds no room: 200 MiB. How
// much the driver takes for itself differs, so the limit is found by trial.
TEST_F(Bench, SkipsWhatDoesNotFitAndGoesOn)
{
    if (!has(run("info").out, "(software)"))
        GTEST_SKIP() << "skipped: ulimit limits the memory of software OpenGL only; run with "
                        "LIBGL_ALWAYS_SOFTWARE=1";
    ToolRun result;
    for (int megabytes = 600; megabytes <= 3000 && result.status != 0; megabytes += 100)
        result = run("bench --generate spikes --size 640 --azimuths 4,256 --methods sweep-draft "
                     "--posts 3 --repeats 1 -q --csv b.csv --json b.json",
                     "ulimit -v " + std::to_string(megabytes) + "000");
    if (result.status != 0 || !has(result.out, "skipped: "))
        GTEST_SKIP() << "skipped: no ulimit of 600 to 3000 MB lets 4 azimuths pass and 256 fail "
                        "here; needs another version of Mesa: "
                     << result.err;
    EXPECT_TRUE(has(result.out, "skipped: not enough graphics memory")) << result.out;
    const std::vector<Record> records = readCsv(path("b.csv"));
    ASSERT_EQ(records.size(), 2u);
    EXPECT_EQ(records[0].at("skipped"), "");
    EXPECT_EQ(records[0].at("light_front"), "1");
    EXPECT_TRUE(has(records[1].at("skipped"), "not enough graphics memory"));
    for (const auto& [column, value] : records[1])
    {
        if (column != "method" && column != "azimuths" && column != "skipped")
        {
            EXPECT_EQ(value, "") << column;
        }
    }
    CPLJSONDocument json;
    ASSERT_TRUE(json.Load(path("b.json")));
    const CPLJSONObject row = json.GetRoot().GetArray("rows")[1];
    EXPECT_EQ(row.GetString("skipped"), records[1].at("skipped"));
    EXPECT_EQ(row.GetObj("gpu_ms").GetType(), CPLJSONObject::Type::Null);
}

TEST_F(Bench, RefusesATerrainThatTheGpuCannotTake)
{
    const ToolRun info = run("info");
    const std::size_t at = info.out.find("Largest texture:");
    ASSERT_NE(at, std::string::npos);
    const int largest = std::stoi(info.out.substr(at + 16));
    if (largest > 65536)
        GTEST_SKIP() << "skipped: this GPU takes textures of " << largest
                     << " a side, and no terrain of more than 65536 is generated; run with "
                        "LIBGL_ALWAYS_SOFTWARE=1";
    const ToolRun result =
        run("bench --generate spikes --csv b.csv --size " + std::to_string(largest) + ",2");
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.complains("generated spikes, seed 1: ")) << result.err;
    EXPECT_TRUE(result.complains(" a side")) << result.err;
    EXPECT_TRUE(left().empty());
}

// No error at all is no reason to fail: the picture's axes are then linear. A sun below the
// horizontal has no relative error.
TEST_F(Bench, PlainAtNight)
{
    writeRaster("plain & 'x' <y>.tif", 9, 7, std::vector<float>(63, 5.0f), {0, 10, 0, 0, 0, -10});
    const ToolRun result =
        run("bench \"plain & 'x' <y>.tif\" --sun 90,-5 --azimuths 4,8 --repeats 1 "
            "-q --csv b.csv --plot p.svg");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(result.complains("warning")) << "it has no CRS";
    EXPECT_EQ(result.out.rfind("terrainlight ", 0), 0u) << "no progress, and the table stays";
    for (const Record& record : readCsv(path("b.csv")))
    {
        EXPECT_EQ(number(record, "horizon_max_deg"), 0.0);
        EXPECT_EQ(number(record, "sun_max_fraction"), 0.0);
        EXPECT_EQ(number(record, "gpu_sun_ms"), 0.0) << "the stage does not run";
        EXPECT_EQ(record.at("sun_relative_rms"), "");
    }
    EXPECT_TRUE(has(labelsOf(path("p.svg")), "|plain & 'x' <y>.tif: 9 x 7 posts, "));
}

TEST_F(Bench, BouncesNeedOneEastSpacing)
{
    const ToolRun result = run("bench " + jacksboro + " --bounces 1 -q --csv b.csv");
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.complains("jacksboro_90m.tif: --bounces needs posts as far apart"))
        << result.err;
    EXPECT_TRUE(left().empty());
}

// The error must not depend on how many paths it is measured with, nor direct light on bounces.
TEST_F(Bench, BouncesAreMeasuredAgainstPaths)
{
    const auto measured = [&](const std::string& arguments)
    {
        const ToolRun result =
            run("bench --generate fractal,2 --size 64 --azimuths 16,32 --methods sweep-normal "
                "--posts 400 --repeats 1 --csv b.csv --json b.json --plot p.svg -q " +
                arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_TRUE(has(result.out, "noise")) << result.out;
        return readCsv(path("b.csv"), true);
    };
    const std::vector<Record> few = measured("--bounces 2 --albedo 0.6,0.5,0.4 --paths 2000");
    CPLJSONDocument json;
    ASSERT_TRUE(json.Load(path("b.json")));
    const CPLJSONObject root = json.GetRoot();
    EXPECT_EQ(root.GetInteger("reference/paths"), 2048);
    EXPECT_EQ(root.GetInteger("reference/indirect_posts"), 40);
    EXPECT_EQ(root.GetInteger("bounces/count"), 2);
    EXPECT_NEAR(root.GetArray("bounces/albedo")[2].ToDouble(), 0.4, 1e-7);
    EXPECT_TRUE(has(labelsOf(path("p.svg")), "|luminance of the light that bounces: relative RMS"));
    const std::vector<Record> many = measured("--bounces 2 --albedo 0.6,0.5,0.4");
    ASSERT_EQ(few.size(), 2u);
    ASSERT_EQ(many.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i)
    {
        EXPECT_EQ(number(many[i], "gpu_pyramid_ms"), 0.0); // sweeps need none
        EXPECT_GT(number(many[i], "gpu_bounce_ms"), 0.0);
        const double error = number(many[i], "indirect_relative_rms");
        const double noise = number(few[i], "indirect_relative_noise");
        EXPECT_GT(error, 0.0);
        EXPECT_LT(error, 0.1);
        EXPECT_GT(noise, 2.0 * number(many[i], "indirect_relative_noise"));
        // Noise is taken out: what is left of it in the mean square of 40 posts is some
        // noise^2 sqrt(2 / 40), and a cross term of 2 error noise / sqrt(40). 5 sigma.
        EXPECT_NEAR(
            std::pow(number(few[i], "indirect_relative_rms"), 2.0), error * error,
            5.0 * (noise * noise * std::sqrt(2.0 / 40.0) + 2.0 * error * noise / std::sqrt(40.0)));
        EXPECT_EQ(few[i].at("light_relative_rms"), many[i].at("light_relative_rms"));
    }
    const double smallest = std::min(number(many[0], "indirect_relative_rms"),
                                     number(many[1], "indirect_relative_rms"));
    EXPECT_LT(number(many[0], "indirect_relative_noise"), 0.2 * smallest);

    // Direct light is measured as without bounces.
    ASSERT_EQ(run("bench --generate fractal,2 --size 64 --azimuths 16,32 --methods sweep-normal "
                  "--posts 400 --repeats 1 --csv d.csv -q")
                  .status,
              0);
    const std::vector<Record> direct = readCsv(path("d.csv"));
    for (std::size_t i = 0; i < 2; ++i)
        for (const auto& [column, value] : errorsOf(direct[i]))
            EXPECT_EQ(many[i].at(column), value) << column;
}

// A valley of two planes: without the sun, light is the sky's and what bounces of it.
TEST_F(Bench, SkyAloneBounces)
{
    std::vector<float> heights;
    for (int row = 0; row < 15; ++row)
        for (int column = 0; column < 41; ++column)
            heights.push_back(static_cast<float>(10 * std::abs(column - 20)));
    writeRaster("valley.tif", 41, 15, heights, {0, 10, 0, 0, 0, -10});
    const ToolRun result = run("bench valley.tif --no-sun --bounces 1 --azimuths 32 --repeats 1 "
                               "--posts 4000 --paths 4096 --csv b.csv --json b.json -q");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(has(result.out, "Sun:       off"));
    CPLJSONDocument json;
    ASSERT_TRUE(json.Load(path("b.json")));
    EXPECT_EQ(json.GetRoot().GetObj("sun").GetType(), CPLJSONObject::Type::Null);
    for (const Record& record : readCsv(path("b.csv"), true))
    {
        EXPECT_EQ(number(record, "sun_max_fraction"), 0.0);
        EXPECT_EQ(number(record, "gpu_sun_ms"), 0.0);
        EXPECT_LT(number(record, "light_relative_rms"), 0.01);
        // What harmonics of order 4 lose at the valley's bottom is theirs.
        EXPECT_LT(number(record, "indirect_relative_rms"),
                  record.at("method").rfind("sweep-", 0) == 0 ? 0.1 : 0.5)
            << record.at("method");
    }
}

// No truth: a raster in degrees, which the path tracer refuses, has a cost all the same.
TEST_F(Bench, CostAlone)
{
    const std::string degrees = jacksboro + " -srcwin 0 0 48 40";
    for (const std::string& terrain : {std::string("--generate fractal --size 48"), degrees})
    {
        const ToolRun result =
            run("bench " + terrain +
                " --methods sweep-normal,legendre,legendre-2,legendre-4 "
                "--azimuths 8 --bounces 2 --posts 0 --repeats 1 -q --csv b.csv --json b.json");
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_TRUE(has(result.out, "Reference: none")) << result.out;
        EXPECT_FALSE(has(result.out, "Error of")) << result.out;
        std::istringstream csv(contentOf(path("b.csv")));
        std::string line;
        std::getline(csv, line);
        EXPECT_EQ(line, "method,azimuths,gpu_horizon_ms,gpu_sky_ms,gpu_sun_ms,gpu_shade_ms,"
                        "gpu_pyramid_ms,gpu_bounce_ms,gpu_ms,wall_ms,memory_bytes,skipped");
        int rows = 0;
        for (; std::getline(csv, line); ++rows)
        {
            const std::vector<std::string> values = split(line);
            ASSERT_EQ(values.size(), 12u) << line;
            EXPECT_GT(std::stod(values[7]), 0.0) << line;
            EXPECT_GE(std::stod(values[8]), std::stod(values[7])) << line;
            // Heights and shading at the least: 4 and 8 bytes per post.
            EXPECT_GT(std::stod(values[10]), 48.0 * 40.0 * 12.0) << line;
        }
        EXPECT_EQ(rows, 4);
    }
}

TEST_F(Bench, VoidsAreNoPosts)
{
    std::vector<float> heights(60, -9999.0f);
    writeRaster("void.tif", 10, 6, heights, {0, 10, 0, 0, 0, -10});
    const ToolRun refused = run("bench void.tif -q --csv b.csv");
    EXPECT_EQ(refused.status, 1);
    EXPECT_TRUE(refused.complains("void.tif: holds no valid height")) << refused.err;
    EXPECT_EQ(left(), std::set<std::string>{"void.tif"});
    for (const std::size_t i : {3u, 14u, 25u, 37u})
        heights[i] = static_cast<float>(i);
    writeRaster("void.tif", 10, 6, heights, {0, 10, 0, 0, 0, -10});
    const ToolRun result = run("bench void.tif -q --azimuths 4 --repeats 1");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(has(result.out, "10 x 6 posts, 4 of them valid"));
    EXPECT_TRUE(has(result.out, "4 random posts (sun: 4)")) << result.out;
}

TEST_F(Bench, FailureLeavesNoFile)
{
    const std::string small =
        "bench --generate spikes --size 16 --azimuths 4 --methods sweep-draft "
        "--posts 5 --repeats 1 -q --csv b.csv --json b.json --plot p.svg";
    // A gnuplot that can be run, but does not draw.
    const std::filesystem::path programs = folder.string() + ".programs";
    std::filesystem::create_directories(programs);
    std::ofstream(programs / "gnuplot") << "#!/bin/sh\n! /bin/grep -q multiplot\n";
    std::filesystem::permissions(programs / "gnuplot", std::filesystem::perms::owner_all);
    std::ofstream(path("b.csv")) << "precious";
    const auto before = left();
    const ToolRun result = run(small, "export PATH='" + programs.string() + "'");
    std::filesystem::remove_all(programs);
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.complains("p.svg: gnuplot")) << result.err;
    EXPECT_EQ(left(), before);
    EXPECT_EQ(contentOf(path("b.csv")), "precious");
    EXPECT_EQ(run(small).status, 0);
    EXPECT_EQ(readCsv(path("b.csv")).size(), 1u);
    EXPECT_EQ(left(), (std::set<std::string>{"b.csv", "b.json", "p.svg"}));
}

TEST_F(Bench, InterruptLeavesNothing)
{
    int interrupted = 0;
    for (const char* delay : {"0.05", "0.3", "0.6", "1", "1.5"})
    {
        const ToolRun result =
            run("bench --generate fractal --size 200 --posts 200 --repeats 3 -q --csv b.csv "
                "--json b.json --plot p.svg",
                std::string("{ (sleep ") + delay + "; kill -TERM $$) >/dev/null 2>&1 & }");
        if (result.status == 0)
        {
            EXPECT_EQ(left(), (std::set<std::string>{"b.csv", "b.json", "p.svg"}));
            break;
        }
        EXPECT_EQ(result.status, -SIGTERM);
        EXPECT_TRUE(left().empty()) << "after " << delay << " s";
        ++interrupted;
    }
    EXPECT_GT(interrupted, 0);
}

} // namespace
