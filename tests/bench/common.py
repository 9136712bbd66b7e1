"""Helpers of the benchmark scripts: arguments, running programs that print JSON lines, tables, and
paths."""
import argparse
import datetime
import json
import os
import pathlib
import platform
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("GEODESICD_SHARED") or ROOT.parent / "shared") / "meshes"


class Failure(Exception):
    """A program failed; the sentence says which one and how."""


def run_lines(command, timeout):
    """Returns the JSON lines that the command prints, as dicts."""
    text = shlex.join(map(str, command))
    try:
        done = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        raise Failure(f"{text}: no end after {timeout:g} s") from None
    except OSError as error:
        raise Failure(f"{text}: {error.strerror}") from None
    if done.returncode != 0:
        raise Failure(f"{text}: exit status {done.returncode}: {done.stderr.strip()[-300:]}")
    try:
        return [json.loads(line) for line in done.stdout.splitlines()]
    except ValueError:
        raise Failure(f"{text}: prints what is not JSON: {done.stdout[:200]!r}") from None


def bench_arguments(kind):
    """Returns a parser of the common arguments; `kind` names what --only selects ("meshes")."""
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build"))
    arguments.add_argument("--pin", type=int, help="the processor to run on; the last one if not given")
    arguments.add_argument("--only", default="", help=f"only {kind} whose name has this in it")
    arguments.add_argument("--quick", action="store_true", help="only check that it works")
    arguments.add_argument("--record", action="store_true", help="append the tables to tests/bench/results")
    return arguments


def find_program(path):
    """Returns the path; ends this program if there is no such file."""
    if not path.exists():
        sys.exit(f"{path} is not there: make {path}")
    return path


class Mesh:
    """A mesh of the benchmark: a short name, and gd_bench's arguments for it."""

    def __init__(self, name, *arguments):
        self.name, self.arguments = name, [str(argument) for argument in arguments]

    @property
    def is_there(self):
        path = self.arguments[-1]
        return path.startswith("sample:") or os.path.exists(path)


def sample(name, *options, **parameters):
    """Returns a generated mesh, named by its sample and parameters."""
    text = ",".join([name] + [f"{key}={value}" for key, value in parameters.items()])
    return Mesh(" ".join([text, *map(str, options)]), *options, "sample:" + text)


def shared(name, *options):
    """Returns one of the shared test meshes, which may be missing."""
    return Mesh(" ".join([name, *map(str, options)]), *options, SHARED / f"{name}.obj")


def pin(cpu):
    """Pins this process and its children to one processor. None selects the last permitted
    processor. Returns the number of the processor."""
    cpu = max(os.sched_getaffinity(0)) if cpu is None else cpu
    os.sched_setaffinity(0, {cpu})
    return cpu


def machine():
    """Returns a description of the machine, and the date."""
    try:
        model = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    except OSError:
        model = None
    return {"processor": model.group(1) if model else platform.machine(), "processors": os.cpu_count(), "load": os.getloadavg(),
            "system": platform.platform(), "time": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")}


def write_json(path, value):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(value, indent=1) + "\n")


def number(value, digits=3):
    """Formats a number with three significant digits, but with all digits before the point. Returns
    a dash for None."""
    if value is None:
        return "-"
    if value == 0 or abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.{max(0, digits - len(str(int(abs(value)))) + (abs(value) < 1))}f}"


def show_progress(words):
    """Shows progress on one line of standard error, if that is a terminal; the line is never
    cleared."""
    if sys.stderr.isatty():
        print(f"\r{words}\033[K", end="", file=sys.stderr, flush=True)


PRINTED = []  # the tables of this run, for record()


def record(kind, before):
    """Appends the tables of this run to results/KIND.md, under a heading with date and machine."""
    path = ROOT / "tests" / "bench" / "results" / f"{kind}.md"
    lines = [f"\n## Measured {before['time'][:10]}: {before['processor']}, {before['processors']} processors\n",
             f"Load {before['load'][0]:.1f} at the start, {machine()['load'][0]:.1f} at the end.\n"]
    for headers, rows in PRINTED:
        marks = ["---"] * len(headers)
        lines += ["| " + " | ".join(row) + " |" for row in [headers, marks, *rows]] + [""]
    with path.open("a", encoding="utf-8") as file:
        file.write("\n".join(lines).rstrip() + "\n")
    print(f"recorded: {path}")


def print_table(headers, rows):
    """Prints columns. Aligns the first column to the left, and the others to the right."""
    PRINTED.append((headers, rows))
    widths = [max(len(row[i]) for row in [headers, *rows]) for i in range(len(headers))]
    for row in [headers, *rows]:
        print("  ".join(cell.rjust(width) if i else cell.ljust(width) for i, (cell, width) in enumerate(zip(row, widths))).rstrip())
    sys.stdout.flush()


class Checks:
    """Prints `ok` and `not ok` lines for tests/run.py, and computes the exit status."""

    def __init__(self):
        self.failed = 0

    def check(self, name, test):
        """Runs the test, which raises or asserts when it fails."""
        try:
            test()
            print(f"ok {name}")
        except (Failure, AssertionError, KeyError, OSError) as error:
            self.failed += 1
            print(f"not ok {name}: {type(error).__name__}: {error}")
        sys.stdout.flush()

    @property
    def status(self):
        return 1 if self.failed else 0
