#include "Help.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace osgTerrainLight::tool
{
namespace
{

// GDAL writes these with one dash, which CLI11 takes for a row of one-letter flags.
const std::vector<std::string> gdalNames = {"of", "co", "srcwin"};

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

} // namespace

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

std::string inGdalSpelling(std::string text)
{
    for (const std::string& name : gdalNames)
        for (std::size_t at = 0; (at = text.find("--" + name, at)) != std::string::npos; ++at)
            if (at + name.size() + 2 == text.size() ||
                !std::isalpha(static_cast<unsigned char>(text[at + name.size() + 2])))
                text.erase(at, 1);
    return text;
}

HelpFormatter::HelpFormatter()
{
    column_width(28);
    label("SUBCOMMAND", "MODE ...");
}

std::string HelpFormatter::make_description(const CLI::App* app) const
{
    return wrapped(app->get_description(), 90) + "\n";
}

std::string HelpFormatter::make_subcommand(const CLI::App* mode) const
{
    const std::string description = mode->get_description();
    std::stringstream out;
    CLI::detail::format_help(out, mode->get_display_name(true),
                             wrapped(description.substr(0, description.find(". ")), 62), 28);
    return out.str();
}

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool positional) const
{
    return inGdalSpelling(CLI::Formatter::make_option_name(option, positional));
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const
{
    const std::string type = option->get_type_name();
    const std::size_t names = type.find('{');
    return type.empty() || option->get_positional()
               ? ""
               : " " + type.substr(names == type.npos ? 0 : names);
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const
{
    return wrapped(option->get_description(), 62);
}

} // namespace osgTerrainLight::tool
