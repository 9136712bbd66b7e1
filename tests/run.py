#!/usr/bin/env python3
"""Runs test programs and reports how many tests passed.

usage: tests/run.py [--jobs N] [--timeout SECONDS] PROGRAM... [--waiting PROGRAM...]

A program is a cmocka binary (its TAP output is counted), or any other command that prints lines `ok
NAME` / `not ok NAME` / `skip NAME: REASON`. The output of a failed program is shown, without the
tests that passed. Skipped tests, and lines that begin with `# ` (figures worth reporting), are
always shown. A program is reported when it has ended. The last line is `N passed, N failed, N
skipped`; the exit status is 0 only if nothing failed and something passed.

The number of programs that run at once is one more than the number of cores. Programs of --waiting
mostly wait for daemons, so they need little of a processor: one of them runs at a time, beside the
others. Programs begin in the given order.
"""
import argparse
import collections
import concurrent.futures
import os
import re
import shlex
import subprocess
import sys
import threading
import time

OK = re.compile(r"^ok\b(?!.*# SKIP)", re.M | re.I)
NOT_OK = re.compile(r"^not ok\b(?!.*# SKIP)", re.M)
# also matches "not ok", which cmocka prints for skipped tests
SKIP = re.compile(r"^((not )?ok\b.*# SKIP|skip\b)", re.M | re.I)


def run(command, timeout):
    started = time.monotonic()
    environment = dict(os.environ, CMOCKA_MESSAGE_OUTPUT="TAP")
    # makes the allocators of sanitizers return NULL as malloc does, because some tests need failed
    # allocations
    environment.setdefault("ASAN_OPTIONS", "allocator_may_return_null=1:detect_stack_use_after_return=1")
    try:
        done = subprocess.run(shlex.split(command), env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=timeout, text=True, errors="replace")
        output, status = done.stdout, done.returncode
    except subprocess.TimeoutExpired as late:
        output = (late.stdout or b"").decode(errors="replace") + f"\nno end after {timeout} s\n"
        status = -1
    passed, failed, skipped = (len(pattern.findall(output)) for pattern in (OK, NOT_OK, SKIP))
    # the program crashed or timed out, or a sanitizer reported an error
    if status != 0 and not failed:
        failed = 1
    return command, output, passed, failed, skipped, time.monotonic() - started


class Programs:
    """The programs that have not begun."""

    def __init__(self, computing, waiting):
        self.computing, self.waiting = collections.deque(computing), collections.deque(waiting)
        self.is_one_waiting = False  # a program of --waiting runs
        self.lock = threading.Lock()

    def run_next(self, timeout):
        with self.lock:
            waits = bool(self.waiting) and not (self.is_one_waiting and self.computing)
            program = (self.waiting if waits else self.computing).popleft()
            self.is_one_waiting |= waits
        try:
            return run(program, timeout)
        finally:
            with self.lock:
                self.is_one_waiting &= not waits


def worth_telling(output, failed):
    """Returns a failed program's output without the tests that passed: logs are truncated, and must
    keep the failures. For a program that has not failed, returns its skips and the lines that begin
    with `# `. Tests in C print the reason of a skip in a line before it."""
    reasons = re.findall(r"^# skipped: (.*)", output, re.M)
    told = []
    for line in output.splitlines():
        if skipped := re.match(r"(?:not )?ok \d+ # SKIP (.*)", line):
            told.append(f"skip {skipped[1]}: {reasons.pop(0) if reasons else 'no reason is given'}")
        elif SKIP.match(line) or (not OK.match(line) if failed else re.match(r"# (?!ok|not ok|skipped: )", line)):
            told.append(line)
    return told


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--jobs", type=int, default=(os.cpu_count() or 1) + 1)
    arguments.add_argument("--timeout", type=float, default=1200)
    arguments.add_argument("--waiting", nargs="+", default=[])
    arguments.add_argument("programs", nargs="+")
    options = arguments.parse_args()
    programs = Programs(options.programs, options.waiting)
    count = len(options.programs) + len(options.waiting)
    total = [0, 0, 0]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for future in concurrent.futures.as_completed([pool.submit(programs.run_next, options.timeout) for _ in range(count)]):
            command, output, passed, failed, skipped, seconds = future.result()
            total = [total[0] + passed, total[1] + failed, total[2] + skipped]
            print(f"{'FAIL' if failed else 'ok  '} {command}  {passed} passed, {failed} failed, {skipped} skipped, {seconds:.1f} s")
            for line in worth_telling(output, failed):
                print("     " + line)
            sys.stdout.flush()
    print(f"{total[0]} passed, {total[1]} failed, {total[2]} skipped")
    return 0 if total[0] and not total[1] else 1


if __name__ == "__main__":
    sys.exit(main())
