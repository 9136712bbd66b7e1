"""The scenario that every client goes through (clients/scenario.json)."""
import json
import pathlib

CLIENTS = pathlib.Path(__file__).resolve().parents[2] / "clients"
STEPS = json.loads((CLIENTS / "scenario.json").read_text())["steps"]


def check(test, answer, expected, where=""):
    """The answer has all that is expected."""
    if isinstance(expected, dict):
        for name, value in expected.items():
            test.assertIn(name, answer, where)
            check(test, answer[name], value, f"{where}/{name}")
    elif isinstance(expected, list):
        test.assertEqual(len(answer), len(expected), where)
        for index, value in enumerate(expected):
            check(test, answer[index], value, f"{where}/{index}")
    elif isinstance(expected, float):
        test.assertAlmostEqual(answer, expected, delta=1e-12 * abs(expected), msg=where)
    else:
        test.assertEqual(answer, expected, where)
