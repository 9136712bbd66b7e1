"""Helpers of the fault tests: distinguishable meshes, daemons that can be killed, and the resources
that a daemon holds."""
import http.client
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "api"))

import harness  # noqa: E402
from harness import PROGRAM, Daemon  # noqa: E402


def mesh(edge, padding=0):
    """Returns a tetrahedron whose edge v0-v1 has length `edge`, in a file enlarged by `padding`
    bytes."""
    return f"v 0 0 0\nv {edge} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n#{'x' * padding}\n".encode()


def build_shim(name, folder):
    """Compiles tests/fault/<name>.c for LD_PRELOAD."""
    library = pathlib.Path(folder) / f"{name}.so"
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-std=c17", "-O1", "-shared", "-fPIC", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-o", library,
                    HERE / f"{name}.c", "-ldl", "-pthread"], check=True)
    return library


class Shimmed(Daemon):
    """A daemon under an optional preloaded library. The daemon runs without its sandbox, which
    would forbid the library's files."""

    def __init__(self, folder, *flags, library=None, environment=None):
        saved = dict(os.environ)
        os.environ.update(environment or {})
        if library:
            os.environ["LD_PRELOAD"] = str(library)
        sandbox = ("--sandbox", "off") if library else ()
        try:
            super().__init__("--data-dir", str(folder), "--workers", "2", "--http-threads", "2", *sandbox, *flags)
        finally:
            os.environ.clear()
            os.environ.update(saved)

    def kill(self):
        self.process.kill()
        self.process.wait()
        self._reader.join()
        self.process.stderr.close()


def edges(daemon):
    """Returns the name of each mesh, with the length of its edge v0-v1. The length is from a query,
    for which the daemon reads and verifies the mesh's file."""
    found = {}
    for item in daemon.get("/v1/meshes?limit=100").json["meshes"]:
        answer = daemon.get(f"/v1/meshes/{item['name']}/distance?from=v:0&to=v:1")
        found[item["name"]] = answer.json.get("distance", answer.body)
    return found


def check(folder):
    return subprocess.run([PROGRAM, "--data-dir", folder, "--check-store"], capture_output=True, text=True, timeout=60)


class Ledger:
    """Records the acknowledged states, and the states that unacknowledged changes may have caused.
    The state None means that the mesh is absent."""

    def __init__(self):
        self.acknowledged, self.possible = {}, {}

    def begin(self, name, edge):
        self.possible.setdefault(name, []).append(edge)

    def end(self, name, edge):
        self.acknowledged[name] = edge
        self.possible[name] = []

    def faults(self, found):
        """Yields the names whose state is neither the acknowledged state nor the state after an
        unacknowledged change."""
        wrong = []
        for name in set(self.acknowledged) | set(self.possible) | set(found):
            allowed = [self.acknowledged.get(name), *self.possible.get(name, [])]
            if found.get(name) not in allowed:
                wrong.append((name, found.get(name), allowed))
        return wrong

    def settle(self, found):
        self.acknowledged, self.possible = dict(found), {}


GONE = (http.client.HTTPException, OSError)
