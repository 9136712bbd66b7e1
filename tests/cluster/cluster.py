"""A PostgreSQL server for a test, daemons that share it, and a relay that can cut a daemon off from
it. Standard library only.

    with Postgres() as database, Node(database) as one, Node(database) as two:
        one.put("square", SQUARE)
        two.get("/v1/meshes/square")

Uses the PostgreSQL programs in PATH, or Debian's. The server runs in a folder below the build
folder, on a free loopback port, as an unprivileged user (`postgres` or `nobody`, if this is root),
and ends with the test.
"""
import contextlib
import os
import pathlib
import pwd
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import weakref

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "api"))
import harness  # noqa: E402  (the daemon over HTTP)

# longest time after a replacement during which a node may still answer with the replaced mesh
# (server/doc/014)
BOUND_SECONDS = 1.0
START_SECONDS = 30
BUILD = harness.PROGRAM.parent


def program(name):
    """Returns the path of a PostgreSQL program, or None if it is not installed."""
    found = shutil.which(name)
    return found or next((str(path) for path in sorted(pathlib.Path("/usr/lib/postgresql").glob(f"*/bin/{name}"))), None)


def require():
    """Skips the tests of a module if PostgreSQL is not installed."""
    missing = [name for name in ("initdb", "postgres", "psql") if not program(name)]
    if missing:
        raise unittest.SkipTest(f"PostgreSQL is not installed ({', '.join(missing)} is missing): apt-get install postgresql")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def unprivileged():
    """Returns the user for PostgreSQL, or None for the current user. PostgreSQL refuses to run as
    root."""
    if os.geteuid() != 0:
        return None
    for name in ("postgres", "nobody"):
        with contextlib.suppress(KeyError):
            return pwd.getpwnam(name)
    raise unittest.SkipTest("PostgreSQL does not run as root, and there is no other user here")


def folder_for(user):
    """Returns a new folder below the build folder, or elsewhere if that user can't reach it."""
    place = BUILD / "cluster"
    place.mkdir(exist_ok=True)
    folder = pathlib.Path(tempfile.mkdtemp(dir=place))
    if user:
        os.chown(folder, user.pw_uid, user.pw_gid)
        if subprocess.run(["ls", folder], user=user.pw_uid, group=user.pw_gid, capture_output=True).returncode != 0:
            shutil.rmtree(folder)
            folder = pathlib.Path(tempfile.mkdtemp(dir="/var/tmp"))
            os.chown(folder, user.pw_uid, user.pw_gid)
    return folder


class Postgres:
    """A database server. Daemons connect by `url`, which has a password that must never appear in a
    log."""

    PASSWORD = "never-to-be-logged"

    def __init__(self, **settings):
        self.user = unprivileged()
        self.folder = folder_for(self.user)
        self.port = free_port()
        self.settings = {"fsync": "off", "log_min_messages": "fatal", **settings}
        self.process = None
        weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        words = self.folder / "password"
        words.write_text(self.PASSWORD)
        if self.user:
            os.chown(words, self.user.pw_uid, self.user.pw_gid)
        self._run("initdb", "--pgdata", self.folder / "data", "--username", "tester", "--pwfile", words, "--auth", "scram-sha-256",
                  "--encoding", "UTF8", "--locale", "C", "--no-sync")
        self.start()

    def _as_user(self):
        return {"user": self.user.pw_uid, "group": self.user.pw_gid, "extra_groups": []} if self.user else {}

    def _run(self, name, *arguments):
        done = subprocess.run([program(name), *arguments], capture_output=True, text=True, cwd="/", **self._as_user())
        if done.returncode != 0:
            raise RuntimeError(f"{name}: {done.stderr or done.stdout}")

    @property
    def url(self):
        return self.url_at(self.port)

    def url_at(self, port):
        """Returns the URL of the database with another port, for example the port of a relay."""
        return f"postgresql://tester:{self.PASSWORD}@127.0.0.1:{port}/postgres"

    def start(self):
        options = [part for name, value in self.settings.items() for part in ("-c", f"{name}={value}")]
        with open(self.folder / "log", "ab") as log:
            self.process = subprocess.Popen(
                [program("postgres"), "-D", self.folder / "data", "-p", str(self.port), "-h", "127.0.0.1", "-k", "", *options],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, cwd="/", **self._as_user())
        weakref.finalize(self.process, self.process.kill)
        until = time.monotonic() + START_SECONDS
        while self.query("SELECT 1", check=False) != "1":
            if self.process.poll() is not None or time.monotonic() > until:
                raise RuntimeError(f"PostgreSQL did not start: {(self.folder / 'log').read_text()}")
            time.sleep(0.05)

    def stop(self, how=signal.SIGINT):
        """Stops the server. SIGINT causes a clean, fast shutdown. SIGQUIT leaves the state that a
        crash leaves."""
        if self.process and self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(START_SECONDS)

    def query(self, text, check=True):
        """Returns the result of one statement. The columns are separated by |."""
        done = subprocess.run([program("psql"), "-qAtX", "-v", "ON_ERROR_STOP=1", "-c", text, self.url], capture_output=True, text=True)
        if check and done.returncode != 0:
            raise RuntimeError(done.stderr)
        return done.stdout.strip()

    def end_connections(self):
        """Ends every connection of a daemon, as an administrator would; returns their number."""
        return int(self.query("SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE application_name = 'geodesicd'"))

    def drop(self):
        """Deletes all data that daemons have stored."""
        self.query("DROP SCHEMA IF EXISTS geodesicd CASCADE")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)


class Node(harness.Daemon):
    """A daemon that shares the database. `port` is the port of the relay between both, if there is
    a relay."""

    def __init__(self, database, *flags, port=None, listen="127.0.0.1:0"):
        super().__init__("--store", database.url_at(port or database.port), *flags, listen=listen)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def wait_until(self, condition, seconds=harness.PATIENCE_SECONDS):
        """Waits until condition(node) is true; returns the time that it took."""
        begun = time.monotonic()
        while not condition(self):
            if time.monotonic() - begun > seconds:
                raise TimeoutError(f"not true after {seconds} s")
            time.sleep(0.002)
        return time.monotonic() - begun

    def health(self):
        return self.get("/readyz").json["status"]


class Relay:
    """A TCP relay to another port, which can be cut: `refuse` ends connections and accepts no more;
    `hold` forwards nothing more but keeps connections open (like a lost network); `mend` ends both
    states."""

    def __init__(self, target):
        self.target = target
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.refuses, self.flows = False, threading.Event()
        self.flows.set()
        self.pairs = []
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                near, _ = self.listener.accept()
            except OSError:
                return
            if self.refuses:
                near.close()
                continue
            try:
                far = socket.create_connection(("127.0.0.1", self.target))
            except OSError:
                near.close()
                continue
            self.pairs.append((near, far))
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self._pump, args=(source, sink), daemon=True).start()

    def _pump(self, source, sink):
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                self.flows.wait()
                sink.sendall(data)
        for end in (source, sink):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def cut(self):
        """Ends the current connections."""
        pairs, self.pairs = self.pairs, []
        for pair in pairs:
            for end in pair:
                with contextlib.suppress(OSError):
                    end.shutdown(socket.SHUT_RDWR)

    def refuse(self):
        self.refuses = True
        self.cut()

    def hold(self):
        self.flows.clear()

    def mend(self):
        self.refuses = False
        self.cut()
        self.flows.set()

    def close(self):
        self.refuses = True
        self.flows.set()
        self.cut()
        self.listener.close()
