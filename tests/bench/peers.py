#!/usr/bin/env python3
"""Races the engine against other exact solvers, in turn, A B A B, on one processor; prints a table, writes bench-peers.json.

usage: tests/bench/peers.py [--build DIR] [--pin CPU] [--turns N] [--sources N] [--pairs N] [--only WORD] [--long] [--clock wall|cpu] [--quick]

A peer is a program that follows the protocol in tests/bench/peer.h. CGAL's is gd_bench_cgal in the build folder. The others are built
elsewhere and named, with arguments if need be, by environment variables:

    VTP  LIBIGL  GEOMETRY_CENTRAL  EXPERIMENT  EXPERIMENT_SIMD  OTHER (say, an older gd_bench peer)

OURS replaces `gd_bench peer` itself. Each turn starts both programs on the same sources, after one that only warms them up. A ratio is
the peer's median over ours; over 1: we are faster. `agree` is the largest relative difference between the two programs' sums of all
distances, or between their distances of pairs.
--quick measures next to nothing: it checks the protocol, with `ok` and `not ok` lines.
"""
import os
import pathlib
import random
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

from common import Checks, Failure, bench_arguments, find_program, machine, number, pin, print_table, run_lines, sample, shared, show_progress, write_json

PEERS = ["VTP", "LIBIGL", "GEOMETRY_CENTRAL", "CGAL", "EXPERIMENT", "EXPERIMENT_SIMD", "OTHER"]
MESHES = [
    shared("stanford-bunny"),
    shared("rocker-arm"),
    shared("fandisk"),
    shared("spot"),
    sample("grid", columns=100, rows=100),
    sample("icosphere", level=5),
    shared("fandisk", "--subdivide", 1),
]
LONG = [  # minutes a field for some peers
    sample("icosphere", "--noise", 0.3, level=8),
    shared("stanford-bunny", "--subdivide", 2),
]
AGREEMENT = 1e-9


class Course:
    """A mesh written as every solver takes it, and the sources and pairs of its races."""

    def __init__(self, bench, mesh, folder, options):
        self.mesh, self.path = mesh, pathlib.Path(folder) / "mesh.obj"
        with open(self.path, "wb") as file:
            done = subprocess.run([bench, "export", *mesh.arguments], stdout=file, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise Failure(f"{mesh.name}: {done.stderr.strip()}")
        with open(self.path) as file:
            self.vertices = sum(line.startswith("v ") for line in file)
        draw = random.Random(1)
        self.sources = [draw.randrange(self.vertices) for _ in range(options.sources)]
        self.pairs = [tuple(draw.sample(range(self.vertices), 2)) for _ in range(options.pairs)]

    def command(self, program, pairs):
        questions = [vertex for pair in self.pairs[:1] + self.pairs for vertex in pair] if pairs else self.sources[:1] + self.sources
        return [*program, *(["--pair"] if pairs else []), self.path, *questions]


def turn(course, program, pairs, timeout):
    """One start of a program: its answers but for the warm-up's."""
    lines = run_lines(course.command(program, pairs), timeout)
    expected = len(course.pairs if pairs else course.sources)
    if len(lines) != expected + 1:
        raise Failure(f"{shlex.join(program)}: {len(lines)} lines for {expected + 1} questions")
    return lines[1:]


def difference(ours, theirs, key):
    return max(abs(a[key] - b[key]) / max(abs(a[key]), abs(b[key]), 1e-300) for a, b in zip(ours, theirs))


def race(course, ours, peer, pairs, options):
    """Alternating turns of ours and the peer; times of both by clock, and how well they agree."""
    key = "pair_ms" if pairs else "field_ms"
    times = {side: {clock: [] for clock in (key, "cpu_ms")} for side in ("ours", "peer")}
    agree, turns, started = 0, 0, time.monotonic()
    while turns < options.turns and (turns == 0 or time.monotonic() - started < options.patience):
        answers = {side: turn(course, program, pairs, options.timeout) for side, program in (("ours", ours), ("peer", peer))}
        for side, lines in answers.items():
            for clock, values in times[side].items():
                values += [line[clock] for line in lines if clock in line]
        agree = max(agree, difference(answers["ours"], answers["peer"], "distance" if pairs else "sum"))
        turns += 1
    return {"times": times, "key": key, "turns": turns, "agree": agree}


def p95(values):
    return sorted(values)[int(0.95 * (len(values) - 1))]


def summarise(outcome):
    """Medians, p95 and ratios by both clocks, without the single times."""
    times, key = outcome["times"], outcome["key"]
    result = {"turns": outcome["turns"], "agree": outcome["agree"]}
    for clock, name in ((key, "wall"), ("cpu_ms", "cpu")):
        if not times["ours"][clock] or not times["peer"][clock]:
            continue
        ours, peer = statistics.median(times["ours"][clock]), statistics.median(times["peer"][clock])
        result[name] = {"ours_ms": ours, "peer_ms": peer, "ratio": peer / ours, "ours_p95_ms": p95(times["ours"][clock]),
                        "peer_p95_ms": p95(times["peer"][clock])}
    return result


def find_peers(build):
    found = {name: shlex.split(os.environ[name]) for name in PEERS if os.environ.get(name)}
    cgal = build / "gd_bench_cgal"
    if "CGAL" not in found and cgal.exists() and can_race(cgal):
        found["CGAL"] = [str(cgal)]
    return found


def can_race(program):
    """Does it ask for arguments? CGAL's program says instead that it was built without CGAL."""
    return subprocess.run([program], stderr=subprocess.DEVNULL).returncode == 2


def race_all(bench, ours, peers, options):
    """All results, as they come also as rows of the table."""
    results, rows, failures = [], [], []
    meshes = [mesh for mesh in MESHES + (LONG if options.long else []) if mesh.is_there and options.only in mesh.name]
    for mesh in meshes:
        with tempfile.TemporaryDirectory() as folder:
            course = Course(bench, mesh, folder, options)
            for name, peer in peers.items():
                for pairs in (False, True):
                    if pairs and (name not in options.pair_peers or not options.pairs):
                        continue
                    show_progress(f"{mesh.name}: {name}{' pairs' if pairs else ''}")
                    try:
                        result = summarise(race(course, ours, peer, pairs, options))
                    except Failure as failure:
                        failures.append(f"{mesh.name}: {name}: {failure}")
                        continue
                    results.append({"mesh": mesh.name, "vertices": course.vertices, "peer": name, "what": "pair" if pairs else "field", **result})
                    rows.append(cells(results[-1], options.clock))
    show_progress("")
    return results, rows, failures


HEADERS = ["mesh", "what", "peer", "ours ms", "peer ms", "ratio", "ours p95", "peer p95", "ratio (cpu)", "turns", "agree"]


def cells(result, clock):
    times = result.get(clock) or result["wall"]
    cpu = result.get("cpu", {}).get("ratio")
    return [result["mesh"], result["what"], result["peer"], number(times["ours_ms"]), number(times["peer_ms"]), number(times["ratio"]),
            number(times["ours_p95_ms"]), number(times["peer_p95_ms"]), number(cpu), str(result["turns"]),
            f"{result['agree']:.0e}" + ("" if result["agree"] <= AGREEMENT else " DISAGREES")]


def check_protocol(bench, ours, peers, options):
    checks = Checks()
    options.turns, options.sources, options.pairs = 2, 2, 2
    with tempfile.TemporaryDirectory() as folder:
        course = Course(bench, sample("icosphere", level=3), folder, options)
        for name, peer in {"ours": ours, **peers}.items():
            for pairs in (False, True) if name in ("ours", *options.pair_peers) else (False,):
                def test():
                    result = summarise(race(course, ours, peer, pairs, options))
                    assert result["agree"] <= AGREEMENT, f"differs by {result['agree']:.1e}"
                    assert result["wall"]["ratio"] > 0
                checks.check(f"ours and {name} race for {'pairs' if pairs else 'fields'} and agree", test)
    return checks.status


def main():
    arguments = bench_arguments("meshes")
    arguments.add_argument("--turns", type=int, default=5, help="alternating turns of each race")
    arguments.add_argument("--sources", type=int, default=3, help="fields a turn")
    arguments.add_argument("--pairs", type=int, default=50, help="pairs a turn; 0: fields only")
    arguments.add_argument("--pair-peers", nargs="*", default=["VTP", "OTHER"], help="peers that are raced for pairs too")
    arguments.add_argument("--peers", nargs="*", help="only these")
    arguments.add_argument("--long", action="store_true", help="meshes of more than a million faces too")
    arguments.add_argument("--patience", type=float, default=60, help="seconds after which a race begins no further turn")
    arguments.add_argument("--timeout", type=float, default=900, help="seconds that one start of a program may take")
    arguments.add_argument("--clock", choices=["wall", "cpu"], default="wall", help="cpu: processor time, for a busy machine and one thread")
    options = arguments.parse_args()
    bench = find_program(options.build / "gd_bench")
    ours = shlex.split(os.environ.get("OURS") or f"{shlex.quote(str(bench))} peer")
    peers = {name: peer for name, peer in find_peers(options.build).items() if options.peers is None or name in options.peers}
    if options.quick:
        return check_protocol(bench, ours, peers, options)
    cpu, before = pin(options.pin), machine()
    results, rows, failures = race_all(bench, ours, peers, options)
    print_table(HEADERS, rows)
    for failure in failures:
        print(failure, file=sys.stderr)
    path = options.build / "bench-peers.json"
    write_json(path, {"machine": before, "cpu": cpu, "load_at_end": machine()["load"], "ours": ours, "peers": peers,
                      "races": results, "failures": failures})
    print(f"written: {path}; processor {cpu}; load {before['load'][0]:.1f} at the start, {machine()['load'][0]:.1f} at the end")
    return 1 if failures or not results else 0


if __name__ == "__main__":
    sys.exit(main())
