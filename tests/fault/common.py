"""What the fault tests share: meshes that tell themselves apart, daemons to be killed, what a daemon holds."""
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
    """A tetrahedron whose edge v0-v1 has that length, in a file that is so much larger."""
    return f"v 0 0 0\nv {edge} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n#{'x' * padding}\n".encode()


def build_shim(name, folder):
    """Compiles tests/fault/<name>.c for LD_PRELOAD."""
    library = pathlib.Path(folder) / f"{name}.so"
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-std=c17", "-O1", "-shared", "-fPIC", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-o", library,
                    HERE / f"{name}.c", "-ldl", "-pthread"], check=True)
    return library


class Shimmed(Daemon):
    """A daemon under a preloaded library, if one is given: which has files of its own that the sandbox knows nothing of."""

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
    """Each mesh's name and the length that its edge v0-v1 has, by a query: so the file was read and verified."""
    found = {}
    for item in daemon.get("/v1/meshes?limit=100").json["meshes"]:
        answer = daemon.get(f"/v1/meshes/{item['name']}/distance?from=v:0&to=v:1")
        found[item["name"]] = answer.json.get("distance", answer.body)
    return found


def check(folder):
    return subprocess.run([PROGRAM, "--data-dir", folder, "--check-store"], capture_output=True, text=True, timeout=60)


class Ledger:
    """What was acknowledged, and what may have happened besides: absent is None."""

    def __init__(self):
        self.acknowledged, self.possible = {}, {}

    def begin(self, name, edge):
        self.possible.setdefault(name, []).append(edge)

    def end(self, name, edge):
        self.acknowledged[name] = edge
        self.possible[name] = []

    def faults(self, found):
        """Names whose state is neither the acknowledged one nor one that was under way."""
        wrong = []
        for name in set(self.acknowledged) | set(self.possible) | set(found):
            allowed = [self.acknowledged.get(name), *self.possible.get(name, [])]
            if found.get(name) not in allowed:
                wrong.append((name, found.get(name), allowed))
        return wrong

    def settle(self, found):
        self.acknowledged, self.possible = dict(found), {}


GONE = (http.client.HTTPException, OSError)
