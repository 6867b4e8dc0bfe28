#!/usr/bin/env python3
"""Holds the edges between packages, from the table below: core <- io, gpu, fields <- lighting <- scene <- viewer <- osgdb.

Compiler include paths cannot, since all packages share one root. Usage: check_includes.py [ROOT],
or --self-test, which plants bad includes and must find each of them and nothing else.
"""
import re
import sys
import tempfile
from pathlib import Path

PLAIN_VALUES = {"DemTile.h", "Environment.h", "Export.h", "HorizonMap.h", "LightingSettings.h", "SkyLight.h",
                "SunPosition.h", "Surroundings.h", "TileHandle.h", "Viewpoint.h"}
MAY_USE_OSG = {"DynamicTerrain.h", "LightProbe.h", "LightingHandler.h", "HeadlessContext.h", "TerrainLighting.h", "PlacedObject.h", "ShadingTexture.h"}

# Package -> what its files may include: packages of ours (`values` are the public headers of plain
# values, `public` the other public headers) and families of foreign headers.
ALLOWED = {
    "values": {"values", "std"},
    "public": {"values", "public", "std"},
    "public with OSG": {"values", "public", "std", "osg"},
    "core": {"core", "values", "glsl_host", "std", "glm", "erfa"},  # erfa: the sun's place, plain maths
    # posix: a file that is put in place has reached its disk (fsync).
    "io": {"io", "core", "values", "std", "glm", "gdal", "openexr", "pugixml", "posix"},
    # fields: meshes to distance fields, without OSG. Of io only how a file is put in place whole. Embree finds the
    # nearest triangle.
    "fields": {"fields", "io/PendingFile.h", "core", "values", "std", "glm", "embree"},
    "gpu": {"gpu", "plugin/include/osgTerrainLight/HeadlessContext.h", "core", "values", "glsl_host", "std", "glm", "osg", "gl"},
    "lighting": {"lighting", "plugin/include/osgTerrainLight/HeadlessContext.h", "gpu", "fields", "core", "values", "glsl_host", "std", "glm", "osg", "gl"},
    "scene": {"scene", "lighting", "gpu", "fields", "io", "core", "values", "public", "glsl_host",
              "std", "glm", "osg", "gl"},
    "terrain": {"terrain", "scene", "lighting", "io", "core", "values", "public", "std", "osg"},
    "viewer": {"viewer", "scene", "core", "values", "public", "std", "osg"},
    "osgdb": {"osgdb", "viewer", "terrain", "scene", "io", "core", "values", "public", "std", "osg"},
    "modules": {"osgdb/Register.h"},
    "samples": {"samples", "values", "public", "std", "osg", "gl"},
    # fields: bench measures light in the fields that the library makes.
    "tools": {"tools", "osgdb/Register.h", "viewer", "terrain", "scene", "lighting", "gpu", "fields", "io", "core", "values", "public", "glsl_host",
              "std", "glm", "osg", "gl", "gdal", "openexr", "pugixml", "cli11", "posix",
              "reference"},
    # The oracle shares no algorithm with what it checks: values in, values out.
    "reference": {"reference", "core/AzimuthSet.h", "core/Raster.h", "core/Result.h", "values",
                  "std", "embree"},
    "glsl_host": {"core/Raster.h", "core/Volume.h", "shader list", "std", "glm"},
    "shader list": {"shader lib"},
    "shader lib": set(),
}

FAMILIES = [
    ("std", r"[a-z_]+"),
    ("posix", r"(fcntl|unistd|dlfcn|sys/\w+)\.h"),
    ("glm", r"glm/.+"),
    ("osg", r"(osg\w*|OpenThreads)/.+"),
    ("gl", r"(GL|GLES\d?|EGL|KHR)/.+"),
    ("gdal", r"(gdal/)?(gdal|ogr|cpl|vrt)\w*\.h"),
    ("openexr", r"((OpenEXR|Imath)/.+|(Imf|Iex|Imath|IlmThread|half)\w*\.h)"),
    ("pugixml", r"pugixml\.hpp"),
    ("cli11", r"CLI/.+"),
    ("embree", r"embree3/.+"),
    ("erfa", r"erfam?\.h"),
]

CODE = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', re.S)
INCLUDE = re.compile(r"^[ \t]*#[ \t]*include\b[ \t]*(.*?)[ \t]*$", re.M)
NAME = re.compile(r'"([^"]+)"|<([^>]+)>')


def without_comments(text):
    """Blanks comments and keeps line numbers. Strings are matched so that none starts a comment."""
    return CODE.sub(lambda m: m[0] if m[0][0] == '"' else "\n" * m[0].count("\n"), text)


def package_of(path):
    """Package of a file of ours, by its path below the root; None where it is in none."""
    parts = path.split("/")
    if parts[:2] == ["plugin", "src"] and len(parts) > 3:
        return parts[2]
    if parts[:3] == ["plugin", "include", "osgTerrainLight"]:
        return "values" if parts[-1] in PLAIN_VALUES else "public"
    if path == "shaders/glsl_host.h":
        return "glsl_host"
    if path == "shaders/lib/all.glsl":  # the one list of the order of composition
        return "shader list"
    if parts[:2] == ["shaders", "lib"]:
        return "shader lib"
    if parts[:2] == ["tools", "reference"]:
        return "reference"
    return parts[0] if parts[0] in ("samples", "tools", "tests") else None


def target_of(root, path, name, quoted):
    """What an include names: (path below the root or None, package or family)."""
    folders = [(root / path).parent] if quoted else []
    for folder in folders + [root / "plugin/include", root / "plugin/src", root / "shaders",
                             root / "tools", root / "tests"]:
        file = (folder / name).resolve()
        if file.is_file() and file.is_relative_to(root):
            ours = file.relative_to(root).as_posix()
            return ours, package_of(ours) or ours
    # A header of ours that does not exist yet, or is generated, still belongs where its path says.
    for prefix in ("plugin/include/", "plugin/src/", "shaders/", "tools/", "tests/"):
        if package_of(prefix + name) in ALLOWED and package_of(prefix + name) != "tools":
            return prefix + name, package_of(prefix + name)
    for family, pattern in FAMILIES:
        if re.fullmatch(pattern, name):
            return None, family
    return None, "unknown to the table"


def check(root):
    """(number of files seen, violations as (path, line, sentence))."""
    root = root.resolve()
    seen, violations = 0, []
    for top in ("plugin", "shaders", "samples", "tools"):
        for file in sorted((root / top).rglob("*")):
            path = file.relative_to(root).as_posix()
            package = package_of(path)
            if package is None or file.suffix not in (".h", ".hpp", ".cpp", ".inl", ".glsl"):
                continue
            seen += 1
            if package == "public" and file.name in MAY_USE_OSG:
                package = "public with OSG"
            text = without_comments(file.read_text(encoding="utf-8"))
            for match in INCLUDE.finditer(text):
                line = text.count("\n", 0, match.start()) + 1
                name = NAME.fullmatch(match[1])
                if not name:
                    violations.append((path, line, f"cannot tell what this includes: {match[1]}"))
                    continue
                target, kind = target_of(root, path, name[1] or name[2], bool(name[1]))
                own = target and target.removeprefix("plugin/src/")
                if package not in ALLOWED:
                    violations.append((path, line, f"package {package} is not in the table"))
                elif kind not in ALLOWED[package] and own not in ALLOWED[package]:
                    sentence = f"{package} must not include {match[1]} ({kind})"
                    violations.append((path, line, sentence))
    return seen, violations


# path -> lines; a line marked BAD must be found.
SELF_TEST = {
    "plugin/include/osgTerrainLight/DemTile.h":
        ["#include <osgTerrainLight/Export.h>", "#include <vector>",
         "#include <osg/Vec3> // BAD", "#include <osgTerrainLight/TerrainLighting.h> // BAD"],
    "plugin/include/osgTerrainLight/TerrainLighting.h":
        ["#include <osg/Group>", "#include <osgTerrainLight/DemTile.h>",
         '#include "gpu/Pass.h" // BAD', "#include <glm/glm.hpp> // BAD"],
    "plugin/include/osgTerrainLight/Unlisted.h": ["#include <osg/Group> // BAD"],
    "plugin/src/core/Raster.h":
        ["#include <cmath>", "#include <glm/vec2.hpp>", '#include "glsl_host.h"',
         '// #include "io/DemReader.h"', "/*", '#include "io/DemReader.h"', "*/",
         '#include "../io/DemReader.h" // BAD', "#include <GL/gl.h> // BAD", "#include WHAT // BAD",
         '#  include   "osg/Vec3" // BAD', '#include "lib/all.glsl" // BAD'],
    "plugin/src/io/DemReader.h":
        ['#include "DemReader.h"', '#include "core/Raster.h"', "#include <gdal_priv.h>",
         "#include <OpenEXR/ImfArray.h>", '#include "gpu/Pass.h" // BAD',
         "#include <osg/Image> // BAD", "#include <boost/any.hpp> // BAD"],
    "plugin/src/fields/MeshField.cpp":
        ['#include "core/Result.h"', "#include <embree3/rtcore.h>", '#include "io/PendingFile.h"',
         '#include "io/DemReader.h" // BAD', "#include <osg/Image> // BAD", '#include "gpu/Pass.h" // BAD',
         '#include "lighting/nodes/Sun.h" // BAD'],
    "plugin/src/gpu/Pass.h":
        ["#include <osg/State>", "#include <EGL/egl.h>", '#include "core/Raster.h"',
         '#include "io/DemReader.h" // BAD', "#include <ImfArray.h> // BAD",
         '#include "scene/Tile.h" // BAD', "#include <cpl_conv.h> // BAD"],
    "plugin/src/gpu/passes/Horizon.cpp": ['#include "../Pass.h"', '#include "scene/Tile.h" // BAD'],
    "plugin/src/lighting/nodes/Sun.cpp":
        ['#include "gpu/Pass.h"', '#include "scene/Tile.h" // BAD', '#include "io/DemReader.h" // BAD'],
    "plugin/src/scene/Tile.h":
        ['#include "io/DemReader.h"', '#include "gpu/Pass.h"', "#include <gdal.h> // BAD",
         '#include "osgdb/Reader.h" // BAD', '#include "viewer/Keys.h" // BAD'],
    "plugin/src/viewer/Keys.h":
        ['#include "scene/Tile.h"', "#include <osgGA/GUIEventHandler>", '#include "gpu/Pass.h" // BAD',
         '#include "osgdb/Reader.h" // BAD'],
    "plugin/src/osgdb/Reader.cpp":
        ["#include <osgDB/Registry>", '#include "scene/Tile.h"', '#include "viewer/Keys.h"'],
    "plugin/src/modules/Reader.cpp":
        ['#include "osgdb/Register.h"', '#include "osgdb/Reader.h" // BAD', "#include <osgDB/Registry> // BAD"],
    "plugin/src/fresh/New.cpp": ["#include <vector> // BAD"],
    "samples/minimal/main.cpp":
        ["#include <osgTerrainLight/TerrainLighting.h>", "#include <osgViewer/Viewer>",
         '#include "core/Raster.h" // BAD', '#include "../../plugin/src/io/DemReader.h" // BAD'],
    "shaders/glsl_host.h":
        ['#include "core/Raster.h"', "#include <glm/glm.hpp>", '#include "lib/all.glsl"',
         "#include <cassert>", '#include "lib/azimuth.glsl" // BAD',
         '#include "core/Result.h" // BAD', "#include <osg/Vec3> // BAD"],
    "shaders/lib/all.glsl":
        ['#include "azimuth.glsl"', '#include "core/Raster.h" // BAD', "#include <cmath> // BAD"],
    "shaders/lib/azimuth.glsl": ['#include "lib/sh.glsl" // BAD', "#include <cmath> // BAD"],
    "tools/reference/Scan.h":
        ['#include "reference/Ray.h"', '#include "core/AzimuthSet.h"',
         "#include <embree3/rtcore.h>", "#include <osgTerrainLight/DemTile.h>", '#include "glsl_host.h" // BAD',
         '#include "core/PyramidLayout.h" // BAD', '#include "gpu/Pass.h" // BAD'],
    "tools/Bench.cpp": ['#include "reference/Scan.h"', '#include "support/Horizons.h" // BAD'],
    "tools/Svf.cpp": ["#include <CLI/CLI.hpp>", '#include "gpu/Pass.h"', "#include <gdal.h>"],
}


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        expected = set()
        for path, lines in SELF_TEST.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text("\n".join(lines) + "\n")
            expected |= {(path, i + 1) for i, line in enumerate(lines) if line.endswith("BAD")}
        seen, violations = check(root)
        found = {(path, line) for path, line, _ in violations}
        for path, line in sorted(expected - found):
            print(f"{path}:{line}: planted and not found: {SELF_TEST[path][line - 1]}")
        for path, line in sorted(found - expected):
            print(f"{path}:{line}: found and not planted: {SELF_TEST[path][line - 1]}")
        return 0 if found == expected and seen == len(SELF_TEST) else 1


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    root = Path(arguments[0]) if arguments else Path(__file__).parent.parent
    seen, violations = check(root)
    for path, line, sentence in violations:
        print(f"{path}:{line}: {sentence}")
    if not seen:
        print(f"check_includes: no source below {root}")
    return 1 if violations or not seen else 0


sys.exit(main(sys.argv[1:]))
