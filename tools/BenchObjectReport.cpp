#include "BenchObjectReport.h"

#include "BenchPlot.h"
#include "BenchRecords.h"
#include "Console.h"

#include <cpl_string.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

namespace osgTerrainLight::tool::bench
{
namespace
{

const std::string all = "all";
/// Places that lose more than a twentieth of the terrain's light to objects: elsewhere any method
/// is nearly right.
const std::string shaded = "shaded";
constexpr double shadedBelow = 0.95;

std::vector<std::string> groundsOf()
{
    std::vector<std::string> names;
    for (const Ground ground : allGrounds())
        names.emplace_back(toString(ground));
    names.push_back(all);
    return names;
}

/// Found and true light at some places.
struct Pairs
{
    std::vector<double> found, truth;
};

ObjectRow rowOf(const ObjectReport& report, const std::vector<ObjectResult>& results,
                const std::string& ground, std::size_t method)
{
    ObjectRow row;
    row.ground = ground;
    row.method = objectMethods()[method].name;
    Pairs pairs;
    std::map<std::string, Pairs> parts;
    std::vector<std::pair<const ObjectResult*, std::size_t>> origins;
    double reads = 0.0, seconds = 0.0;
    for (const ObjectResult& result : results)
    {
        if (ground != all && ground != toString(result.ground))
            continue;
        const ObjectLight& light = result.measured.found[method];
        reads += light.reads * double(result.places.size());
        seconds += light.seconds * double(result.places.size());
        for (std::size_t i = 0; i < result.places.size(); ++i)
        {
            const PlaceTruth& truth = result.measured.truths[i];
            std::vector<Pairs*> those = {&pairs, &parts[toString(result.places[i].surface)],
                                         &parts[result.kind]};
            if (truth.light < shadedBelow * truth.terrain)
                those.push_back(&parts[shaded]);
            for (Pairs* into : those)
            {
                into->found.push_back(light.light[i]);
                into->truth.push_back(truth.light);
            }
            origins.emplace_back(&result, i);
        }
    }
    row.errors = lightErrorsOf(pairs.found, pairs.truth);
    const double count = double(origins.size());
    row.reads = reads / count;
    row.millisecondsPer1000 = 1.0e6 * seconds / count;
    for (const std::string& part : report.parts)
        row.rms[part] = lightErrorsOf(parts[part].found, parts[part].truth).rms;
    const auto& [worst, place] = origins[row.errors.worstAt];
    row.scene = worst->number;
    row.kind = worst->kind;
    row.onGround = toString(worst->ground);
    row.surface = worst->places[place].surface;
    row.at = worst->places[place].at;
    row.found = pairs.found[row.errors.worstAt];
    row.truth = pairs.truth[row.errors.worstAt];
    return row;
}

std::string percent(double share)
{
    return std::isnan(share) ? CPLSPrintf("%16s", "-") : CPLSPrintf(" %15.2f", 100.0 * share);
}

/// "scene 3 (thin walls), wall at 61.2 70.1 1.4: 0.41, true 0.62"
std::string worstOf(const ObjectRow& row)
{
    return CPLSPrintf("%s%sscene %d (%s), %s at %.2f %.2f %.2f: %.3f, true %.3f",
                      row.ground == all ? row.onGround.c_str() : "", row.ground == all ? ", " : "",
                      row.scene, row.kind.c_str(), toString(row.surface), row.at.x, row.at.y,
                      row.at.z, row.found, row.truth);
}

std::vector<Cell> cellsOf(const ObjectReport& report, const ObjectRow& row)
{
    std::vector<Cell> cells = {{"ground", row.ground},
                               {"method", row.method},
                               {"places", std::int64_t(row.errors.count)},
                               {"reads", row.reads},
                               {"ms_per_1000", row.millisecondsPer1000},
                               {"rms_percent", 100.0 * row.errors.rms},
                               {"p95_percent", 100.0 * row.errors.p95},
                               {"mean_percent", 100.0 * row.errors.mean},
                               {"worst_percent", 100.0 * row.errors.worst}};
    for (const std::string& part : report.parts)
    {
        std::string column = part + "_rms_percent";
        std::replace(column.begin(), column.end(), ' ', '_');
        const double rms = row.rms.at(part);
        cells.push_back({column, std::isnan(rms) ? Value() : Value(100.0 * rms)});
    }
    cells.push_back({"worst_ground", row.onGround});
    cells.push_back({"worst_scene", std::int64_t(row.scene)});
    cells.push_back({"worst_kind", row.kind});
    cells.push_back({"worst_surface", std::string(toString(row.surface))});
    cells.push_back({"worst_x_m", row.at.x});
    cells.push_back({"worst_y_m", row.at.y});
    cells.push_back({"worst_z_m", row.at.z});
    cells.push_back({"worst_found", row.found});
    cells.push_back({"worst_true", row.truth});
    return cells;
}

} // namespace

LightErrors lightErrorsOf(const std::vector<double>& found, const std::vector<double>& truth)
{
    LightErrors errors;
    errors.count = found.size();
    if (found.empty())
    {
        errors.rms = errors.p95 = errors.mean = errors.worst =
            std::numeric_limits<double>::quiet_NaN();
        return errors;
    }
    std::vector<double> sizes;
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i)
    {
        const double error = found[i] - truth[i];
        sum += error;
        squares += error * error;
        sizes.push_back(std::abs(error));
        if (std::abs(error) > std::abs(errors.worst))
        {
            errors.worst = error;
            errors.worstAt = i;
        }
    }
    std::sort(sizes.begin(), sizes.end());
    errors.rms = std::sqrt(squares / double(sizes.size()));
    errors.mean = sum / double(sizes.size());
    errors.p95 = sizes[sizes.size() * 95 / 100];
    return errors;
}

void fillRows(ObjectReport& report, const std::vector<ObjectResult>& results)
{
    for (const Surface surface : allSurfaces())
        report.parts.emplace_back(toString(surface));
    report.parts.push_back(shaded);
    double variance = 0.0, count = 0.0;
    for (const ObjectResult& result : results)
    {
        if (std::find(report.parts.begin(), report.parts.end(), result.kind) == report.parts.end())
            report.parts.push_back(result.kind);
        for (const PlaceTruth& truth : result.measured.truths)
        {
            variance += truth.lightError * truth.lightError;
            count += 1.0;
        }
    }
    report.noise = std::sqrt(variance / count);
    for (const std::string& ground : groundsOf())
        for (std::size_t method = 0; method < objectMethods().size(); ++method)
            report.rows.push_back(rowOf(report, results, ground, method));
}

std::string tableOf(const ObjectReport& report)
{
    std::string table = "terrainlight " OSGTERRAINLIGHT_VERSION ", " + report.date + "\n";
    table += CPLSPrintf("Scenes:    %d on each ground, seed %u; %d places each on ground, walls "
                        "and roofs\n",
                        report.scenes, report.seed, report.places);
    table += CPLSPrintf("Reference: %d rays at each place that meet the triangles and the terrain; "
                        "their noise is %.2f %%\n",
                        objectRays, 100.0 * report.noise);
    table +=
        CPLSPrintf("Times:     the shaders' functions as C++ in float on one processor thread, "
                   "not on a GPU; median of %d rounds\n",
                   report.repeats);
    table += "Light:     of a uniform sky, without bounces. The light of the terrain alone and its "
             "horizon are the reference's:\n           errors are those of what objects take. "
             "shaded: places that lose more than 5 % of it\n";
    table += "Methods:\n";
    for (const ObjectMethod& method : objectMethods())
        table += CPLSPrintf("  %-22s %s\n", method.name.c_str(), method.meaning.c_str());
    std::string ground;
    for (const ObjectRow& row : report.rows)
    {
        if (row.ground != ground)
        {
            ground = row.ground;
            table += "\nError of sky light [% of open level ground's], " +
                     (ground == all ? std::string("all grounds") : ground + " ground") +
                     "\n  method                   reads     rms     p95    mean   worst";
            for (const std::string& part : report.parts)
                table += CPLSPrintf(" %15s", part.c_str());
            table += "  ms/1000\n";
        }
        table += CPLSPrintf("  %-22s %7.1f", row.method.c_str(), row.reads);
        table +=
            CPLSPrintf(" %7.2f %7.2f %+7.2f %+7.1f", 100.0 * row.errors.rms, 100.0 * row.errors.p95,
                       100.0 * row.errors.mean, 100.0 * row.errors.worst);
        for (const std::string& part : report.parts)
            table += percent(row.rms.at(part));
        table += CPLSPrintf(" %8.2f\n", row.millisecondsPer1000);
    }
    table += "\nWorst places: east, north and up from the terrain's south-west corner [m]; light\n";
    for (const ObjectRow& row : report.rows)
        if (row.ground != all)
            table += CPLSPrintf("  %-7s %-22s ", row.ground.c_str(), row.method.c_str()) +
                     worstOf(row) + "\n";
    return table;
}

std::string csvOf(const ObjectReport& report)
{
    std::vector<std::vector<Cell>> rows;
    for (const ObjectRow& row : report.rows)
        rows.push_back(cellsOf(report, row));
    return csvOf(rows);
}

std::string jsonOf(const ObjectReport& report)
{
    CPLJSONDocument document;
    CPLJSONObject root = document.GetRoot();
    root.Add("software", "terrainlight " OSGTERRAINLIGHT_VERSION);
    root.Add("date", report.date);
    root.Add("scenes", report.scenes);
    root.Add("places", report.places);
    root.Add("seed", static_cast<GInt64>(report.seed));
    root.Add("repeats", report.repeats);
    CPLJSONObject reference;
    reference.Add("rays", objectRays);
    reference.Add("noise_percent", 100.0 * report.noise);
    root.Add("reference", reference);
    CPLJSONArray rows;
    for (const ObjectRow& row : report.rows)
        rows.Add(jsonOf(cellsOf(report, row)));
    root.Add("rows", rows);
    return document.SaveAsString() + "\n";
}

Result<std::string> svgOf(const ObjectReport& report)
{
    // Families of methods; without reads there is no place on a logarithmic axis.
    const struct
    {
        const char* prefix;
        const char* colour;
        const char* style;
    } families[] = {{"cones-", "#0072b2", "linespoints"},
                    {"ambient-cube", "#d55e00", "points"},
                    {"paper-listing", "#009e73", "points"},
                    {"paper-text", "#cc79a7", "points"}};
    std::ostringstream data;
    data.imbue(std::locale::classic());
    std::vector<double> reads, errors;
    const std::vector<std::string> grounds = groundsOf();
    for (std::size_t g = 0; g < grounds.size(); ++g)
        for (std::size_t f = 0; f < std::size(families); ++f)
        {
            data << "$data" << g << "_" << f << " << END\n";
            for (const ObjectRow& row : report.rows)
                if (row.ground == grounds[g] && row.method.rfind(families[f].prefix, 0) == 0 &&
                    row.method != "cones-16-probe") // it lies on top of cones-16
                {
                    data << row.reads << ' ' << 100.0 * row.errors.rms << ' '
                         << (f == 0 ? row.method.substr(6) : "\"\"") << '\n';
                    reads.push_back(row.reads);
                    errors.push_back(std::max(100.0 * row.errors.rms, 1.0e-3));
                }
            data << "END\n";
        }
    std::string script =
        "set encoding utf8\nset terminal svg size 960,820 font 'sans-serif,12' background "
        "'#ffffff'\n" +
        data.str() +
        "set multiplot layout 2,2 margins 0.08,0.98,0.14,0.92 spacing 0.1,0.13 title " +
        quoted("Sky light among objects: " + std::to_string(report.scenes) + " scenes, seed " +
               std::to_string(report.seed) + ", " + report.date.substr(0, 10)) +
        " noenhanced\n";
    script += logarithmic("x", reads);
    script += logarithmic("y", errors) +
              "set xlabel 'texture reads'\nset ylabel 'RMS error [%]'\nunset key\n";
    for (std::size_t g = 0; g < grounds.size(); ++g)
    {
        if (g + 1 == grounds.size())
            script += "set key at screen 0.5,0.02 center bottom horizontal maxrows 1 width 2\n";
        script += "set title " + quoted(grounds[g] == all ? "all grounds" : grounds[g]) + "\nplot ";
        for (std::size_t f = 0; f < std::size(families); ++f)
        {
            const std::string name = "$data" + std::to_string(g) + "_" + std::to_string(f);
            std::string title = families[f].prefix;
            if (title.back() == '-')
                title.pop_back();
            script += (f ? ", " : "") + name + " using 1:2 with " + families[f].style +
                      " linecolor '" + families[f].colour + "' pointtype 7 title '" + title +
                      "', " + name + " using 1:2:3 with labels offset 1.2,0.6 textcolor '" +
                      families[f].colour + "' notitle";
        }
        script += "\n";
    }
    return runGnuplot(script + "unset multiplot\n");
}

} // namespace osgTerrainLight::tool::bench
