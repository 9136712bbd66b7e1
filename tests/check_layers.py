#!/usr/bin/env python3
"""Reads every #include and import, and fails on a violation of the layers or on a cycle.

A *room* is a folder of sources with a rank. A file of `engine` or `server` includes its own room
and rooms of lower rank. `proto` includes public headers of the engine. `server` includes `proto`
and public headers of the engine. Only one room may include a given library. Only the composition
root may include the server's struct. Tests may include anything.

A part is a C source with its header, or one module of TypeScript, JavaScript or Python. No part may
include itself, directly or through other parts. Imports of types count, too.

Prints violations, cycles, and the rooms with their sizes.
"""
import collections
import os
import pathlib
import re
import sys

# The rooms of the engine with their ranks. A gd/ header has the rank of the room that implements
# it.
ENGINE = {"base": 0, "mesh": 1, "io": 1, "repair": 2, "construction": 3, "window": 2, "plane": 2, "kernel": 3, "guide": 4, "wavefront": 5, "field": 6, "line": 7, "query": 8,
          "transport": 9, "render": 9, "edit": 9, "cut": 10, "subdiv": 10, "loops": 9, "nurbs": 10, "umbrella": 11}
PUBLIC = {
    "base": ["language", "status", "vec", "control", "executor", "polygons", "number", "colour_map"],
    "mesh": ["mesh", "point", "locate", "direction"],
    "io": ["io", "control_mesh", "result_file"],
    "kernel": ["cpu"],
    "wavefront": ["workspace"],
    "field": ["field", "path", "isoline", "voronoi", "cut_locus"],
    "query": ["geodesic", "query", "landmarks", "sampling", "curve", "curve_distance"],
    "render": ["picture"],
    "edit": ["edit"],
    "cut": ["cut"],
    "transport": ["trace", "vector", "mean", "spline", "frame", "shortening", "resampling", "offset", "flat_strip"],
    "subdiv": ["subdivision", "limit", "limit_place", "limit_path", "limit_mesh", "limit_grid", "limit_shortest", "discretization"],
    "loops": ["trim"],
    "nurbs": ["parametric", "nurbs", "domain_curve", "tessellation", "geodesic_like", "space_distance"],
    "umbrella": ["tools", "smooth"],
}
ROOM_OF_HEADER = {f"gd/{name}.h": f"engine/{room}" for room, names in PUBLIC.items() for name in names}

# formats of JSON; requests and answers of any kind; values that many requests share; one file for
# each family of queries
PROTO = {"json": 12, "http": 13, "values": 14, "queries": 15}

SERVER = {"base": 0, "config": 1, "work": 1, "access": 2, "exchange": 3, "http": 4, "store": 3, "store/local": 4, "store/postgres": 4, "fields": 3,
          "surfaces": 5, "jobs": 6, "query": 7, "api/surfaces": 8, "api/distances": 8, "api/curves": 8, "api/smooth": 8, "api/service": 8, "": 9}

RANK = {f"engine/{room}": rank for room, rank in ENGINE.items()} | {f"proto/{room}": rank for room, rank in PROTO.items()} | {f"server/{room}".rstrip("/"): 20 + rank for room, rank in SERVER.items()}

# Libraries and the server's struct, each with the only folders or files that may include it.
BOUNDARY = {
    r"microhttpd\.h": ["server/http"],
    r"jansson\.h": ["proto", "server/query", "server/api", "clients/c"],
    r"gnutls/.*": ["server/http", "server/base"],
    r"OpenMesh/.*": [f"engine/edit/{name}" for name in ("edit_mesh.hpp", "edit_mesh.cc", "decimate.cc", "patch.cc")],
    r"zlib\.h": ["server/base", "engine/render/png.c"],
    r"minizip/.*": ["engine/io/zip.c"],
    r"expat\.h": ["engine/io/3mf_model.c"],
    r"seccomp\.h": ["server/access"],
    r"sqlite3\.h": ["server/store/local"],
    r"(postgresql/)?libpq-fe\.h": ["server/store/postgres"],
    r"server/server\.h": ["server/server.c", "server/main.c", "server/router.c", "server/gauges.c"],
}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.M)
SCRIPT_IMPORT = re.compile(r"""\b(?:from|import)\s*\(?\s*["'](\.[^"']+)["']""")
PYTHON_IMPORT = re.compile(r"^\s*from\s+\.(\w*)\s+import\s+(\([^)]*\)|.*)", re.M)
C, SCRIPT = (".c", ".h", ".cc", ".hpp"), (".ts", ".js", ".mjs")


def sources():
    for top in ("engine", "proto", "server", "clients"):
        for path in sorted(pathlib.Path(top).rglob("*")):
            if path.suffix in C + SCRIPT + (".py",) and "node_modules" not in path.parts:
                yield path


def room_of(path):
    """Returns the room of a source, or None if the source is in no room."""
    if path.parts[:2] == ("engine", "include"):
        return ROOM_OF_HEADER.get("gd/" + path.name, f"gd/{path.name}")
    folder = path.parent.as_posix()
    return folder if folder in RANK else None


def existing(*paths):
    """Returns the first of the paths that is a file of this project, or None."""
    for path in paths:
        if path.is_file():
            return pathlib.Path(os.path.normpath(path))
    return None


def imports(path, text):
    """Yields pairs: the text of an include or import, and the file of this project that it refers
    to, or None."""
    if path.suffix in C:
        places = (path.parent, pathlib.Path("."), pathlib.Path("engine"), pathlib.Path("engine/include"))
        for name in INCLUDE.findall(text):
            yield name, existing(*(place / name for place in places))
    elif path.suffix in SCRIPT:
        for name in SCRIPT_IMPORT.findall(text):
            yield name, existing(path.parent / name, path.parent / f"{name}.ts")
    else:
        for module, names in PYTHON_IMPORT.findall(text):
            for name in [module] if module else re.findall(r"\w+", names):
                yield name, existing(path.parent / f"{name}.py")


def breach(path, include, target):
    """Returns why the file may not include the target, or None."""
    for library, places in BOUNDARY.items():
        if re.fullmatch(library, include) and not any(path.is_relative_to(place) for place in places):
            return f"only {', '.join(places)} may include it"
    source, room = room_of(path), room_of(target) if target else None
    if source is None or room is None or room == source:
        return None
    if room not in RANK:
        return f"{room}: say in tests/check_layers.py which room it belongs to"
    if not source.startswith("engine/") and room.startswith("engine/") and target.parts[1] != "include":
        return "only the engine's public headers, gd/…"
    if RANK[room] >= RANK[source]:
        return f"{source} (rank {RANK[source]}) may not include {room} (rank {RANK[room]})"
    return None


def part_of(path):
    """Returns the name of a source's part."""
    if path.suffix not in C:
        return path.as_posix()
    return "gd/" + path.stem if path.parts[:2] == ("engine", "include") else path.with_suffix("").as_posix()


def circles(graph):
    """Returns sets of parts that include each other: Tarjan's strongly connected components."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            members = [stack.pop()]
            while members[-1] != node:
                members.append(stack.pop())
            if len(members) > 1:
                found.append(sorted(members))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def main():
    breaches, lines, files, graph = 0, collections.Counter(), collections.Counter(), collections.defaultdict(set)
    for path in sources():
        text = path.read_text()
        room = room_of(path) or path.parent.as_posix()
        lines[room] += text.count("\n")
        files[room] += 1
        graph[part_of(path)] |= set()
        for include, target in imports(path, text):
            why = breach(path, include, target)
            if why:
                print(f"{path}: includes {include}: {why}")
                breaches += 1
            if target and part_of(target) != part_of(path):
                graph[part_of(path)].add(part_of(target))
                graph[part_of(target)] |= set()
    found = circles(graph)
    for members in found:
        print("circle: " + " ".join(members))
    for room in sorted(lines, key=lambda room: (RANK.get(room, 99), room)):
        print(f"{RANK.get(room, ''):>4}  {room:<24} {files[room]:>3} files {lines[room]:>6} lines")
    print(f"layers: {breaches} breaches, {len(found)} circles")
    return 1 if breaches or found else 0


if __name__ == "__main__":
    sys.setrecursionlimit(10000)
    sys.exit(main())
