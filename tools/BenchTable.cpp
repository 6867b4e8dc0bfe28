// The table for people.
#include "BenchReport.h"

#include "core/SettingsTable.h"

#include <cpl_string.h>

#include <algorithm>
#include <cmath>

namespace osgTerrainLight::tool::bench
{
namespace
{

/// Left-justified name and azimuths, wide enough for all rows.
std::string labelOf(const Report& report, const std::string& method, const std::string& azimuths)
{
    std::size_t width = 6;
    for (const Row& row : report.rows)
        width = std::max(width, row.method.size());
    return CPLSPrintf("%-*s %8s", static_cast<int>(width), method.c_str(), azimuths.c_str());
}

std::string labelOf(const Report& report, const Row& row)
{
    return labelOf(report, row.method, std::to_string(row.settings.azimuths));
}

std::string costTable(const Report& report)
{
    std::string table = "Cost: GPU milliseconds by stage; wall clock; textures and hulls\n  " +
                        labelOf(report, "method", "azimuths");
    for (const std::string& stage : report.stages)
        table += CPLSPrintf(" %9s", stage.c_str());
    table += "       all   wall ms       MiB\n";
    for (const Row& row : report.rows)
    {
        table += "  " + labelOf(report, row);
        if (!row.skipped.empty())
        {
            table += "   skipped: " + row.skipped + "\n";
            continue;
        }
        for (const double milliseconds : row.stageMilliseconds)
            table += CPLSPrintf(" %9.2f", milliseconds);
        table += CPLSPrintf(" %9.2f %9.2f %9.2f\n", row.gpuMilliseconds, row.wallMilliseconds,
                            static_cast<double>(row.bytes) / (1024.0 * 1024.0));
    }
    return table;
}

std::string errorTable(const Report& report, std::size_t q)
{
    const Quantity& quantity = report.quantities[q];
    std::string table =
        "Error of the " + quantity.title + " [" + quantity.unit + "]; * front of GPU ms against " +
        quantity.mainTitle + "\n  " + labelOf(report, "method", "azimuths") +
        "    GPU ms      mean       rms       p99       max       bias  relative rms" +
        (quantity.noisy ? "     noise\n" : "\n");
    for (const Row& row : report.rows)
    {
        if (!row.skipped.empty())
            continue;
        const ErrorStatistics& e = row.errors[q];
        if (std::isnan(e.rms)) // the method has no such thing
            continue;
        table += row.onFront[q] ? "* " : "  ";
        table += labelOf(report, row);
        table += CPLSPrintf(" %9.2f", row.gpuMilliseconds);
        for (const double error : {e.mean, e.rms, e.p99, e.max})
            table += CPLSPrintf(" %9.3g", error);
        table += CPLSPrintf(" %+10.3g", e.bias);
        table += std::isnan(e.relativeRms) ? std::string(13, ' ') + "-"
                                           : CPLSPrintf(" %13.3g", e.relativeRms);
        if (quantity.noisy)
            table += CPLSPrintf(" %9.2g", e.relativeNoise);
        table += "\n";
    }
    return table;
}

} // namespace

std::string tableOf(const Report& report)
{
    const GpuCapabilities& device = report.device;
    std::string table =
        "terrainlight " OSGTERRAINLIGHT_VERSION ", " + report.date + "\n" +
        "Device:    " + device.renderer + (device.isSoftware() ? " (software)" : " (hardware)") +
        ", OpenGL " + device.version + "\n" + "Terrain:   " + report.terrain + ", " +
        std::to_string(report.width) + " x " + std::to_string(report.height) + " posts, " +
        std::to_string(report.validPosts) + " of them valid, " +
        CPLSPrintf("%.6g x %.6g m\n", report.eastSpacing, report.northSpacing) + "Sun:       " +
        (report.sky.sunEnabled ? "azimuth " + text(report.sky.sunAzimuth) + ", elevation " +
                                     text(report.sky.sunElevation) + " degrees\n"
                               : "off\n") +
        (report.quantities.empty()
             ? std::string("Reference: none, cost alone\n")
             : "Reference: exhaustive horizons in double at " + std::to_string(report.skyPosts) +
                   " random posts (sun: " + std::to_string(report.sunPosts) + "), seed " +
                   std::to_string(report.seed) + "\n") +
        "Times:     median of " + std::to_string(report.repeats) +
        " rounds, in each of which every row runs after a warm-up\n";
    if (report.settings.bounces > 0)
        table += "Bounces:   " + std::to_string(report.settings.bounces) + ", albedo " +
                 findSetting<LightingSettings>("albedo")->textOf(report.settings) +
                 (report.quantities.empty()
                      ? std::string("\n")
                      : "; reference: " + std::to_string(report.paths) + " paths at each of " +
                            std::to_string(report.indirectPosts) +
                            " posts; their noise is taken out of rms and relative rms, and shown "
                            "beside\n");
    table += "\n" + costTable(report);
    for (std::size_t q = 0; q < report.quantities.size(); ++q)
        table += "\n" + errorTable(report, q);
    return table;
}

} // namespace osgTerrainLight::tool::bench
