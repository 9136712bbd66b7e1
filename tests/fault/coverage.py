#!/usr/bin/env python3
"""Prints which lines and branches of engine, proto and server the tests have covered, by folder and
in total. The build must have been tested with --coverage (make coverage).

    tests/fault/coverage.py --build DIR
"""
import argparse
import collections
import json
import pathlib
import shutil
import subprocess
import sys

from figures import conclude, report

HOUSES = ("engine", "proto", "server")
ASKED = {"line": 90, "branch": 80}


def measure(build):
    """Returns gcovr's summary of each source."""
    folders = [str(build / "obj" / house) for house in HOUSES]
    filters = [text for house in HOUSES for text in ("--filter", f"{house}/")]
    done = subprocess.run(["gcovr", "-r", ".", "--object-directory", str(build), *filters, "--json-summary", "-", *folders], check=True,
                          stdout=subprocess.PIPE, stdin=subprocess.DEVNULL)
    return json.loads(done.stdout)["files"]


def room_of(name):
    parts = name.split("/")
    return "/".join(parts[:2]) if parts[0] == "engine" else parts[0]


def percent(tally, kind):
    return 100 * tally[f"{kind}_covered"] / max(1, tally[f"{kind}_total"])


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", type=pathlib.Path, required=True)
    options = arguments.parse_args()
    if not shutil.which("gcovr"):
        print("skip coverage: wants gcovr")
        return 0
    rooms, total = collections.defaultdict(collections.Counter), collections.Counter()
    for file in measure(options.build.resolve()):
        counts = {key: file[key] for kind in ASKED for key in (f"{kind}_covered", f"{kind}_total")}
        rooms[room_of(file["filename"])].update(counts)
        total.update(counts)
    for room, tally in sorted(rooms.items()):
        print(f"# {room:>16}: {percent(tally, 'line'):5.1f} % of {tally['line_total']} lines, {percent(tally, 'branch'):5.1f} % of {tally['branch_total']} branches")
    return conclude("coverage", [report(f"{kind} coverage of {', '.join(HOUSES)}", f">= {asked} %",
                                        f"{percent(total, kind):.1f} % of {total[f'{kind}_total']}", percent(total, kind) >= asked)
                                 for kind, asked in ASKED.items()])


if __name__ == "__main__":
    sys.exit(main())
