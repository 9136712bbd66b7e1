#!/usr/bin/env python3
"""Checks the engine's libraries as other programs use them: installed, and found by pkg-config.

usage: tests/package/libraries.py [--build FOLDER]

Links C and C++ programs with the shared and the static libraries and runs them; compiles every
header alone in both languages; reads sonames, exported symbols and dependencies from the shared
objects.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
PARTS = ("geodesic", "geodesic-tools", "geodesic-smooth")
UMBRELLA = {"geodesic": "geodesic", "geodesic-tools": "tools", "geodesic-smooth": "smooth"}
# The libraries that each library needs: libraries of other projects, and libraries of every system.
# Each release of Debian has its own version of OpenMesh.
NEEDED = {"geodesic": {"libstdc++.so.6", "libz.so.1", "libminizip.so.1", "libexpat.so.1"},
          "geodesic-tools": {"libgeodesic.so.0", "libz.so.1", "libOpenMeshCore.so", "libOpenMeshTools.so", "libstdc++.so.6"},
          "geodesic-smooth": {"libgeodesic.so.0"}}
SYSTEM = re.compile(r"(libc|libm|libgcc_s|ld-linux.*)\.so\.\d+")
LANGUAGES = {"C": ["cc", "-std=c17", "-x", "c"], "C++": ["c++", "-std=c++17", "-x", "c++"]}
MOST_ARGUMENTS = 5
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"


def static_flags(flags):
    """Returns flags that link the engine statically. Debian has OpenMesh only as shared libraries,
    so a program that uses it is not static."""
    if not any("OpenMesh" in flag for flag in flags):
        return ["-static", *flags]
    return [f"-l:lib{flag[2:]}.a" if flag.startswith("-lgeodesic") else flag for flag in flags]


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    return done.returncode, done.stdout


class Installed:
    """A folder filled by `make install-libraries`, and the checks of its files."""

    def __init__(self, prefix):
        self.prefix, self.failed = prefix, 0
        self.folder = prefix / "lib"

    def expect(self, what, holds, told=""):
        print(f"{'ok' if holds else 'not ok'} libraries: {what}" + ("" if holds else f": {told}"), flush=True)
        self.failed += not holds

    def flags(self, *arguments):
        environment = dict(os.environ, PKG_CONFIG_PATH=str(self.folder / "pkgconfig"))
        return run("pkg-config", *arguments, env=environment)[1].split()


def shared_object(tree, part):
    place = tree.folder / f"lib{part}.so.0"
    dynamic = run("readelf", "--wide", "--dynamic", place)[1]
    tree.expect(f"lib{part} has its soname", re.findall(r"soname: \[(.*)\]", dynamic) == [place.name], dynamic)
    needed = {re.sub(r"(OpenMesh.*\.so).*", r"\1", name) for name in re.findall(r"NEEDED.*\[(.*)\]", dynamic) if not SYSTEM.fullmatch(name)}
    tree.expect(f"lib{part} needs no library but those documented", needed == NEEDED[part], needed)
    exported = [line.split()[-1] for line in run("nm", "-D", "--defined-only", place)[1].splitlines()]
    exported = [name for name in exported if not name.startswith("GEODESIC_")]
    strangers = [name for name in exported if not re.fullmatch(r"gd_[a-z]\w*@@GEODESIC_0|gd__\w+@@GEODESIC_PRIVATE", name)]
    tree.expect(f"lib{part} exports gd_ names only", exported and not strangers, strangers)
    headers = "".join(path.read_text() for path in (tree.prefix / "include/geodesic/gd").glob("*.h"))
    public = [name.partition("@")[0] for name in exported if name.endswith("GEODESIC_0")]
    hidden = [name for name in public if not re.search(rf"\b{name}\b", headers)]
    tree.expect(f"all public names of lib{part} are documented in headers", not hidden, hidden)
    size = run("size", place)[1].split("\n")[1].split()[0]
    print(f"# lib{part}: {int(size) / 1e3:.0f} kB of code and constants, {len(public)} public names, {len(exported) - len(public)} private ones")


def headers_stand_alone(tree):
    flags = tree.flags("--cflags", "geodesic")
    for language, compiler in LANGUAGES.items():
        failed = {}
        for header in sorted((tree.prefix / "include/geodesic/gd").glob("*.h")):
            program = tree.prefix / "header.txt"
            # Some headers only define macros, and ISO C forbids a unit without a declaration.
            program.write_text(f"#include <gd/{header.name}>\n#include <gd/{header.name}>\nextern int declared;\n")
            code, told = run(*compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", *flags, program)
            if code:
                failed[header.name] = told
        tree.expect(f"each header stands alone in {language}", not failed, failed)


def argument_counts(header):
    """Yields pairs of a function and the number of its arguments."""
    text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
    text = re.sub(r"^#(?:.*\\\n)*.*$", "", text, flags=re.M)
    for found in re.finditer(r"\b(gd_\w+)\(", text):
        depth, count = 1, 1
        for position in range(found.end(), len(text)):
            depth += {"(": 1, ")": -1}.get(text[position], 0)
            count += depth == 1 and text[position] == ","
            if depth == 0:
                break
        yield found[1], count


def functions_are_short(tree):
    counts = [pair for header in (tree.prefix / "include/geodesic/gd").glob("*.h") for pair in argument_counts(header)]
    long = [f"{name}: {count}" for name, count in counts if count > MOST_ARGUMENTS]
    tree.expect(f"no public function has more than {MOST_ARGUMENTS} arguments", len(counts) > 200 and not long, (len(counts), long))


def programs_link(tree):
    mesh = tree.prefix / "square.obj"
    mesh.write_text(SQUARE)
    example = tree.prefix / "share/doc/libgeodesic-dev/examples/geodesic.c"
    for language, compiler in LANGUAGES.items():
        for kind in ("shared", "static"):
            for part in PARTS:
                source = example if part == "geodesic" else HERE / f"use_{UMBRELLA[part]}.c"
                program = tree.prefix / f"{part}-{kind}"
                if kind == "shared":
                    libraries, found = tree.flags("--libs", part), {"LD_LIBRARY_PATH": str(tree.folder)}
                else:
                    libraries, found = static_flags(tree.flags("--static", "--libs", part)), {}
                code, told = run(*compiler, "-Wall", "-Wextra", "-Werror", source, "-x", "none", "-o", program, *tree.flags("--cflags", part), *libraries)
                if not code:
                    code, told = run(program, mesh, "0", "2", env={"PATH": os.environ["PATH"], **found})
                tree.expect(f"a {language} program with the {kind} lib{part} runs", code == 0 and told.startswith("distance: 1.41421356237309"), told)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", type=pathlib.Path, default=SOURCE / "build")
    build = arguments.parse_args().build.resolve()
    missing = [program for program in ("pkg-config", "readelf", "nm") if not shutil.which(program)]
    if missing:
        print(f"skip libraries: {', '.join(missing)} not installed")
        return 0
    with tempfile.TemporaryDirectory() as place:
        tree = Installed(pathlib.Path(place) / "usr")
        code, told = run("make", "--no-print-directory", f"BUILD={build}", "install-libraries", f"PREFIX={tree.prefix}", cwd=SOURCE)
        tree.expect("make install-libraries", code == 0, told)
        if code:
            return 1
        for part in PARTS:
            shared_object(tree, part)
        functions_are_short(tree)
        headers_stand_alone(tree)
        programs_link(tree)
    return tree.failed > 0


if __name__ == "__main__":
    sys.exit(main())
