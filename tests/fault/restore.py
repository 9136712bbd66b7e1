#!/usr/bin/env python3
"""Kills --restore by SIGKILL at random times. A daemon must refuse to start on a partly restored
folder, and the same command must complete the folder. Also kills --backup: an unfinished copy can't
be restored until the same command completes it.

    tests/fault/restore.py [--count N] [--seed N]
"""
import argparse
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from common import PROGRAM, Shimmed, check, edges, mesh
from figures import conclude, report

MESHES = 24
REFUSAL = "is an unfinished copy"


def command(folder, *flags):
    return [PROGRAM, "--data-dir", str(folder), *flags]


def fill(folder):
    """Fills a store with meshes of 100 to 400 KB. Returns the meshes that a daemon lists for this
    store."""
    with Shimmed(folder) as daemon:
        for number in range(MESHES):
            assert daemon.put(f"m{number}", mesh(1 + number / 16, 100_000 + 10_000 * number)).status == 201
        found = edges(daemon)
    assert len(found) == MESHES
    return found


def interrupt(arguments, seconds):
    """Runs the command and kills it after that time. Returns whether the command ended earlier by
    itself."""
    process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL)
    try:
        return process.wait(seconds) == 0
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False


def what_starts(folder, whole):
    """Returns the state in which a daemon finds the folder: refused, empty (the restore had not
    begun), whole, or in part."""
    if not any(folder.glob("*")):
        return "empty"
    try:
        with Shimmed(folder) as daemon:
            return "whole" if edges(daemon) == whole else "in part"
    except RuntimeError as refusal:
        return "refused" if REFUSAL in str(refusal) else f"refused otherwise: {refusal}"


def restore_time(place, number):
    began = time.monotonic()
    subprocess.run(command(place / f"first{number}", "--restore", str(place / "source")), check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - began


class Trial:
    def __init__(self, place, source, whole, seconds):
        self.place, self.source, self.whole, self.seconds = place, source, whole, seconds
        self.seen, self.wrong = {}, []

    def once(self, number, chance):
        """Interrupts a restore one to three times, checks the folder each time, and completes
        it."""
        folder = self.place / f"restored{number}"
        for _ in range(chance.randrange(1, 4)):
            if interrupt(command(folder, "--restore", str(self.source)), chance.uniform(0, 1.1 * self.seconds)):
                break
            state = what_starts(folder, self.whole)
            self.seen[state] = self.seen.get(state, 0) + 1
            if state not in ("refused", "empty", "whole"):
                self.wrong.append(f"restore {number}: {state}")
            if state == "whole":
                break  # the command was killed after its last file was durable
        else:
            again = subprocess.run(command(folder, "--restore", str(self.source)), capture_output=True, text=True)
            if again.returncode:
                self.wrong.append(f"restore {number}, again: {again.stdout}")
        if (state := what_starts(folder, self.whole)) != "whole":
            self.wrong.append(f"restore {number}, completed: {state}")
        if (result := check(folder)).returncode:
            self.wrong.append(f"restore {number}: {result.stdout}")

    def backup_once(self, chance):
        """Checks that an interrupted backup can't be restored until the same command completes
        it."""
        copy, folder = self.place / "copy", self.place / "of-copy"
        interrupt(command(self.source, "--backup", str(copy)), chance.uniform(0.3, 0.7) * self.seconds)
        if not (copy / "unfinished").exists():
            return
        restored = subprocess.run(command(folder, "--restore", str(copy)), capture_output=True, text=True)
        if restored.returncode == 0 or REFUSAL not in restored.stdout:
            self.wrong.append(f"an unfinished backup is restored: {restored}")
        if subprocess.run(command(self.source, "--backup", str(copy)), capture_output=True).returncode:
            self.wrong.append("an unfinished backup is not completed")
        if subprocess.run(command(folder, "--restore", str(copy)), capture_output=True).returncode or what_starts(folder, self.whole) != "whole":
            self.wrong.append("a completed backup is not restored")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--count", type=int, default=8)
    arguments.add_argument("--seed", type=int, default=1)
    options = arguments.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as text:
        place = pathlib.Path(text)
        whole = fill(place / "source")
        trial = Trial(place, place / "source", whole, min(restore_time(place, number) for number in range(3)))
        for number in range(options.count):
            trial.once(number, chance)
        trial.backup_once(chance)
    seen = ", ".join(f"{count} {state}" for state, count in sorted(trial.seen.items()))
    for wrong in trial.wrong:
        print(wrong, file=sys.stderr)
    held = report("a restore that was interrupted is refused or completed, never started in part", f"{options.count} restores, 0 in part",
                  f"{options.count} restores killed once to three times: {seen}; {len(trial.wrong)} wrong", not trial.wrong and trial.seen.get("refused"))
    return conclude("restore", [held])


if __name__ == "__main__":
    sys.exit(main())
