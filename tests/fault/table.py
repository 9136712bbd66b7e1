#!/usr/bin/env python3
"""Runs the programs that prove the promises, one after the other, and prints their measurements as
one table.

    tests/fault/table.py [--timeout SECONDS] [--only WORD] PROGRAM...

A program is a command, or `promise | asked | command`. A program may print rows of the table itself
(figures.py). For a program that prints none, the table has one row, made from `promise`, `asked`
and the number of its tests. If the program fails, its last row fails.
"""
import argparse
import json
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from figures import MARK  # noqa: E402
from run import run  # noqa: E402

HEAD = ("promise", "asked", "measured", "ok")


def rows_of(spec, timeout):
    promise, asked, command = ([part.strip() for part in spec.split(" | ")] if " | " in spec else ("", "", spec))
    print(f"{command} …", flush=True)
    _, output, passed, failed, skipped, seconds = run(command, timeout)
    for line in output.splitlines():
        if failed or re.match(r"# (?!figure|ok|not ok)", line):
            print("     " + line)
    print(f"{'FAIL' if failed else 'ok  '} {command}  {passed} passed, {failed} failed, {skipped} skipped, {seconds:.0f} s", flush=True)
    found = [json.loads(line[len(MARK) :]) for line in output.splitlines() if line.startswith(MARK)]
    rows = [[figure["promise"], figure["asked"], figure["measured"], figure["ok"]] for figure in found]
    if not rows:
        notes = [line[2:] for line in output.splitlines() if re.match(r"# (?!ok|not ok)", line)]
        skips = f", {skipped} skipped" if skipped else ""
        measured = "; ".join(notes) if notes else f"{passed} tests passed, {failed} failed{skips}"
        rows = [[promise or command, asked or "no failure", measured, True]]
    if failed:
        rows[-1][3] = False
    return rows


def print_table(rows):
    texts = [HEAD, *([*map(str, row[:3]), "yes" if row[3] else "NO"] for row in rows)]
    room = max(80, shutil.get_terminal_size((200, 24)).columns)
    widths = [max(len(row[column]) for row in texts) for column in range(2)]
    measured = max(40, room - sum(widths) - 12)
    for row in texts:
        parts = [row[2][at : at + measured] for at in range(0, max(1, len(row[2])), measured)]
        for number, part in enumerate(parts):
            first = number == 0
            print(f"| {row[0] if first else '':{widths[0]}} | {row[1] if first else '':{widths[1]}} | {part:{measured}} | {row[3] if first else '':3} |")
        if row is HEAD:
            print(f"|{'-' * (widths[0] + 2)}|{'-' * (widths[1] + 2)}|{'-' * (measured + 2)}|-----|")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--timeout", type=float, default=14400)
    arguments.add_argument("--only", default="")
    arguments.add_argument("programs", nargs="+")
    options = arguments.parse_args()
    rows = []
    for spec in options.programs:
        if options.only in spec:
            rows += rows_of(spec, options.timeout)
    print()
    print_table(rows)
    kept = sum(row[3] for row in rows)
    print(f"\n{kept} of {len(rows)} hold")
    return 0 if kept == len(rows) and rows else 1


if __name__ == "__main__":
    sys.exit(main())
