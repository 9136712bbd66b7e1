#!/usr/bin/env python3
"""Cost against mesh size: plots time, wedges and bytes of a field for families of meshes, as
log-log plots (SVG) with fitted exponents.

usage: tests/bench/plots.py [--build DIR] [--pin CPU] [--max-faces N] [--only WORD] [--quick]

Writes growth-time.svg, growth-wedges.svg, growth-bytes.svg and growth.json into the build folder. A
family ends when its next mesh would take too long or need more memory than the machine has.
--quick measures tiny meshes, and prints `ok` and `not ok` lines.
"""
import math
import os
import pathlib
import sys
import tempfile
import xml.etree.ElementTree

from common import Checks, Failure, bench_arguments, find_program, machine, number, pin, print_table, run_lines, sample, shared, write_json

GIB = 2**30
MACHINE_GIB = 24  # memory of the machine for which the largest mesh is estimated
FIT_FROM = 4000  # number of faces; constant costs dominate on smaller meshes
PATIENCE_MS = 60_000  # fields that would take longer are omitted


def doubling(make):
    """Returns a family of about 1000, 2000, 4000… faces: `make` is called with the number of
    faces."""
    return lambda step: make(1000 * 2**step)


def root(value):
    return max(3, round(math.sqrt(value)))


def subdivided(name):
    return lambda step: shared(name, "--subdivide", step) if step <= 5 else None


def torus(faces, *options):
    return sample("torus", *options, columns=root(faces), rows=root(faces / 4))


def needles(faces):
    """Returns the lateral surface of a prism with four rings, and as many sides as the number of
    faces requires."""
    return sample("cylinder", sides=faces // 8, rings=4) if faces <= 1_048_576 else None


def stretched_torus(faces):
    """Returns a torus with faces some twenty times as long as wide."""
    return sample("torus", columns=root(faces / 16), rows=8 * root(faces / 16))


# name: colour, step -> mesh, or None if there is no larger mesh
FAMILIES = {
    "smooth torus": ("#1f77b4", doubling(torus)),
    "smooth scan": ("#17becf", doubling(lambda faces: sample("scan", faces=faces) if faces <= 500_000 else None)),
    "noisy torus": ("#ff7f0e", doubling(lambda faces: torus(faces, "--noise", 0.3))),
    "noisy sphere": ("#d62728", lambda step: sample("icosphere", "--noise", 0.3, level=step + 3) if step <= 6 else None),
    "flat grid": ("#2ca02c", doubling(lambda faces: sample("grid", columns=root(faces / 2), rows=root(faces / 2)))),
    "CAD: box": ("#004d40", doubling(lambda faces: sample("box", cells=root(faces / 12)) if faces <= 4_320_000 else None)),
    "CAD: fandisk, subdivided": ("#8c564b", subdivided("fandisk")),
    "terrain": ("#9467bd", doubling(lambda faces: sample("terrain", cells=root(faces / 2)))),
    "slivers: steep terrain": ("#e377c2", doubling(lambda faces: sample("terrain", cells=root(faces / 2), amplitude=20))),
    "slivers: needles": ("#7f7f7f", doubling(needles)),
    "slivers: prisms": ("#bcbd22", lambda step: sample("obstacles", count=25 * 2**min(step, 3), level=1 + max(0, step - 3)) if step <= 6 else None),
    "anisotropic torus": ("#000000", doubling(stretched_torus)),
}

# file, the plotted quantity, its key in the output of gd_bench field
QUANTITIES = [
    ("growth-time.svg", "milliseconds of processor time a field", "field_cpu_ms"),
    ("growth-wedges.svg", "wedges of a field", "wedges"),
    ("growth-bytes.svg", "bytes of a field", "bytes"),
]


# --- measuring ----------------------------------------------------------------------------------


def runs_for(faces):
    return 5 if faces < 100_000 else 3 if faces < 1_000_000 else 1


def fits(points, faces):
    """Returns whether a mesh of this many faces fits into the permitted time and memory, if the
    cost continues to grow at the rate of the last two meshes."""
    if not points:
        return True
    last, power = points[-1], fit(points, "peak_bytes")[0] if len(points) > 2 else 1.5
    growth = (faces / last["faces"]) ** max(1, power)
    available = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return last["field_ms"] * growth < PATIENCE_MS and last["peak_bytes"] * growth < 0.8 * available


def expect(points):
    """Returns the number of faces of the next mesh, if the family continues to grow at the same
    rate."""
    if len(points) < 2:
        return 2 * points[0]["faces"] if points else 0
    return points[-1]["faces"] ** 2 / points[-2]["faces"]


def measure_family(bench, make, max_faces):
    """Returns the lines of gd_bench field, beginning with the smallest mesh, and the reason why the
    family ended."""
    points = []
    while True:
        mesh, next_faces = make(len(points)), expect(points)
        if mesh is None or not mesh.is_there:
            return points, "no larger member" if points else "not there"
        if next_faces > 1.1 * max_faces:
            return points, "--max-faces"
        if not fits(points, next_faces):
            return points, "the next would take too long or too much memory"
        try:
            line, = run_lines([bench, "field", "--runs", runs_for(next_faces), *mesh.arguments], timeout=1200)
        except Failure as failure:
            print(failure, file=sys.stderr)
            return points, "failure"
        if line["faces"] > 1.1 * max_faces:
            return points, "--max-faces"
        points.append(line)


def fit(points, key):
    """Returns exponent and factor of key = factor * faces^exponent, by least squares of the
    logarithms; (nan, nan) with one point."""
    used = [point for point in points if point["faces"] >= FIT_FROM] or points
    used = used if len(used) > 1 else points
    x, y = [math.log(point["faces"]) for point in used], [math.log(point[key]) for point in used]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - mean_x) ** 2 for a in x)
    if not spread:
        return math.nan, math.nan
    exponent = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / spread
    return exponent, math.exp(mean_y - exponent * mean_x)


def largest(points):
    """Returns the number of faces for which the process would fill the machine's memory.
    Extrapolates from the largest mesh by the growth of the peak, which is at least linear."""
    last, exponent = points[-1], fit(points, "peak_bytes")[0]
    return last["faces"] * (MACHINE_GIB * GIB / last["peak_bytes"]) ** (1 / max(1, exponent if exponent == exponent else 1))


# --- drawing ------------------------------------------------------------------------------------

WIDTH, HEIGHT = 980, 560
LEFT, RIGHT, TOP, BOTTOM = 90, 330, 50, 60


class Axes:
    """Maps decades of faces and of a quantity to the page."""

    def __init__(self, series, key):
        faces = [point["faces"] for points in series.values() for point in points]
        values = [point[key] for points in series.values() for point in points]
        self.x = math.log10(min(faces)) - 0.1, math.log10(max(faces)) + 0.1
        self.y = math.floor(math.log10(min(values))), math.floor(math.log10(max(values))) + 1

    @staticmethod
    def decades(limits):
        return range(math.ceil(limits[0]), math.floor(limits[1]) + 1)

    def at(self, x, y):
        across = (math.log10(x) - self.x[0]) / (self.x[1] - self.x[0])
        up = (math.log10(y) - self.y[0]) / (self.y[1] - self.y[0])
        return LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM)


def text(x, y, words, anchor="start", size=13, more=""):
    escaped = words.replace("&", "&amp;").replace("<", "&lt;")
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"{more}>{escaped}</text>'


def line(x1, y1, x2, y2, colour):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}"/>'


def power_of_ten(exponent):
    return f"{10.0**exponent:,.0f}" if 0 <= exponent <= 6 else f"{10.0**exponent:g}"


def grid_lines(axes):
    for decade in axes.decades(axes.x):
        x, bottom = axes.at(10.0**decade, 10.0 ** axes.y[0])
        yield line(x, TOP, x, bottom, "#ddd")
        yield text(x, bottom + 20, power_of_ten(decade), "middle")
    for decade in axes.decades(axes.y):
        left, y = axes.at(10.0 ** axes.x[0], 10.0**decade)
        yield line(left, y, WIDTH - RIGHT, y, "#ddd")
        yield text(left - 8, y + 4, power_of_ten(decade), "end")


def curve(axes, points, key, colour):
    places = [axes.at(point["faces"], point[key]) for point in points]
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    yield f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.6"/>'
    for x, y in places:
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>'


def plot(series, key, title):
    """Returns an SVG page with one curve for each family. The legend has the exponents, the
    steepest curve first."""
    axes, middle = Axes(series, key), (LEFT + WIDTH - RIGHT) / 2
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">',
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>', text(middle, 28, f"{title}, against faces", "middle", 16), *grid_lines(axes),
             text(middle, HEIGHT - 14, "faces", "middle"), text(0, 0, title, "middle", more=f' transform="translate(22 {HEIGHT / 2}) rotate(-90)"')]
    exponents = {name: fit(points, key)[0] for name, points in series.items()}
    for row, name in enumerate(sorted(series, key=lambda name: -exponents[name])):
        colour, y = FAMILIES[name][0], TOP + 16 + 24 * row
        parts += curve(axes, series[name], key, colour)
        parts += [f'<rect x="{WIDTH - RIGHT + 20}" y="{y - 9}" width="12" height="12" fill="{colour}"/>',
                  text(WIDTH - RIGHT + 40, y + 2, f"{name}: faces^{exponents[name]:.2f}")]
    return "\n".join([*parts, "</svg>", ""])


# --- the program --------------------------------------------------------------------------------


def row_of(name, points, ending):
    last, estimate = points[-1], largest(points)
    return [name, f"{last['faces']:,}", number(last["field_cpu_ms"]), *(f"{fit(points, key)[0]:.2f}" for _, _, key in QUANTITIES),
            number(last["wedges_per_edge"]), number(last["bytes_per_edge"]), f"{estimate / 1e6:,.1f}M" if estimate else "-", ending]


HEADERS = ["family", "faces", "cpu ms", "time ^", "wedges ^", "bytes ^", "wedges/edge", "bytes/edge", f"fits {MACHINE_GIB} GiB", "ended by"]


def write_plots(folder, series):
    for file, title, key in QUANTITIES:
        (folder / file).write_text(plot(series, key, title))


def check_plots(bench):
    checks = Checks()

    def test():
        names = ("smooth torus", "flat grid", "noisy sphere")
        series = {name: measure_family(bench, FAMILIES[name][1], 6000)[0] for name in names}
        assert all(len(points) >= 2 for points in series.values())
        with tempfile.TemporaryDirectory() as folder:
            write_plots(pathlib.Path(folder), series)
            for file, _, _ in QUANTITIES:
                assert "faces^" in "".join(xml.etree.ElementTree.parse(pathlib.Path(folder) / file).getroot().itertext())

    checks.check("plots of growth are drawn", test)
    for name, (_, make) in FAMILIES.items():
        def smallest():
            mesh = make(0)
            assert not mesh.is_there or run_lines([bench, "field", "--runs", 1, *mesh.arguments], timeout=60)
        checks.check(f"the smallest mesh of the family \"{name}\" has a field", smallest)
    return checks.status


def main():
    arguments = bench_arguments("families")
    arguments.add_argument("--max-faces", type=int, default=300_000)
    options = arguments.parse_args()
    bench = find_program(options.build / "gd_bench")
    if options.quick:
        return check_plots(bench)
    cpu, before = pin(options.pin), machine()
    series, rows = {}, []
    for name, (_, make) in FAMILIES.items():
        if options.only not in name:
            continue
        points, ending = measure_family(bench, make, options.max_faces)
        print(f"{name}: {len(points)} sizes, ended by {ending}", file=sys.stderr, flush=True)
        if len(points) > 1:
            series[name] = points
            rows.append(row_of(name, points, ending))
    if not series:
        sys.exit("plots.py: nothing was measured: no family has two meshes that fit.")
    print_table(HEADERS, rows)
    write_plots(options.build, series)
    write_json(options.build / "growth.json", {"machine": before, "cpu": cpu, "load_at_end": machine()["load"], "families": series})
    print(f"written: {', '.join(str(options.build / file) for file, _, _ in QUANTITIES)}, {options.build / 'growth.json'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
