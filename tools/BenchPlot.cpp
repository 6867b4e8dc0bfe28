#include "BenchPlot.h"

#include "BenchReport.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_spawn.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace osgTerrainLight::tool::bench
{
namespace
{

struct FileCloser
{
    void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

} // namespace

Result<std::string> runGnuplot(const std::string& script)
{
    const std::string name = "/vsimem/terrainlight-gnuplot.";
    std::string copy = script;
    const std::unique_ptr<VSILFILE, FileCloser> in(VSIFileFromMemBuffer(
        (name + "in").c_str(), reinterpret_cast<GByte*>(copy.data()), copy.size(), FALSE));
    std::unique_ptr<VSILFILE, FileCloser> out(VSIFOpenL((name + "out").c_str(), "wb"));
    const char* const arguments[] = {"gnuplot", "-d", "-", nullptr};
    CPLErrorReset();
    const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
    const int status = CPLSpawn(arguments, in.get(), out.get(), TRUE);
    out.reset();
    VSIUnlink((name + "in").c_str());
    vsi_l_offset size = 0;
    GByte* bytes = VSIGetMemFileBuffer((name + "out").c_str(), &size, TRUE);
    const std::string written(reinterpret_cast<const char*>(bytes), bytes ? size : 0);
    CPLFree(bytes);
    if (status != 0)
        return Error{ErrorCode::Failed, "gnuplot: " + std::string(CPLGetLastErrorMsg())};
    return written;
}

std::string quoted(std::string text)
{
    if (!CPLIsUTF8(text.c_str(), -1))
    {
        char* ascii = CPLForceToASCII(text.c_str(), -1, '?');
        text = ascii;
        CPLFree(ascii);
    }
    std::string result = "'";
    for (const char c : text)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f')
            result += '?';
        else
            result += std::string(c == '\'' ? 2 : 1, c);
    return result + "'";
}

std::string logarithmic(const char* axis, const std::vector<double>& values)
{
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    std::string tics;
    for (double decade = std::pow(10.0, std::floor(std::log10(*low)) - 1.0); decade < 10.0 * *high;
         decade *= 10.0)
        for (const double digit : {1.0, 2.0, 5.0})
            tics += (tics.empty() ? "" : ", ") + text(digit * decade);
    return CPLSPrintf("set logscale %s\nset %srange [%.6g:%.6g]\n", axis, axis, *low / 1.5,
                      *high * 1.8) +
           std::string("set ") + axis + "tics (" + tics + ")\n";
}

namespace
{

std::vector<std::string> methodsOf(const Report& report)
{
    std::vector<std::string> names;
    for (const Row& row : report.rows)
        if (row.skipped.empty() && std::find(names.begin(), names.end(), row.method) == names.end())
            names.push_back(row.method);
    return names;
}

/// Blocks of data: $method0 … with azimuths, milliseconds and errors, $front0 … by quantity.
std::string dataBlocks(const Report& report)
{
    std::ostringstream script;
    script.imbue(std::locale::classic());
    script.precision(10);
    const std::vector<std::string> methods = methodsOf(report);
    for (std::size_t m = 0; m < methods.size(); ++m)
    {
        script << "$method" << m << " << END\n";
        for (const Row& row : report.rows)
            if (row.skipped.empty() && row.method == methods[m])
            {
                script << row.settings.azimuths << ' ' << row.gpuMilliseconds;
                for (std::size_t q = 0; q < report.quantities.size(); ++q)
                    script << ' ' << row.errors[q].*report.quantities[q].main;
                script << '\n';
            }
        script << "END\n";
    }
    for (std::size_t q = 0; q < report.quantities.size(); ++q)
    {
        std::vector<CostAndError> front;
        for (const Row& row : report.rows)
            if (row.skipped.empty() && row.onFront[q])
                front.push_back({row.gpuMilliseconds, row.errors[q].*report.quantities[q].main});
        std::sort(front.begin(), front.end(),
                  [](const auto& a, const auto& b) { return a.cost < b.cost; });
        script << "$front" << q << " << END\n";
        for (const CostAndError& point : front)
            script << point.cost << ' ' << point.error << '\n';
        script << "END\n";
    }
    return script.str();
}

/// The error's axis is logarithmic, unless a result is exact.
std::string axisOf(const Report& report, std::size_t q)
{
    std::vector<double> errors;
    for (const Row& row : report.rows)
        if (row.skipped.empty() && std::isfinite(row.errors[q].*report.quantities[q].main))
            errors.push_back(row.errors[q].*report.quantities[q].main);
    if (!errors.empty() && *std::min_element(errors.begin(), errors.end()) > 0.0)
        return logarithmic("y", errors);
    const double highest = errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
    return CPLSPrintf("unset logscale y\nset ytics autofreq\nset yrange [0:%.6g]\n",
                      highest > 0.0 ? 1.2 * highest : 1.0);
}

} // namespace

Status checkPlotter()
{
    if (const Result<std::string> ran = runGnuplot("exit\n"); !ran)
        return Error{ErrorCode::NotFound,
                     "--plot needs the program gnuplot, which cannot be run here (" +
                         ran.error().message + "); --csv and --json do without"};
    return Nothing{};
}

Result<std::string> svgOf(const Report& report)
{
    std::vector<double> times;
    for (const Row& row : report.rows)
        if (row.skipped.empty())
            times.push_back(std::max(row.gpuMilliseconds, 1e-4)); // timers are that coarse
    const std::vector<std::string> methods = methodsOf(report);
    // Two panels to a line, 373 high with what is around them; 74 more above and below.
    const std::size_t lines = (report.quantities.size() + 1) / 2;
    const double height = static_cast<double>(74 + 373 * lines);
    // Strings at once: text() uses the same few buffers.
    const std::string canvas =
        CPLSPrintf("set encoding utf8\n"
                   "set terminal svg size 960,%.0f font 'sans-serif,12' background '#ffffff'\n",
                   height);
    const std::string layout =
        CPLSPrintf("set multiplot layout %d,2 margins 0.08,0.98,%.4f,%.4f spacing 0.1,%.4f title ",
                   static_cast<int>(lines), 115.0 / height, 1.0 - 66.0 / height, 107.0 / height);
    std::string script =
        canvas +
        // All that is long comes before anything is drawn, since gnuplot stops reading while its
        // output waits to be read.
        dataBlocks(report) + layout +
        quoted(report.terrain + ": " + std::to_string(report.width) + " x " +
               std::to_string(report.height) + " posts, " + report.device.renderer +
               (report.device.isSoftware() ? " (software)" : "") + ", " +
               report.date.substr(0, 10)) +
        " noenhanced\n" + logarithmic("x", times) + "set xlabel 'GPU milliseconds'\nunset key\n";
    // Okabe and Ito's colours, which colour-blind readers tell apart.
    const char* const colours[] = {"#0072b2", "#d55e00", "#009e73",
                                   "#cc79a7", "#e69f00", "#56b4e9"};
    for (std::size_t q = 0; q < report.quantities.size(); ++q)
    {
        if (q + 1 == report.quantities.size())
            script += "set key at screen 0.5,0.02 center bottom horizontal maxrows 1 width 2\n";
        const int error = static_cast<int>(q) + 3;
        script += axisOf(report, q) + "set title " +
                  quoted(report.quantities[q].title + ": " + report.quantities[q].mainTitle) +
                  " noenhanced\nplot $front" + std::to_string(q) +
                  " using 1:2 with lines linewidth 5 linecolor '#d0d0d0' title 'Pareto front'";
        for (std::size_t m = 0; m < methods.size(); ++m)
        {
            const std::string data = ", $method" + std::to_string(m);
            script += data +
                      CPLSPrintf(" using 2:%d with linespoints linecolor '%s' pointtype %d title ",
                                 error, colours[m % std::size(colours)], int(m % 6) * 2 + 5) +
                      quoted(methods[m]) + " noenhanced" + data +
                      CPLSPrintf(" using 2:%d:1 with labels offset 1.2,0.6 textcolor '%s' notitle",
                                 error, colours[m % std::size(colours)]);
        }
        script += "\n";
    }
    return runGnuplot(script + "unset multiplot\n");
}

} // namespace osgTerrainLight::tool::bench
