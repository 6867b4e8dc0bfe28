#!/usr/bin/env python3
"""What the shared library exports of our namespace: what its public headers declare, and no more.

Usage: check_exports.py LIBRARY INCLUDE_FOLDER
"""
import re
import subprocess
import sys
from pathlib import Path

# What the plugin modules call; declared in osgdb/Register.h, which is not installed.
FOR_MODULES = {"registerReader", "registerSerializers"}
ABOUT = re.compile(r"^(?:vtable|VTT|typeinfo|typeinfo name|guard variable|construction vtable) for |"
                   r"^(?:non-virtual |virtual |covariant return )?thunk to ")


def declared(folder):
    """Names of classes, and of functions, that the headers below a folder export."""
    classes, functions = set(), set()
    for header in folder.rglob("*.h"):
        text = re.sub(r"//[^\n]*|#[^\n]*", "", header.read_text(encoding="utf-8"))
        classes |= set(re.findall(r"(?:class|struct)\s+OSGTERRAINLIGHT_EXPORT\s+(\w+)", text))
        functions |= set(re.findall(r"(?<!class )(?<!struct )OSGTERRAINLIGHT_EXPORT\s[^;{]*?(\w+)[=<>!+*-]*\(", text))
    return classes, functions


def exported(library):
    """Names of our namespace's classes and functions among a library's dynamic symbols, with one symbol of each."""
    listing = subprocess.run(["nm", "-DC", "--defined-only", library], check=True, capture_output=True, text=True)
    names = {}
    for line in listing.stdout.splitlines():
        symbol = ABOUT.sub("", line.split(" ", 2)[2])
        # Instances of the standard library's templates with our types are that library's.
        found = re.match(r"(?!std::|.* std::\w+<osgTerrainLight)(?:[^(]* )?osgTerrainLight::(\w+)", symbol)
        if found:
            names[found[1]] = symbol
    return names


def main(library, folder):
    classes, functions = declared(Path(folder))
    public = classes | functions
    found = exported(library)
    problems = [f"exported, and in no public header: {found[name]}" for name in sorted(set(found) - public - FOR_MODULES)]
    # A class may have nothing but inline members.
    problems += [f"in a public header, and not exported: {name}" for name in sorted((functions | FOR_MODULES) - set(found))]
    for problem in problems:
        print(f"check_exports: {problem}")
    print(f"check_exports: {len(found)} names exported")
    return 1 if problems or not public else 0


sys.exit(main(*sys.argv[1:]))
