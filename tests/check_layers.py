#!/usr/bin/env python3
"""Reads every #include and fails where a file includes what its room may not (README, "The house").

A file of the engine includes its own room and rooms of lower rank. proto includes gd/ headers and jansson. server includes gd/, proto/ and
its boundaries, each in one place. Tests may include anything.
"""
import pathlib
import re
import sys

RANK = {"base": 0, "mesh": 1, "io": 1, "wedge": 2, "field": 3, "line": 4, "query": 5, "transport": 6, "render": 6, "cut": 7, "subdiv": 7, "nurbs": 7}

# public headers have the rank of the room that implements them
PUBLIC = {
    "base": ["status", "vec", "control", "executor", "polygons", "number", "colour_map"],
    "mesh": ["mesh", "point", "locate", "direction"],
    "io": ["io", "control_mesh", "result_file"],
    "wedge": ["cpu", "workspace"],
    "field": ["field", "path", "isoline", "voronoi"],
    "query": ["query", "landmarks", "sampling", "curve", "curve_distance"],
    "render": ["picture"],
    "cut": ["cut"],
    "transport": ["trace", "vector", "mean", "spline", "frame", "shortening", "resampling", "offset", "flat_strip"],
    "subdiv": ["subdivision", "limit", "limit_place", "limit_path", "limit_mesh", "limit_shortest", "discretization"],
    "nurbs": ["parametric", "nurbs", "domain_curve", "tessellation", "geodesic_like", "space_distance"],
}
ROOM_OF_HEADER = {f"gd/{name}.h": room for room, names in PUBLIC.items() for name in names}

# libraries, and the only files that may include them
BOUNDARY = {
    r"microhttpd\.h": ["server/http/*"],
    r"jansson\.h": ["proto/*", "server/query/*", "server/api/*/*"],
    r"gnutls/.*": ["server/http/*", "server/base/*"],
    r"zlib\.h": ["server/base/*", "engine/render/png.c"],
    r"seccomp\.h": ["server/access/seccomp.c"],
    r"sqlite3\.h": ["server/store/local/*"],
    r"(postgresql/)?libpq-fe\.h": ["server/store/postgres/*"],
}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.M)


def room_of(path):
    parts = path.parts
    if parts[0] == "engine" and parts[1] == "include":
        return ROOM_OF_HEADER.get("gd/" + path.name, "unknown public header")
    return parts[1] if parts[0] == "engine" else parts[0]


def target_room(include):
    if include.startswith("gd/"):
        return ROOM_OF_HEADER.get(include, "unknown public header")
    first = include.split("/")[0]
    return first if first in RANK or first in ("proto", "server") else None


def breach(path, include):
    for library, places in BOUNDARY.items():
        if re.fullmatch(library, include) and not any(path.match(place) for place in places):
            return f"only {', '.join(places)} may include it"
    source, target = room_of(path), target_room(include)
    if target is None:
        return None
    if target not in RANK and target not in ("proto", "server"):
        return f"{target}: say in tests/check_layers.py which room it belongs to"
    if source in RANK:
        if target not in RANK:
            return "the engine knows nothing of proto and server"
        if RANK[target] > RANK[source] or (RANK[target] == RANK[source] and target != source):
            return f"{source} (rank {RANK[source]}) may not include {target} (rank {RANK[target]})"
    elif target in RANK and not include.startswith("gd/"):
        return "only the engine's public headers, gd/…"
    elif source == "proto" and target == "server":
        return "proto knows nothing of the server"
    return None


def main():
    breaches = 0
    for top in ("engine", "proto", "server"):
        for path in sorted(pathlib.Path(top).rglob("*")):
            if path.suffix not in (".c", ".h", ".cc", ".hpp"):
                continue
            for include in INCLUDE.findall(path.read_text()):
                why = breach(path, include)
                if why:
                    print(f"{path}: includes {include}: {why}")
                    breaches += 1
    print(f"layers: {breaches} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
