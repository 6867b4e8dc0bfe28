#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

/// How the tool's command line looks: GDAL's spelling of options, and help in columns.
namespace osgTerrainLight::tool
{

/// The arguments without the program's name. GDAL's names have two dashes, as CLI11 wants them, and
/// the last argument comes first, as CLI11 wants that.
std::vector<std::string> arguments(int count, char** values);

/// The way back: --of in what CLI11 says is -of for people.
std::string inGdalSpelling(std::string text);

class HelpFormatter : public CLI::Formatter
{
public:
    HelpFormatter();
    std::string make_description(const CLI::App* app) const override;
    /// The first sentence is enough in the list.
    std::string make_subcommand(const CLI::App* mode) const override;
    std::string make_option_name(const CLI::Option* option, bool positional) const override;
    /// The type, or the names that may stand there.
    std::string make_option_opts(const CLI::Option* option) const override;
    std::string make_option_desc(const CLI::Option* option) const override;
};

} // namespace osgTerrainLight::tool
