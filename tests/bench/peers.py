#!/usr/bin/env python3
"""Races the engine against other exact solvers, alternately (A B A B), on one processor. Prints a
table and writes bench-peers.json.

usage: tests/bench/peers.py [--build DIR] [--pin CPU] [--turns N] [--sources N] [--pairs N] [--only
WORD] [--long] [--clock wall|cpu] [--quick]

A peer is a program that follows the protocol in tests/bench/peer.h. CGAL's is gd_bench_cgal in the
build folder, geometry-central's gd_bench_geometry_central (made by `make bench-peers
GEOMETRY_CENTRAL=FOLDER`). The other peers are built elsewhere. Environment variables name them,
with arguments if necessary:

    VTP  LIBIGL  EXPERIMENT  EXPERIMENT_SIMD  OTHER (say, an older gd_bench peer)

OURS replaces `gd_bench peer` itself (say, by `gd_bench peer --cpu avx2`). Each turn starts both
programs on the same sources. The time of the first source is ignored, because it only warms the
programs up. A ratio is the peer's median divided by the engine's; above 1 the engine is faster.
`agree` is the largest relative difference between the two programs' sums of all distances, between
their distances of pairs, or between their numbers of crossings. --quick measures almost nothing. It
checks the protocol, and prints `ok` and `not ok` lines.
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

from common import Checks, Failure, bench_arguments, find_program, machine, number, pin, print_table, record, run_lines, sample, shared, show_progress, write_json

PEERS = ["VTP", "LIBIGL", "CGAL", "GEOMETRY_CENTRAL", "EXPERIMENT", "EXPERIMENT_SIMD", "OTHER"]
MESHES = [
    shared("stanford-bunny"),
    shared("rocker-arm"),
    shared("fandisk"),
    shared("spot"),
    sample("grid", columns=100, rows=100),
    sample("icosphere", level=5),
    shared("fandisk", "--subdivide", 1),
]
LONG = [  # some peers need minutes for a field of these meshes
    sample("icosphere", "--noise", 0.3, level=8),
    shared("stanford-bunny", "--subdivide", 2),
]
TRACED = [shared("stanford-bunny"), shared("stanford-bunny", "--subdivide", 1)]
AGREEMENT = 1e-9


class Discipline:
    """A task that programs are compared on: its option, and the names of its time and answer."""

    def __init__(self, name, option, arguments, answer):
        self.name, self.option, self.arguments, self.answer = name, option, arguments, answer

    @property
    def key(self):
        return f"{self.name}_ms"


FIELD, PAIR, TRACE = Discipline("field", [], 1, "sum"), Discipline("pair", ["--pair"], 2, "distance"), Discipline("trace", ["--trace"], 1, "crossings")


class Course:
    """A mesh in a form that every solver accepts. Also has the sources and pairs for which solvers
    are compared."""

    def __init__(self, bench, mesh, folder, options):
        self.mesh, self.path = mesh, pathlib.Path(folder) / "mesh.obj"
        with open(self.path, "wb") as file:
            done = subprocess.run([bench, "export", *mesh.arguments], stdout=file, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise Failure(f"{mesh.name}: {done.stderr.strip()}")
        with open(self.path) as file:
            kinds = [line[:2] for line in file]
        self.vertices, self.faces = kinds.count("v "), kinds.count("f ")
        draw = random.Random(1)
        self.questions = {
            FIELD: [(draw.randrange(self.vertices),) for _ in range(options.sources)],
            PAIR: [tuple(draw.sample(range(self.vertices), 2)) for _ in range(options.pairs)],
            TRACE: [(draw.randrange(self.faces),) for _ in range(options.traces)],
        }

    def command(self, program, what):
        questions = self.questions[what]
        return [*program, *what.option, self.path, *(number for question in questions[:1] + questions for number in question)]


def turn(course, program, what, timeout):
    """Starts a program once. Returns its answers without the answers of the warm-up."""
    lines = run_lines(course.command(program, what), timeout)
    expected = len(course.questions[what])
    if len(lines) != expected + 1:
        raise Failure(f"{shlex.join(program)}: {len(lines)} lines for {expected + 1} questions")
    return lines[1:]


def difference(ours, theirs, key):
    return max(abs(a[key] - b[key]) / max(abs(a[key]), abs(b[key]), 1e-300) for a, b in zip(ours, theirs))


def race(course, ours, peer, what, options):
    """Runs alternating turns of the engine and the peer. Returns the times of both programs, and
    the differences of their answers."""
    times = {side: {clock: [] for clock in (what.key, "cpu_ms")} for side in ("ours", "peer")}
    agree, turns, crossings, started = 0, 0, 0, time.monotonic()
    while turns < options.turns and (turns == 0 or time.monotonic() - started < options.patience):
        answers = {side: turn(course, program, what, options.timeout) for side, program in (("ours", ours), ("peer", peer))}
        for side, lines in answers.items():
            for clock, values in times[side].items():
                values += [line[clock] for line in lines if clock in line]
        agree = max(agree, difference(answers["ours"], answers["peer"], what.answer))
        crossings = statistics.median(line.get("crossings", 0) for line in answers["ours"])
        turns += 1
    return {"times": times, "key": what.key, "turns": turns, "agree": agree, "crossings": crossings}


def p95(values):
    return sorted(values)[int(0.95 * (len(values) - 1))]


def summarise(outcome):
    """Returns medians, 95th percentiles and ratios for both clocks, without the single times."""
    times, key = outcome["times"], outcome["key"]
    result = {"turns": outcome["turns"], "agree": outcome["agree"], "crossings": outcome["crossings"]}
    for clock, name in ((key, "wall"), ("cpu_ms", "cpu")):
        if not times["ours"][clock] or not times["peer"][clock]:
            continue
        ours, peer = statistics.median(times["ours"][clock]), statistics.median(times["peer"][clock])
        result[name] = {"ours_ms": ours, "peer_ms": peer, "ratio": peer / ours, "ours_p95_ms": p95(times["ours"][clock]),
                        "peer_p95_ms": p95(times["peer"][clock])}
    return result


def find_peers(build):
    found = {name: shlex.split(os.environ[name]) for name in PEERS if os.environ.get(name) and name != "GEOMETRY_CENTRAL"}
    for name in ("CGAL", "GEOMETRY_CENTRAL"):
        program = build / f"gd_bench_{name.lower()}"
        if program.exists() and can_race(program):
            found[name] = [str(program)]
    return {name: found[name] for name in PEERS if name in found}


def can_race(program):
    """Returns whether the program prints its usage when it gets no arguments. CGAL's program
    instead prints a message if it was built without CGAL."""
    return subprocess.run([program], stderr=subprocess.DEVNULL).returncode == 2


def disciplines(mesh, name, options):
    """Yields the tasks of a peer on a mesh."""
    if mesh in MESHES + LONG:
        yield FIELD
        if name in options.pair_peers and options.pairs:
            yield PAIR
    if mesh.name in [traced.name for traced in TRACED] and name in options.trace_peers and options.traces:
        yield TRACE


def race_all(bench, ours, peers, options):
    """Returns all results; prints each as a row of the table when it arrives."""
    results, rows, failures = [], [], []
    known = {mesh.name: mesh for mesh in TRACED + MESHES + (LONG if options.long else [])}
    for mesh in known.values():
        if not mesh.is_there or options.only not in mesh.name:
            continue
        with tempfile.TemporaryDirectory() as folder:
            course = Course(bench, mesh, folder, options)
            for name, what in [(name, what) for name in peers for what in disciplines(mesh, name, options) if options.what in ("", what.name)]:
                show_progress(f"{mesh.name}: {name} {what.name}")
                try:
                    result = summarise(race(course, ours, peers[name], what, options))
                except Failure as failure:
                    failures.append(f"{mesh.name}: {name}: {failure}")
                    continue
                results.append({"mesh": mesh.name, "vertices": course.vertices, "peer": name, "what": what.name, **result})
                rows.append(cells(results[-1], options.clock))
    show_progress("")
    return results, rows, failures


HEADERS = ["mesh", "what", "peer", "ours ms", "peer ms", "ratio", "ours p95", "peer p95", "ratio (cpu)", "turns", "agree", "ours M/s", "peer M/s"]


def millions(result, milliseconds):
    """Returns the crossings a second, in millions."""
    return number(result["crossings"] / milliseconds / 1e3 if result["crossings"] else None)


def cells(result, clock):
    times = result.get(clock) or result["wall"]
    cpu = result.get("cpu", {}).get("ratio")
    return [result["mesh"], result["what"], result["peer"], number(times["ours_ms"]), number(times["peer_ms"]), number(times["ratio"]),
            number(times["ours_p95_ms"]), number(times["peer_p95_ms"]), number(cpu), str(result["turns"]),
            f"{result['agree']:.0e}" + ("" if result["agree"] <= AGREEMENT else " DISAGREES"), millions(result, times["ours_ms"]), millions(result, times["peer_ms"])]


def check_protocol(bench, ours, peers, options):
    checks = Checks()
    options.turns, options.sources, options.pairs, options.traces = 2, 2, 2, 2
    with tempfile.TemporaryDirectory() as folder:
        course = Course(bench, sample("icosphere", level=3), folder, options)
        for name, peer in {"ours": ours, **peers}.items():
            can = {FIELD: True, PAIR: name in ("ours", *options.pair_peers), TRACE: name in ("ours", *options.trace_peers)}
            for what in (what for what, is_done in can.items() if is_done):
                def test():
                    result = summarise(race(course, ours, peer, what, options))
                    assert result["agree"] <= AGREEMENT, f"differs by {result['agree']:.1e}"
                    assert result["wall"]["ratio"] > 0
                checks.check(f"ours and {name} race for {what.name}s and agree", test)
    return checks.status


def main():
    arguments = bench_arguments("meshes")
    arguments.add_argument("--turns", type=int, default=5, help="alternating turns of each race")
    arguments.add_argument("--sources", type=int, default=3, help="fields a turn")
    arguments.add_argument("--pairs", type=int, default=50, help="pairs a turn; 0: fields only")
    arguments.add_argument("--pair-peers", nargs="*", default=["VTP", "OTHER"], help="peers that are raced for pairs too")
    arguments.add_argument("--traces", type=int, default=20, help="faces a turn from which 64 lines are traced; 0: none")
    arguments.add_argument("--trace-peers", nargs="*", default=["GEOMETRY_CENTRAL", "OTHER"], help="peers that are raced for traces too")
    arguments.add_argument("--what", choices=["", "field", "pair", "trace"], default="", help="race for this only")
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
    if options.record:
        record("engine", before)
    return 1 if failures or not results else 0


if __name__ == "__main__":
    sys.exit(main())
