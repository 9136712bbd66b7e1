#!/usr/bin/env python3
"""Runs two fuzz targets at a time, each for some time, starting from their corpora.

usage: tests/fuzz/run.py --seconds N [--seed N] PROGRAM...

fuzz_NAME starts from corpus/NAME, which it does not change. Inputs that cover more code stay in the
program's folder for the next run. With a fixed seed they are deleted, so each such run starts from
corpus/NAME alone. Prints `ok NAME` or `not ok NAME` with executions and coverage. Inputs on which a
target failed stay in the program's folder.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "fault"))

from figures import report  # noqa: E402


HERE = pathlib.Path(__file__).resolve().parent


def fuzz(program, seconds, seed):
    name = program.name.removeprefix("fuzz_")
    place = tempfile.TemporaryDirectory()
    grown = pathlib.Path(place.name) if seed else program.parent / "corpus" / name
    grown.mkdir(parents=True, exist_ok=True)
    bound = f"-max_total_time={seconds}" if seconds else "-runs=0"
    command = [program.resolve(), bound, f"-seed={seed}", "-max_len=4096", "-timeout=20", "-rss_limit_mb=1024",
               f"-artifact_prefix={program.parent.resolve()}/{name}-"]
    words = HERE / f"{name}.dict"
    command += [f"-dict={words}"] if words.exists() else []
    command += [grown.resolve(), HERE / "corpus" / name]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace")
    runs = re.findall(r"Done (\d+) runs", done.stdout)
    coverage = re.findall(r"cov: (\d+)", done.stdout)
    return name, done.returncode, int(runs[-1] if runs else 0), int(coverage[-1] if coverage else 0), done.stdout


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--seconds", type=int, default=60, help="0: replay the corpus only")
    arguments.add_argument("--seed", type=int, default=0, help="0: another one each time")
    arguments.add_argument("programs", nargs="+", type=pathlib.Path)
    options = arguments.parse_args()
    failed = executions = 0
    before = os.times()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        for name, status, runs, edges, output in pool.map(lambda p: fuzz(p, options.seconds, options.seed), options.programs):
            print(f"{'not ok' if status else 'ok'} fuzz_{name}")
            print(f"# fuzz_{name}: {runs} executions, {edges} edges covered")
            executions += runs
            if status:
                failed += 1
                print(output[-4000:])
    now = os.times()
    hours = (now.children_user + now.children_system - before.children_user - before.children_system) / 3600
    report(f"fuzzing of {len(options.programs)} targets, both sanitizers", "0 findings",
           f"{executions} executions in {hours:.2f} hours of processor time, {failed} findings", not failed)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
