// CSV and JSON: the same columns of every row.
#include "BenchRecords.h"

#include "BenchReport.h"

#include <cpl_json.h>

#include <charconv>
#include <cmath>
#include <utility>
#include <variant>

namespace osgTerrainLight::tool::bench
{
namespace
{

/// A row as CSV and JSON have it: always the same columns, which docs/TOOL.md lists.
std::vector<Cell> cellsOf(const Report& report, const Row& row)
{
    const bool measured = row.skipped.empty();
    std::vector<Cell> cells;
    const auto add = [&](const std::string& column, Value value)
    {
        const double* number = std::get_if<double>(&value);
        if (number && !std::isfinite(*number))
            value = std::monostate();
        cells.push_back({column, std::move(value)});
    };
    const auto addMeasured = [&](const std::string& column, auto value)
    {
        if (measured)
            add(column, value());
        else
            add(column, {});
    };

    add("method", row.method);
    add("azimuths", std::int64_t(row.settings.azimuths));
    for (std::size_t i = 0; i < report.stages.size(); ++i)
        addMeasured("gpu_" + report.stages[i] + "_ms", [&] { return row.stageMilliseconds[i]; });
    addMeasured("gpu_ms", [&] { return row.gpuMilliseconds; });
    addMeasured("wall_ms", [&] { return row.wallMilliseconds; });
    addMeasured("memory_bytes", [&] { return static_cast<std::int64_t>(row.bytes); });
    for (std::size_t q = 0; q < report.quantities.size(); ++q)
    {
        const Quantity& quantity = report.quantities[q];
        const std::pair<const char*, double ErrorStatistics::*> statistics[] = {
            {"mean", &ErrorStatistics::mean},
            {"rms", &ErrorStatistics::rms},
            {"p99", &ErrorStatistics::p99},
            {"max", &ErrorStatistics::max},
            {"bias", &ErrorStatistics::bias}};
        for (const auto& [name, member] : statistics)
            addMeasured(quantity.name + "_" + name + "_" + quantity.unit,
                        [&, m = member] { return row.errors[q].*m; });
        addMeasured(quantity.name + "_relative_rms", [&] { return row.errors[q].relativeRms; });
        if (quantity.noisy)
            addMeasured(quantity.name + "_relative_noise",
                        [&] { return row.errors[q].relativeNoise; });
        addMeasured(quantity.name + "_front", [&] { return std::int64_t(row.onFront[q]); });
    }
    if (measured)
        add("skipped", {});
    else
        add("skipped", row.skipped);
    return cells;
}

/// Shortest text that reads back as the same double.
std::string exact(double value)
{
    char buffer[32];
    return {buffer, std::to_chars(buffer, buffer + sizeof(buffer), value).ptr};
}

std::string csvField(const Value& value)
{
    if (const double* number = std::get_if<double>(&value))
        return exact(*number);
    if (const std::int64_t* whole = std::get_if<std::int64_t>(&value))
        return std::to_string(*whole);
    const std::string* text = std::get_if<std::string>(&value);
    if (!text)
        return {};
    if (text->find_first_of(",\"\n") == std::string::npos)
        return *text;
    std::string quoted = "\"";
    for (const char c : *text)
        quoted += c == '"' ? std::string(2, c) : std::string(1, c);
    return quoted + '"';
}

} // namespace

CPLJSONObject jsonOf(const std::vector<Cell>& cells)
{
    CPLJSONObject object;
    for (const Cell& cell : cells)
        if (const double* number = std::get_if<double>(&cell.value))
            object.Add(cell.column, *number);
        else if (const std::int64_t* whole = std::get_if<std::int64_t>(&cell.value))
            object.Add(cell.column, static_cast<GInt64>(*whole));
        else if (const std::string* text = std::get_if<std::string>(&cell.value))
            object.Add(cell.column, *text);
        else
            object.AddNull(cell.column);
    return object;
}

std::string csvOf(const std::vector<std::vector<Cell>>& rows)
{
    std::string header, body;
    for (const std::vector<Cell>& row : rows)
    {
        header.clear();
        std::string line;
        for (const Cell& cell : row)
        {
            header += (header.empty() ? "" : ",") + cell.column;
            line += (&cell == row.data() ? "" : ",") + csvField(cell.value);
        }
        body += line + "\n";
    }
    return header + "\n" + body;
}

std::string csvOf(const Report& report)
{
    std::vector<std::vector<Cell>> rows;
    for (const Row& row : report.rows)
        rows.push_back(cellsOf(report, row));
    return csvOf(rows);
}

std::string jsonOf(const Report& report)
{
    CPLJSONDocument document;
    CPLJSONObject root = document.GetRoot();
    root.Add("software", "terrainlight " OSGTERRAINLIGHT_VERSION);
    root.Add("date", report.date);
    CPLJSONObject device;
    device.Add("vendor", report.device.vendor);
    device.Add("renderer", report.device.renderer);
    device.Add("opengl", report.device.version);
    device.Add("is_software", report.device.isSoftware());
    root.Add("device", device);
    CPLJSONObject terrain;
    terrain.Add("source", report.terrain);
    terrain.Add("width", report.width);
    terrain.Add("height", report.height);
    terrain.Add("valid_posts", static_cast<GInt64>(report.validPosts));
    terrain.Add("east_spacing_m", report.eastSpacing);
    terrain.Add("north_spacing_m", report.northSpacing);
    root.Add("terrain", terrain);
    CPLJSONObject sun;
    sun.Add("azimuth_deg", report.sky.sunAzimuth);
    sun.Add("elevation_deg", report.sky.sunElevation);
    sun.Add("radius_deg", report.sky.sunAngularRadius);
    if (report.sky.sunEnabled)
        root.Add("sun", sun);
    else
        root.AddNull("sun");
    CPLJSONObject reference;
    reference.Add("posts", static_cast<GInt64>(report.skyPosts));
    reference.Add("sun_posts", static_cast<GInt64>(report.sunPosts));
    reference.Add("seed", static_cast<GInt64>(report.seed));
    reference.Add("sky_azimuths", Truth::skyAzimuths);
    reference.Add("sun_strips", Truth::sunStrips);
    if (report.settings.bounces > 0)
    {
        reference.Add("indirect_posts", static_cast<GInt64>(report.indirectPosts));
        reference.Add("paths", static_cast<GInt64>(report.paths));
        CPLJSONObject bounces;
        bounces.Add("count", report.settings.bounces);
        CPLJSONArray albedo;
        for (const float channel : report.settings.albedo)
            albedo.Add(static_cast<double>(channel));
        bounces.Add("albedo", albedo);
        root.Add("bounces", bounces);
    }
    root.Add("reference", reference);
    root.Add("repeats", report.repeats);
    CPLJSONArray rows;
    for (const Row& row : report.rows)
        rows.Add(jsonOf(cellsOf(report, row)));
    root.Add("rows", rows);
    return document.SaveAsString() + "\n";
}

} // namespace osgTerrainLight::tool::bench
