#include "Pipeline.h"

#include <gdal.h>
#include <osg/Notify>
#include <osg/Version>

#include <algorithm>
#include <cctype>
#include <exception>
#include <iostream>
#include <sstream>

using namespace osgTerrainLight;
using namespace osgTerrainLight::tool;

namespace
{

// GDAL writes these with one dash, which CLI11 takes for a row of one-letter flags.
const std::vector<std::string> gdalNames = {"of", "co", "srcwin"};

/// The arguments, GDAL's names with two dashes, last first, as CLI11 wants them.
std::vector<std::string> arguments(int count, char** values)
{
    std::vector<std::string> result(values + 1, values + count);
    for (std::string& argument : result)
    {
        if (argument == "--")
            break;
        for (const std::string& name : gdalNames)
            if (argument == "-" + name)
                argument.insert(0, 1, '-');
    }
    std::reverse(result.begin(), result.end());
    return result;
}

/// The way back: --of in what CLI11 says is -of for people.
std::string inGdalSpelling(std::string text)
{
    for (const std::string& name : gdalNames)
        for (std::size_t at = 0; (at = text.find("--" + name, at)) != std::string::npos; ++at)
            if (at + name.size() + 2 == text.size() ||
                !std::isalpha(static_cast<unsigned char>(text[at + name.size() + 2])))
                text.erase(at, 1);
    return text;
}

/// Line breaks so that text fits into columns.
std::string wrapped(const std::string& text, std::size_t columns)
{
    std::string result;
    std::size_t length = 0;
    for (const std::string& word : CLI::detail::split(text, ' '))
    {
        if (length > 0 && length + 1 + word.size() > columns)
        {
            result += '\n';
            length = 0;
        }
        else if (length > 0)
        {
            result += ' ';
            ++length;
        }
        result += word;
        length += word.size();
    }
    return result;
}

class HelpFormatter : public CLI::Formatter
{
public:
    HelpFormatter()
    {
        column_width(28);
        label("SUBCOMMAND", "MODE ...");
    }

    std::string make_description(const CLI::App* app) const override
    {
        return wrapped(app->get_description(), 90) + "\n";
    }
    /// The first sentence is enough in the list.
    std::string make_subcommand(const CLI::App* mode) const override
    {
        const std::string description = mode->get_description();
        std::stringstream out;
        CLI::detail::format_help(out, mode->get_display_name(true),
                                 wrapped(description.substr(0, description.find(". ")), 62), 28);
        return out.str();
    }
    std::string make_option_name(const CLI::Option* option, bool positional) const override
    {
        return inGdalSpelling(CLI::Formatter::make_option_name(option, positional));
    }
    /// The type, or the names that may stand there.
    std::string make_option_opts(const CLI::Option* option) const override
    {
        const std::string type = option->get_type_name();
        const std::size_t names = type.find('{');
        return type.empty() || option->get_positional()
                   ? ""
                   : " " + type.substr(names == type.npos ? 0 : names);
    }
    std::string make_option_desc(const CLI::Option* option) const override
    {
        return wrapped(option->get_description(), 62);
    }
};

int report(const CLI::ParseError& error)
{
    complain(inGdalSpelling(error.what()) + " (terrainlight MODE --help lists options)");
    return 2;
}

} // namespace

int main(int count, char** values)
{
    osg::setNotifyLevel(osg::WARN); // its notices go to stdout
    CLI::App tool("Light and shadow on terrain, computed on the GPU.", "terrainlight");
    tool.formatter(std::make_shared<HelpFormatter>());
    tool.require_subcommand(1);
    tool.set_version_flag("--version",
                          "terrainlight " OSGTERRAINLIGHT_VERSION ", GDAL " +
                              std::string(GDALVersionInfo("RELEASE_NAME")) + ", OpenSceneGraph " +
                              osgGetVersion(),
                          "Versions of the tool, GDAL and OpenSceneGraph");
    tool.footer("terrainlight MODE --help lists a mode's options and examples.\n"
                "Exit status: 0 done, 1 failed, 2 mistake in the command line.");
    const std::vector<Mode> modes = {addHorizon(tool),  addSvf(tool),      addShadow(tool),
                                     addSunHours(tool), addShade(tool),    addRender(tool),
                                     addInfo(tool),     addGenerate(tool), addBench(tool)};
    std::string names;
    bool known = count > 1 && values[1][0] == '-';
    for (const Mode& mode : modes)
    {
        mode.app->group("Modes");
        names += (names.empty() ? "" : ", ") + mode.app->get_name();
        known = known || (count > 1 && mode.app->get_name() == values[1]);
    }
    if (!known)
    {
        complain((count > 1 ? "'" + std::string(values[1]) + "' is no mode" : "no mode given") +
                 ": needs one of " + names + " (terrainlight --help)");
        return 2;
    }
    try
    {
        tool.parse(arguments(count, values));
        for (const Mode& mode : modes)
            if (mode.app->parsed())
                if (const Status done = mode.run(); !done)
                {
                    complain(done.error().message);
                    return 1;
                }
        return 0;
    }
    catch (const CLI::Success& request) // help, version
    {
        return tool.exit(request);
    }
    catch (const CLI::ParseError& error)
    {
        return report(error);
    }
    catch (const std::bad_alloc&)
    {
        complain("not enough memory");
    }
    catch (const std::exception& error)
    {
        complain(error.what());
    }
    return 1;
}
