#!/usr/bin/env python3
"""Measures the engine on generated and shared meshes. Prints tables, and writes bench.json into the
build folder.

usage: tests/bench/table.py [--build DIR] [--pin CPU] [--only WORD] [--quick]

With --quick the script measures almost nothing. It checks that every subcommand runs and prints the
documented members, and prints `ok` and `not ok` lines.
"""
import sys

from common import Checks, Failure, bench_arguments, find_program, machine, number, pin, print_table, record, run_lines, sample, shared, show_progress, write_json

MESHES = [
    sample("icosphere", level=5),
    sample("icosphere", "--noise", 0.3, level=6),
    sample("torus", columns=200, rows=100),
    sample("scan", faces=20000),
    sample("terrain", cells=100),
    sample("grid", columns=100, rows=100),
    sample("box", cells=40),
    sample("cylinder", sides=4000, rings=4),
    sample("obstacles", count=50),
    shared("spot"),
    shared("fandisk"),
    shared("rocker-arm"),
    shared("stanford-bunny"),
    shared("fandisk", "--subdivide", 1),
    shared("stanford-bunny", "--subdivide", 1),
    shared("stanford-bunny", "--subdivide", 2),
]
SMALL = [
    sample("icosphere", level=2),
    sample("grid", "--subdivide", 1, columns=6, rows=4),
    sample("torus", "--noise", 0.3, columns=16, rows=8),
]
LARGE = 200_000  # meshes with at least this number of faces are measured with fewer repetitions

# subcommand: repetitions, repetitions on large meshes
RUNS = {"field": (20, 5), "pair": (50, 11), "warm": (5, 2), "locate": (5, 2), "load": (7, 5), "curve": (5, 2), "trace": (2, 1)}

PROMISED = {
    "field": ["mesh", "vertices", "field_ms", "field_ms_p95", "field_cpu_ms", "first_ms", "windows_created", "windows_propagated",
              "wedges", "bytes", "peak_bytes"],
    "pair": ["mesh", "pair_ms_median", "pair_ms_p95", "first_ms", "peak_bytes"],
    "warm": ["mesh", "distances_per_s", "distances_per_s_face_order", "paths_per_s", "crossings_per_path"],
    "locate": ["mesh", "nearest_per_s", "nearest_on_surface_per_s", "rays_per_s"],
    "load": ["mesh", "read_ms", "parse_ms", "build_ms", "load_ms", "peak_bytes"],
    "curve": ["mesh", "segments", "seeding_cpu_ms", "curve_field_cpu_ms", "point_field_cpu_ms", "seeding_part", "peak_bytes"],
    "trace": ["mesh", "crossings_per_s", "log_map_ms", "mean_of_4_ms", "peak_bytes"],
}

# Subcommands with meshes of their own, and the arguments of their quickest measurement.
OWN_MESHES = {
    "limit": (["--quick"], ["mesh", "discretize_ms", "build_ms", "trace_360_ms", "shortest_360_ms", "peak_bytes"]),
    "nurbs": (["--runs", 1, "--samples", 4], ["surface", "method", "points", "error_percent", "cpu_ms"]),
}

# header, subcommand, path of keys, divisor
DISTANCES = [
    ("faces", "field", "faces", 1),
    ("field ms", "field", "field_ms", 1),
    ("p95", "field", "field_ms_p95", 1),
    ("first", "field", "first_ms", 1),
    ("wedges/edge", "field", "wedges_per_edge", 1),
    ("bytes/edge", "field", "bytes_per_edge", 1),
    ("peak MB", "field", "peak_bytes", 1e6),
    ("pair ms", "pair", "pair_ms_median", 1),
    ("p95", "pair", "pair_ms_p95", 1),
    ("load ms", "load", "load_ms", 1),
]
QUESTIONS = [
    ("distances k/s", "warm", "distances_per_s", 1e3),
    ("by face k/s", "warm", "distances_per_s_face_order", 1e3),
    ("paths k/s", "warm", "paths_per_s", 1e3),
    ("nearest k/s", "locate", "nearest_per_s", 1e3),
    ("rays k/s", "locate", "rays_per_s", 1e3),
    ("curve cpu ms", "curve", "curve_field_cpu_ms", 1),
    ("seeding %", "curve", "seeding_part", 1e-2),
    ("traced M/s", "trace", "crossings_per_s", 1e6),
    ("log ms", "trace", "log_map_ms", 1),
    ("mean ms", "trace", "mean_of_4_ms", 1),
]


def measure(bench, mesh):
    """Returns the output of each subcommand for the mesh."""
    result, large = {}, False
    for command, runs in RUNS.items():
        show_progress(f"{mesh.name}: {command}")
        line, = run_lines([bench, command, "--runs", runs[large], *mesh.arguments], timeout=900)
        result[command], large = line, line["faces"] >= LARGE
    return result


def measure_all(bench, meshes):
    """Returns the meshes' results by name, and the messages of failures."""
    results, failures = {}, []
    for mesh in meshes:
        try:
            results[mesh.name] = measure(bench, mesh)
        except Failure as failure:
            failures.append(str(failure))
    show_progress("")
    return results, failures


def cell(result, keys, divisor):
    for key in keys.split():
        result = result[key]
    return number(result / divisor)


def print_columns(columns, results):
    print_table(["mesh"] + [header for header, *_ in columns],
                [[name] + [cell(result[command], keys, divisor) for _, command, keys, divisor in columns] for name, result in results.items()])


def check_promises(bench):
    checks = Checks()
    for command, (arguments, keys) in OWN_MESHES.items():
        def test():
            for line in run_lines([bench, command, *arguments], timeout=60):
                assert not (missing := [key for key in keys if key not in line]), f"without {missing}"
        checks.check(f"gd_bench {command} prints what is promised", test)
    for mesh in SMALL:
        for command, keys in PROMISED.items():
            def test():
                line, = run_lines([bench, command, "--runs", 2, *mesh.arguments], timeout=60)
                assert not (missing := [key for key in keys if key not in line]), f"without {missing}"
                assert all(line[key] > 0 for key in keys if key.endswith("_per_s") or key in ("field_ms", "pair_ms_median", "load_ms"))
            checks.check(f"gd_bench {command} {mesh.name} prints what is promised", test)
    return checks.status


def main():
    options = bench_arguments("meshes").parse_args()
    bench = find_program(options.build / "gd_bench")
    if options.quick:
        return check_promises(bench)
    cpu, before = pin(options.pin), machine()
    results, failures = measure_all(bench, [mesh for mesh in MESHES if mesh.is_there and options.only in mesh.name])
    print_columns(DISTANCES, results)
    print()
    print_columns(QUESTIONS, results)
    for failure in failures:
        print(failure, file=sys.stderr)
    path = options.build / "bench.json"
    write_json(path, {"machine": before, "cpu": cpu, "load_at_end": machine()["load"], "meshes": results, "failures": failures})
    print(f"written: {path}; one processor, medians; load {before['load'][0]:.1f} at the start, {machine()['load'][0]:.1f} at the end")
    if options.record:
        record("engine", before)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
