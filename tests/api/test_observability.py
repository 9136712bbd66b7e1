"""Tests the tools for operators. The dashboard and the alerts use existing metrics, the daemon logs
slow requests, and it passes trace headers on."""
import json
import pathlib
import re
import subprocess
import unittest

import yaml

from harness import PROGRAM, Daemon, Folder, TestCase, sample

DOCKER = pathlib.Path(__file__).resolve().parents[2] / "docker"
NAME = re.compile(r"\bgeodesicd_[a-z_]+")


def expressions(node):
    """Yields every `expr` in a document."""
    if isinstance(node, dict):
        for name, value in node.items():
            if name == "expr":
                yield value
            else:
                yield from expressions(value)
    elif isinstance(node, list):
        for item in node:
            yield from expressions(item)


class Documents(Folder):
    def setUp(self):
        super().setUp()
        keys = pathlib.Path(self.place.name) / "keys"
        made = subprocess.run([PROGRAM, "keygen", "a", "--role", "operator"], check=True, capture_output=True, text=True).stdout
        key, line = made.splitlines()
        keys.write_text(line + "\n")
        with self.start("--scrub-s", "1", "--keys", str(keys)) as daemon:
            daemon.get("/v1")
            self.text = daemon.get("/metrics", Authorization=f"Bearer {key}").body.decode()

    def names(self):
        """Returns the names of the metrics. A histogram also adds the names of its series."""
        kinds = dict(line.split()[2:4] for line in self.text.splitlines() if line.startswith("# TYPE "))
        parts = {f"{name}_{part}" for name, kind in kinds.items() if kind == "histogram" for part in ("bucket", "sum", "count")}
        return set(kinds) | parts

    def assert_known(self, document):
        known, asked = self.names(), set()
        for expression in expressions(document):
            asked |= set(NAME.findall(expression))
        self.assertGreater(len(asked), 5)
        self.assertEqual(asked - known, set())
        return asked

    def test_dashboard(self):
        dashboard = json.loads((DOCKER / "grafana-dashboard.json").read_text())
        asked = self.assert_known(dashboard)
        self.assertEqual(len({panel["id"] for panel in dashboard["panels"]}), len(dashboard["panels"]))
        self.assertLessEqual({"geodesicd_queue_depth", "geodesicd_workers_busy", "geodesicd_request_seconds_bucket",
                              "geodesicd_problems_total", "geodesicd_field_windows_total"}, asked)

    def test_alerts(self):
        document = yaml.safe_load((DOCKER / "alerts.yaml").read_text())
        self.assert_known(document)
        codes = set(re.findall(r'problems_total\{code="([a-z_]+)"\}', self.text))
        for rule in document["groups"][0]["rules"]:
            self.assertIn(rule["labels"]["severity"], ("warning", "critical"))
            self.assertTrue(rule["annotations"]["summary"].endswith("."))
            self.assertLessEqual(set(re.findall(r'code="([a-z_]+)"', rule["expr"])), codes, rule["alert"])

    def test_metrics_have_the_format_of_prometheus(self):
        helped = re.findall(r"^# HELP (\S+) .+\.$", self.text, re.M)
        typed = re.findall(r"^# TYPE (\S+) (?:counter|gauge|histogram)$", self.text, re.M)
        self.assertEqual(helped, typed)
        self.assertEqual(len(set(typed)), len(typed))
        for line in self.text.splitlines():
            if not line.startswith("#"):
                self.assertRegex(line, r'^geodesicd_[a-z_]+(\{[a-z]+="[^"\\]*"(,[a-z]+="[^"\\]*")*\})? [-+.0-9e]+$')
        for line in self.text.splitlines():
            if (found := re.match(r"# TYPE (\S+) counter", line)):
                self.assertTrue(found[1].endswith("_total"), found[1])


class Work(TestCase):
    def test_windows_are_counted(self):
        self.daemon.put("ball", sample("icosphere", level=3))
        before = self.daemon.metric("field_windows_total")
        self.daemon.ask_often("ball", "v:0")
        self.assertEqual(self.daemon.metric("field_windows_total"), before, "searches build no field")
        self.daemon.get("/v1/meshes/ball/distance?from=v:0&to=v:9")
        built = self.daemon.metric("field_windows_total")
        edges = self.daemon.get("/v1/meshes/ball").json["edges"]
        self.assertGreater(built - before, edges / 2)
        self.daemon.get("/v1/meshes/ball/distance?from=v:0&to=v:99")
        self.assertEqual(self.daemon.metric("field_windows_total"), built, "a cached field costs nothing")


class Slow(unittest.TestCase):
    TRACE = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01"

    def lines(self, *flags):
        """Returns the log lines of a request that takes longer than 5 ms, and of 20 fast requests.
        On a busy machine some of these take longer, too."""
        with Daemon(*flags) as daemon:
            daemon.put("ball", sample("icosphere", level=6), traceparent=self.TRACE, X_Request_Id="slow")
            for number in range(20):
                daemon.request("GET", "/livez", headers={"X-Request-Id": f"fast{number}"})
        return {line["request_id"]: line for line in daemon.log if "request_id" in line}

    def test_slow_requests_are_logged_with_their_trace(self):
        lines = self.lines("--slow-ms", "5")
        self.assertEqual((lines["slow"]["event"], lines["slow"]["level"]), ("slow_request", "warn"))
        self.assertEqual(lines["slow"]["traceparent"], self.TRACE)
        self.assertGreaterEqual(lines["slow"]["ms"], 5)
        self.assertIn(("request", "info"), [(line["event"], line["level"]) for line in lines.values()])

    def test_slow_requests_are_not_logged_by_default(self):
        self.assertEqual({line["event"] for line in self.lines().values()}, {"request"})


if __name__ == "__main__":
    unittest.main()
