#!/usr/bin/env python3
"""Tests files of other programs. Uploads every mesh file under a folder, queries random points of
each, and checks the laws of a distance.

    tests/fault/wild.py FOLDER [--only WORD] [--points N] [--list]

A file that is refused is uploaded again with repair=split. Prints a table with a row for each
folder under FOLDER, then the reasons of refusals, each with its number of files; --list also prints
the files. The exit status is 0 if no law is broken and no request ends in a 5xx.
"""
import argparse
import collections
import contextlib
import itertools
import json
import math
import pathlib
import random
import re
import sys

from common import GONE, Daemon

SUFFIXES = {".obj", ".ply", ".off", ".stl", ".glb", ".gltf", ".3mf", ".coff", ".noff"}
TOLERANCE = 1e-9  # relative tolerance, as README promises
COLUMNS = ("files", "answered", "repaired", "refused", "laws broken", "5xx")


class Broken(Exception):
    """A law does not hold, or a request had no permitted answer."""

    def __init__(self, column, sentence):
        super().__init__(sentence)
        self.column = column


class Questions:
    """Queries of one mesh, on one connection."""

    def __init__(self, daemon, connection):
        self.daemon, self.connection = daemon, connection

    def ask(self, path):
        answer = self.daemon.request("GET", f"/v1/meshes/wild/{path}", connection=self.connection)
        if answer.status != 200:
            column = "5xx" if answer.status >= 500 else "laws broken"
            raise Broken(column, f"{path}: {answer.status} {answer.json['detail']}")
        return answer.json

    def distance(self, a, b):
        """Returns the distance, or infinity if no path joins the points."""
        found = self.ask(f"distance?from={a}&to={b}")["distance"]
        return math.inf if found is None else found

    def path(self, a, b):
        """Returns the length of the path and the sum of its segments."""
        found = self.ask(f"path?from={a}&to={b}&geometry=xyz")["path"]
        return found["length"], math.fsum(map(math.dist, found["points"], found["points"][1:]))


def random_points(description, count):
    """Returns points in the mesh's bounding box; the daemon uses the nearest points of the
    surface."""
    chance = random.Random(description["sha256"])
    box = description["bounding_box"]
    corners = list(zip(box["min"], box["max"]))
    return ["p:" + ",".join(repr(chance.uniform(low, high)) for low, high in corners)
            for _ in range(count)]


def hold(law, is_held, *values):
    if not is_held:
        raise Broken("laws broken", f"{law}: {', '.join(map(repr, values))}")


def check_laws(questions, points):
    """Checks the laws of a distance: it is the same in both directions, it is zero from a point to
    itself, it is at most the sum via a third point, and it is the length of the path."""
    distances = {(a, b): questions.distance(a, b) for a, b in itertools.permutations(points, 2)}
    slack = TOLERANCE * max((value for value in distances.values() if value < math.inf), default=0)
    for a in points:
        hold("d(p, p) = 0", questions.distance(a, a) == 0, a)
    for a, b in itertools.combinations(points, 2):
        there, back = distances[a, b], distances[b, a]
        hold("d(p, q) = d(q, p)", there == back or abs(there - back) <= slack, a, b, there, back)
        if there < math.inf:
            length, total = questions.path(a, b)
            is_held = max(abs(length - there), abs(total - there)) <= slack
            hold("path length = d(p, q)", is_held, a, b, there, length, total)
    for a, b, c in itertools.permutations(points, 3):
        detour = distances[a, b] + distances[b, c] + slack
        hold("d(p, r) <= d(p, q) + d(q, r)", distances[a, c] <= detour, a, b, c)


def upload(daemon, path):
    """Returns the answer of the first accepted upload, and whether the upload was repaired. If no
    upload is accepted, returns the first answer."""
    body = path.read_bytes()
    first = daemon.put("wild", body)
    if first.status < 400 or first.status >= 500:
        return first, False
    second = daemon.put("wild", body, "?repair=split")
    is_better = second.status == 201 or second.status >= 500
    return (second, True) if is_better else (first, False)


def reason_of(problem):
    """Returns the problem's code and sentence without the parts that differ between files."""
    sentence = re.sub(r"'[^']*'", "'…'", problem["detail"])
    return f"{problem['code']}: " + re.sub(r"-?\d+(\.\d+)?([eE][-+]?\d+)?", "#", sentence)


def try_file(daemon, path, points):
    """Returns the table column in which the file is counted, and the sentence with the reason."""
    answer, is_repaired = upload(daemon, path)
    if answer.status >= 500:
        return "5xx", answer.json["detail"]
    if answer.status != 201:
        return "refused", reason_of(answer.json)
    with contextlib.closing(daemon.connect()) as connection:
        check_laws(Questions(daemon, connection), random_points(answer.json, points))
    return ("repaired", json.dumps(answer.json["repair"])) if is_repaired else ("answered", "")


def try_folder(folder, options):
    """Yields for each file its path within the folder, the column and the sentence."""
    files = sorted(path for path in folder.rglob("*")
                   if path.suffix.lower() in SUFFIXES and options.only in str(path))
    with Daemon() as daemon:
        for path in files:
            try:
                column, sentence = try_file(daemon, path, options.points)
            except Broken as broken:
                column, sentence = broken.column, str(broken)
            except GONE as error:
                column, sentence = "5xx", f"no answer: {error!r}"
            daemon.request("DELETE", "/v1/meshes/wild")
            yield path.relative_to(folder), column, sentence


def print_table(results):
    rows = collections.defaultdict(collections.Counter)
    for path, column, _ in results:
        for row in (path.parts[0] if len(path.parts) > 1 else ".", "all"):
            rows[row].update([column, "files"])
    width = max(map(len, rows), default=0)
    print(" " * width, *COLUMNS, sep="  ")
    for name, counts in sorted(rows.items(), key=lambda row: (row[0] == "all", row[0])):
        cells = (str(counts[column]).rjust(len(column)) for column in COLUMNS)
        print(name.ljust(width), *cells, sep="  ")


def print_reasons(results, is_listed):
    for column in ("refused", "laws broken", "5xx", *(["repaired"] if is_listed else [])):
        reasons = collections.defaultdict(list)
        for path, found, sentence in results:
            if found == column:
                reasons[sentence].append(path)
        for sentence, paths in sorted(reasons.items(), key=lambda item: -len(item[1])):
            print(f"{column}, {len(paths)}: {sentence}")
            for path in paths if is_listed else ():
                print(f"    {path}")


def main():
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("folder", type=pathlib.Path)
    arguments.add_argument("--only", default="", help="only files that have this in their path")
    arguments.add_argument("--points", type=int, default=4,
                           help="of each mesh; every pair is asked both ways")
    arguments.add_argument("--list", action="store_true", help="name the files of each reason")
    options = arguments.parse_args()
    results = list(try_folder(options.folder, options))
    print_table(results)
    print_reasons(results, options.list)
    return 1 if any(column in ("laws broken", "5xx") for _, column, _ in results) else 0


if __name__ == "__main__":
    sys.exit(main())
