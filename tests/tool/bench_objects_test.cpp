// bench --objects: what it refuses, what it says of its scenes, and that it is the same every time.
#include "ToolRun.h"

#include <cpl_json.h>
#include <pugixml.hpp>

#include <cmath>
#include <map>

using namespace osgTerrainLight;
using namespace osgTerrainLight::testing;

namespace
{

const std::vector<std::string> grounds = {"plain", "valley", "rough", "all"};
const std::vector<std::string> methods = {"no-objects",
                                          "paper-listing",
                                          "paper-listing-blurred",
                                          "paper-text",
                                          "paper-text-blurred",
                                          "ambient-cube",
                                          "cones-4",
                                          "cones-6",
                                          "cones-9",
                                          "cones-12",
                                          "cones-16",
                                          "cones-32",
                                          "cones-16-probe"};

/// By ground, then by method.
using Rows = std::map<std::string, std::map<std::string, CPLJSONObject>>;

Rows rowsOf(const CPLJSONObject& root)
{
    Rows rows;
    for (const CPLJSONObject& row : root.GetArray("rows"))
        rows[row.GetString("ground")][row.GetString("method")] = row;
    return rows;
}

/// Lines of a CSV without its times.
std::vector<std::string> errorsOf(const std::string& path)
{
    std::istringstream file(contentOf(path));
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);)
    {
        std::vector<std::string> fields;
        std::istringstream parts(line);
        for (std::string field; std::getline(parts, field, ',');)
            fields.push_back(field);
        std::string kept;
        for (std::size_t i = 0; i < fields.size(); ++i)
            kept += i == 4 ? "" : fields[i] + ",";
        lines.push_back(kept);
    }
    return lines;
}

using BenchObjects = ToolTest;

} // namespace

TEST_F(BenchObjects, WhatDoesNotGoWithThemIsRefused)
{
    std::filesystem::copy_file(jacksboro, path("dem.tif"));
    const auto before = left();
    const struct
    {
        const char* arguments;
        std::vector<const char*> complaints;
    } mistakes[] = {
        {"--objects dem.tif", {"--objects", "INPUT"}},
        {"--objects --generate fractal", {"--objects", "--generate"}},
        {"--objects --posts 10", {"--objects", "--posts"}},
        {"--objects --azimuths 8", {"--objects", "--azimuths"}},
        {"--objects --methods sweep-best", {"--objects", "--methods"}},
        {"--objects --bounces 1", {"--objects", "--bounces"}},
        {"--objects --sun 90,10", {"--objects", "--sun"}},
        {"--objects --scenes 0", {"scenes", "0", "1 ... 256"}},
        {"--objects --scenes 1.5", {"scenes", "1.5", "whole"}},
        {"--objects --places 3", {"places", "3", "4 ... 10000"}},
        {"--objects --seed -1", {"seed", "-1"}},
        {"--objects --plot p.png", {"--plot", "p.png", ".svg"}},
        {"--objects --csv a --json ./a", {"--json", "./a is the file of --csv"}},
        {"dem.tif --scenes 2", {"--scenes", "--objects"}},
        {"dem.tif --places 20", {"--places", "--objects"}},
    };
    for (const auto& mistake : mistakes)
    {
        SCOPED_TRACE(mistake.arguments);
        const ToolRun result = run(std::string("bench ") + mistake.arguments);
        EXPECT_EQ(result.status, 2);
        EXPECT_EQ(result.out, "");
        for (const char* complaint : mistake.complaints)
            EXPECT_TRUE(result.complains(complaint)) << complaint << " not in: " << result.err;
        EXPECT_EQ(left(), before);
    }
}

TEST_F(BenchObjects, EveryMethodOnEveryGround)
{
    const ToolRun result = run("bench --objects --scenes 4 --places 24 --repeats 1 --csv c.csv "
                               "--json j.json --plot p.svg");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(left(), (std::set<std::string>{"c.csv", "j.json", "p.svg"}));
    EXPECT_EQ(result.out.substr(0, result.out.find('\n')),
              "0...10...20...30...40...50...60...70...80...90...100 - done.");
    EXPECT_NE(result.out.find("4 on each ground, seed 1; 24 places"), std::string::npos);
    CPLJSONDocument json;
    ASSERT_TRUE(json.Load(path("j.json")));
    EXPECT_EQ(json.GetRoot().GetInteger("scenes"), 4);
    EXPECT_EQ(json.GetRoot().GetInteger("places"), 24);
    // Stratified, 4096 rays of a share err by less than as many independent ones: 0.5 / 64.
    EXPECT_GT(json.GetRoot().GetDouble("reference/noise_percent"), 0.0);
    EXPECT_LT(json.GetRoot().GetDouble("reference/noise_percent"), 0.78);
    Rows rows = rowsOf(json.GetRoot());
    ASSERT_EQ(rows.size(), grounds.size());
    for (const std::string& method : methods)
    {
        SCOPED_TRACE(method);
        double squares = 0.0;
        for (const std::string& ground : grounds)
        {
            SCOPED_TRACE(ground);
            ASSERT_EQ(rows[ground].size(), methods.size());
            const CPLJSONObject& row = rows[ground][method];
            const bool all = ground == "all";
            EXPECT_EQ(row.GetInteger("places"), all ? 3 * 96 : 96);
            const double rms = row.GetDouble("rms_percent");
            if (all)
            {
                EXPECT_NEAR(rms, std::sqrt(squares), 1.0e-9) << "of three grounds alike";
            }
            squares += rms * rms / 3.0;
            EXPECT_LE(std::abs(row.GetDouble("mean_percent")), rms);
            EXPECT_LE(row.GetDouble("p95_percent"), std::abs(row.GetDouble("worst_percent")));
            EXPECT_NEAR(row.GetDouble("worst_percent"),
                        100.0 * (row.GetDouble("worst_found") - row.GetDouble("worst_true")),
                        1.0e-9);
            // Half of the places on the ground, a quarter each on walls and roofs.
            const auto squared = [&](const char* part)
            { return std::pow(row.GetDouble(std::string(part) + "_rms_percent"), 2); };
            EXPECT_NEAR(squared("ground") / 2 + squared("wall") / 4 + squared("roof") / 4,
                        rms * rms, 1.0e-9 + 1.0e-9 * rms * rms);
        }
    }
    for (const std::string& ground : grounds)
    {
        SCOPED_TRACE(ground);
        const auto number = [&](const char* method, const char* column)
        { return rows[ground][method].GetDouble(column); };
        EXPECT_EQ(number("no-objects", "reads"), 0.0);
        EXPECT_EQ(number("ambient-cube", "reads"), 3.0);
        EXPECT_EQ(number("paper-listing", "reads"), 4.0);
        EXPECT_EQ(number("paper-listing-blurred", "reads"), 4.0);
        EXPECT_EQ(number("paper-text", "reads"), 5.0);
        EXPECT_LT(number("cones-4", "reads"), number("cones-16", "reads"));
        EXPECT_LT(number("cones-16", "reads"), number("cones-32", "reads"));
        EXPECT_GT(number("cones-16", "ms_per_1000"), 0.0);
        EXPECT_LT(number("ambient-cube", "rms_percent"), number("no-objects", "rms_percent"));
        // Asked of the library's default.
        EXPECT_LE(number("cones-16", "rms_percent"), 4.0);
        // Where objects take next to nothing, having none is nearly right.
        EXPECT_GT(number("no-objects", "shaded_rms_percent"), number("no-objects", "rms_percent"));
    }
    pugi::xml_document picture;
    ASSERT_TRUE(picture.load_file(path("p.svg").c_str()));
    EXPECT_STREQ(picture.document_element().name(), "svg");
}

TEST_F(BenchObjects, TheSeedAloneDecides)
{
    const std::string few = "bench --objects --scenes 2 --places 8 --repeats 1 -q --csv ";
    ASSERT_EQ(run(few + "a.csv").status, 0);
    ASSERT_EQ(run(few + "b.csv --seed 1").status, 0);
    ASSERT_EQ(run(few + "c.csv --seed 2").status, 0);
    const auto first = errorsOf(path("a.csv"));
    EXPECT_EQ(first.size(), 1 + grounds.size() * methods.size());
    EXPECT_EQ(first, errorsOf(path("b.csv")));
    EXPECT_NE(first, errorsOf(path("c.csv")));
}
