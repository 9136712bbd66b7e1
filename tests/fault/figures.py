"""Prints the figures that prove a documented limit ("promise"). Each figure is a line `# figure `
followed by JSON. tests/run.py passes these lines on, and table.py collects them."""
import json
import math

MARK = "# figure "


def report(promise, asked, measured, holds):
    """Prints a row of the table; returns whether the promise holds."""
    print(MARK + json.dumps({"promise": promise, "asked": asked, "measured": measured, "ok": bool(holds)}), flush=True)
    return bool(holds)


def conclude(name, held):
    """Prints the verdict on all promises of a program; returns its exit status."""
    print(f"ok {name}" if all(held) else f"not ok {name}")
    return 0 if all(held) else 1


def quantile(values, share):
    """Returns the smallest value that is at least as large as `share` of the values. Returns NaN if
    there are no values."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)] if ordered else math.nan
