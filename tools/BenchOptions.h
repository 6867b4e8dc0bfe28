#pragma once

#include "Pipeline.h"

#include <cstdint>
#include <string>
#include <vector>

/// `terrainlight bench`: what is asked for.
namespace osgTerrainLight::tool::bench
{
/// Settings that are measured under a name, at each number of azimuths.
struct Method
{
    std::string name;
    std::string meaning;
    void (*apply)(LightingSettings&);
    bool ofBounces = false; ///< it differs from another in bounces alone
    bool byDefault = true;  ///< false: only where --methods names it
};

const std::vector<Method>& allMethods();

struct Options
{
    std::string input;
    DemReadOptions read;
    std::string generated; ///< name of a kind; empty: input
    std::uint32_t terrainSeed = 1;
    int width = 1024, height = 1024;
    double spacing = 30.0;
    std::vector<const Method*> methods; ///< of allMethods()
    std::vector<int> azimuths = {8, 16, 32, 64};
    SkyLight sky;
    LightingSettings settings; ///< bounces and albedo
    std::uint64_t paths = 0;   ///< per post; 0: as many as it takes
    std::size_t posts = 4000;
    std::uint32_t seed = 1;
    int repeats = 5;
    bool objects = false;         ///< objects in place of a terrain
    int scenes = 16, places = 60; ///< with objects; places: in each scene
    std::string csv, json, plot;
    bool quiet = false;
};

/// Adds all options of the mode.
void addOptions(CLI::App& app, Options& options);

} // namespace osgTerrainLight::tool::bench
