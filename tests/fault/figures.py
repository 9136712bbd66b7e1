"""Figures that prove a promise. Each is a line `# figure ` followed by JSON, which tests/run.py
passes on and table.py gathers."""
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
    """Returns the least value that is not below that share of the values; NaN without values."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)] if ordered else math.nan
