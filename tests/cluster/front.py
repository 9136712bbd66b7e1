"""Runs HAProxy in front of nodes. Its configuration is the shipped docker/haproxy.cfg, with other
addresses and with the replacements of a test."""
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "api"))

from cluster import free_port  # noqa: E402
from harness import PATIENCE_SECONDS  # noqa: E402

SHIPPED = HERE.parent.parent / "docker/haproxy.cfg"
DRAIN_DELAY_MS = 3000  # the shipped file expects this drain delay of the nodes


class Front:
    """`ports` are the ports of the nodes. Replacements are pairs (text, new text). Each text must
    occur in the shipped file."""

    def __init__(self, ports, replacements=()):
        self.port, self.metrics_port = free_port(), free_port()
        text = SHIPPED.read_text()
        pairs = [("maxconn 8000", "maxconn 400"), ("bind :8080", f"bind 127.0.0.1:{self.port}"), ("bind :8405", f"bind 127.0.0.1:{self.metrics_port}"),
                 *((f" node{number}:8080", f" 127.0.0.1:{port}") for number, port in enumerate(ports, 1)), *replacements]
        for old, new in pairs:
            assert old in text, old
            text = text.replace(old, new)
        self.place = tempfile.TemporaryDirectory()
        file = pathlib.Path(self.place.name) / "haproxy.cfg"
        file.write_text(text)
        self.log = open(pathlib.Path(self.place.name) / "log", "w+")
        self.process = subprocess.Popen(["haproxy", "-db", "-f", file], stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT)
        self.wait_until(len(ports))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(PATIENCE_SECONDS)
        self.log.close()
        self.place.cleanup()

    def metrics(self, name):
        """Returns the values of HAProxy's metric of that name, by labels."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.metrics_port}/metrics", timeout=PATIENCE_SECONDS) as answer:
            found = re.findall(rf"^{name}\{{(.*)\}} (\S+)$", answer.read().decode(), re.M)
        return {labels: float(value) for labels, value in found}

    def up(self):
        """Returns the numbers of the nodes to which HAProxy sends requests."""
        states = self.metrics("haproxy_server_status")
        return {int(found[1]) for labels, value in states.items() if value == 1 and (found := re.search(r'server="node(\d)",state="UP"', labels))}

    def wait_until(self, count):
        until = time.monotonic() + PATIENCE_SECONDS
        while True:
            try:
                if len(self.up()) == count:
                    return
            except OSError:
                pass
            if time.monotonic() > until or self.process.poll() is not None:
                self.log.seek(0)
                raise TimeoutError(f"HAProxy does not see {count} nodes: {self.log.read()[-2000:]}")
            time.sleep(0.05)

    def total(self, name):
        return sum(value for labels, value in self.metrics(name).items() if 'proxy="nodes"' in labels)
