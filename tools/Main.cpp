#include "Console.h"
#include "Help.h"
#include "Options.h"

#include <gdal.h>
#include <osg/Notify>
#include <osg/Version>

#include <csignal>
#include <exception>

using namespace osgTerrainLight;
using namespace osgTerrainLight::tool;

namespace
{

/// All modes, in the order of the help. A new mode is a line here.
std::vector<Mode> addModes(CLI::App& tool)
{
    return {
        addHorizon(tool), addSvf(tool),    addShadow(tool), addSunHours(tool),
        addShade(tool),   addRender(tool), addInfo(tool),   addGenerate(tool),
#ifdef OTL_BENCH // which needs Embree
        addBench(tool),
#endif
    };
}

int report(const CLI::ParseError& error)
{
    complain(inGdalSpelling(error.what()) + " (terrainlight MODE --help lists options)");
    return 2;
}

} // namespace

int main(int count, char** values)
{
    osg::setNotifyLevel(osg::WARN); // its notices go to stdout
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit then fails, with its reason
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
    const std::vector<Mode> modes = addModes(tool);
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
