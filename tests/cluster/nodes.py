"""Daemons behind a proxy. Each daemon keeps its port. It can be killed, started again, and
restarted by SIGTERM as by an operator."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "api"))
sys.path.insert(0, str(HERE.parent / "fault"))

import harness  # noqa: E402
from cluster import free_port  # noqa: E402
from front import DRAIN_DELAY_MS  # noqa: E402

FLAGS = ("--drain-delay-ms", str(DRAIN_DELAY_MS), "--max-address-connections", "0", "--http-threads", "1", "--workers", "1")


class Member:
    """A member of the cluster, which is a daemon and its port. `flags` select the store for its
    meshes."""

    def __init__(self, *flags):
        self.port, self.flags = free_port(), (*FLAGS, *flags)
        self.start()

    def start(self):
        self.daemon = harness.Daemon(*self.flags, listen=f"127.0.0.1:{self.port}")

    def kill(self):
        self.daemon.process.kill()
        self.daemon.process.wait()

    def stop(self):
        if self.daemon.process.poll() is None:
            self.daemon.process.terminate()
        return self.daemon.stop()
