#!/usr/bin/env python3
"""Builds the container's image and runs it, by buildah with chroot isolation, on a base made by
mmdebstrap, so that no registry is used. Skipped if one of these programs is missing, or if the user
is not root.

    tests/container/run.py [--place DIR] [--jobs N]

The base and the layers of the image take long to build. They stay in DIR (build/container) for the
next run.
"""
import argparse
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
# build arguments, and their names in the image
LABELS = {"VERSION": "version", "REVISION": "revision", "CREATED": "created", "SOURCE": "source"}
TOLD = {"VERSION": "1.2.3", "REVISION": "0123abcd", "CREATED": "2026-01-02T03:04:05Z", "SOURCE": "https://geodesicd.example/source"}
PARTS = "usr/share/doc/geodesicd/sbom.spdx.json"
BASE, IMAGE = "localhost/geodesicd-base", "localhost/geodesicd-test"
HOST_TRUST = pathlib.Path("/etc/ssl/certs/ca-certificates.crt")
PATIENCE_SECONDS = 60
USER = 10001
VIEWER = os.environ.get("VIEWER")  # VIEWER=no builds without the pages, which need npm
DATA = "/var/lib/geodesicd"
SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"


class Store:
    """Runs buildah with its images in the test's own folder."""

    def __init__(self, place):
        self.place = place
        self.environment = dict(os.environ, BUILDAH_ISOLATION="chroot", STORAGE_DRIVER="vfs")
        self.prefix = ["buildah", "--root", str(place / "root"), "--runroot", str(place / "run")]

    def __call__(self, *arguments):
        done = subprocess.run([*self.prefix, *map(str, arguments)], env=self.environment, cwd=SOURCE, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"buildah {arguments[0]} failed:\n{done.stdout[-2000:]}\n{done.stderr[-3000:]}")
        return done.stdout.strip()

    def has(self, image):
        return subprocess.run([*self.prefix, "inspect", "--type", "image", image], env=self.environment, capture_output=True).returncode == 0

    def make_base(self):
        """Makes a minimal Debian 12 from this machine's package sources, with this machine's
        trusted certificates (npm uses TLS)."""
        if self.has(BASE):
            return
        archive = self.place / "base.tar"
        subprocess.run(["mmdebstrap", "--quiet", "--variant=apt", "--include=ca-certificates", "bookworm", archive], check=True,
                       stdin=subprocess.DEVNULL, capture_output=True)
        container = self("from", "scratch")
        self("add", "-q", container, archive, "/")
        if HOST_TRUST.exists():
            self("add", "-q", container, HOST_TRUST, HOST_TRUST)
        self("commit", "-q", container, BASE)
        self("rm", container)
        archive.unlink()

    def make_image(self, jobs):
        self("bud", "-q", "--pull-never", "--layers", "--build-arg", f"BASE={BASE}", "--build-arg", f"JOBS={jobs}",
             *(part for name, text in TOLD.items() for part in ("--build-arg", f"{name}={text}")), *(["--build-arg", f"VIEWER={VIEWER}"] if VIEWER else []), "-t", IMAGE, "-f",
             "docker/Dockerfile", ".")


class Life:
    """A running container, with its log and the key that it may have printed."""

    def __init__(self, command, port, environment=None):
        self.port, self.key, self.log, self.begun = port, None, [], time.monotonic()
        self.process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.listening = threading.Event()
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for text in self.process.stderr:
            if found := re.search(r"not shown again: (gdk_\S+)", text):
                self.key = found[1]
            try:
                self.log.append(json.loads(text))
            except json.JSONDecodeError:
                self.log.append({"event": "not JSON", "message": text})
            if self.log[-1].get("event") == "listening":
                self.start_seconds = time.monotonic() - self.begun
                self.listening.set()
        self.listening.set()

    def ask(self, path, key=None, method="GET", body=None):
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", body, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_SECONDS) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as refusal:
            return refusal.code, refusal.read()

    def daemon(self):
        """Returns the daemon's process, found by its port in /proc."""
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if os.getsid(int(folder.name)) == self.process.pid and (folder / "comm").read_text() == "geodesicd\n":
                    return folder
            except OSError:
                pass
        raise RuntimeError("the daemon is not there")

    def stop(self):
        os.kill(int(self.daemon().name), signal.SIGTERM)
        status = self.process.wait(PATIENCE_SECONDS)
        self.reader.join(PATIENCE_SECONDS)
        return status


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def status_of(daemon):
    return dict(line.split(":", 1) for line in (daemon / "status").read_text().splitlines() if ":" in line)


class Trial:
    """Checks the image; prints one line for each expectation."""

    def __init__(self, store, volume):
        self.store, self.volume, self.failed = store, volume, 0
        self.image = json.loads(store("inspect", "--type", "image", IMAGE))["OCIv1"]["config"]

    def expect(self, what, holds, told=""):
        print(f"{'ok' if holds else 'not ok'} container: {what}" + ("" if holds else f": {told}"), flush=True)
        self.failed += not holds

    def settings(self, port):
        variables = dict(text.split("=", 1) for text in self.image["Env"])
        return [f"{name}={text}" for name, text in {**variables, "GEODESICD_LISTEN": f"127.0.0.1:{port}"}.items()]

    def look_at_the_image(self):
        self.expect("the image's user is not root", self.image["User"] == str(USER), self.image["User"])
        self.expect("the image listens beyond loopback", "GEODESICD_LISTEN=0.0.0.0:8080" in self.image["Env"], self.image["Env"])

    def look_at_the_labels(self):
        labels = {name.removeprefix("org.opencontainers.image."): text for name, text in self.image["Labels"].items()}
        self.expect("its labels say what it was built from", all(labels.get(label) == TOLD[name] for name, label in LABELS.items()), labels)
        self.expect("its labels say what it is", labels.get("title") == "geodesicd" and labels.get("licenses") == "MIT", labels)

    def look_at_the_parts(self, root, place):
        """Compares the list of parts with dpkg's, and checks the rules of SPDX 2.3 for identifiers
        and relations."""
        text = (root / PARTS).read_text()
        (place / "sbom.spdx.json").write_text(text)
        parts = json.loads(text)
        blocks = (root / "var/lib/dpkg/status").read_text().split("\n\n")
        installed = {tuple(re.search(rf"^{field}: (.*)$", block, re.M)[1] for field in ("Package", "Version"))
                     for block in blocks if "\nStatus: install ok installed" in block}
        listed = {(part["name"], part["versionInfo"]) for part in parts["packages"]}
        self.expect("its parts list has every package, and the daemon", listed == installed | {("geodesicd", TOLD["VERSION"])}, listed ^ installed)
        names = [part["SPDXID"] for part in parts["packages"]]
        self.expect("parts have names of their own", len(set(names)) == len(names) and all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", name) for name in names), names)
        relations = [(item["spdxElementId"], item["relationshipType"], item["relatedSpdxElement"]) for item in parts["relationships"]]
        self.expect("the list describes the daemon, which depends on all others",
                    relations == [("SPDXRef-DOCUMENT", "DESCRIBES", names[0]), *((names[0], "DEPENDS_ON", name) for name in names[1:])])
        self.expect("the list says which form it has", (parts["spdxVersion"], parts["dataLicense"], parts["creationInfo"]["created"]) == ("SPDX-2.3", "CC0-1.0", TOLD["CREATED"]))
        size = sum(path.lstat().st_size for path in root.rglob("*") if not path.is_symlink() and path.is_file())
        own = sum((root / name).stat().st_size for name in ("usr/bin/geodesicd", PARTS))
        print(f"# container: {size / 1e6:.0f} MB in {len(names)} parts, {own / 1e6:.1f} MB of them the daemon", flush=True)

    def first_life(self, container):
        """Runs the container with buildah's defaults."""
        port = free_port()
        options = [part for text in self.settings(port) for part in ("-e", text)]
        run = ["run", "--user", USER, "-v", f"{self.volume}:{DATA}", *options, container, "--"]
        life = Life([*self.store.prefix, *map(str, run), *self.image["Entrypoint"]], port, self.store.environment)
        self.expect("it starts", life.listening.wait(PATIENCE_SECONDS) and life.process.poll() is None, life.log)
        self.expect("the first start prints a key", life.key is not None, life.log)
        self.expect("without the key nothing is answered", life.ask("/v1/meshes")[0] == 401)
        self.expect("a mesh is stored", life.ask("/v1/meshes/square", life.key, "PUT", SQUARE)[0] == 201)
        self.expect("the sandbox is on", any(line["event"] == "sandbox" and line["level"] == "info" for line in life.log), life.log)
        # fails unless the daemon is healthy
        self.store(*run, "/bin/bash", "/usr/lib/geodesicd/healthcheck.sh")
        self.expect("the health check finds it well", True)
        self.expect("it runs as the image's user", status_of(life.daemon())["Uid"].split() == [str(USER)] * 4)
        self.expect("it ends when it is told to", life.stop() == 0)
        try:
            self.store(*run, "/bin/bash", "/usr/lib/geodesicd/healthcheck.sh")
            self.expect("the health check finds it gone", False)
        except RuntimeError:
            self.expect("the health check finds it gone", True)
        return life.key

    def second_life(self, container, key):
        """Runs on a read-only root, without capabilities, with the volume of the first life."""
        port, root = free_port(), self.store("mount", container)
        enter = ["chroot", root, "setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups", "--bounding-set=-all",
                 "--inh-caps=-all", "env", "-i", *self.settings(port), *self.image["Entrypoint"]]
        mounts = [f"mount --bind {root} {root}", f"mount --bind {self.volume} {root}{DATA}", f"mount --rbind /proc {root}/proc",
                  f"mount --rbind /dev {root}/dev", f"mount -o remount,bind,ro {root}"]
        script = " && ".join([*mounts, "exec " + shlex.join(enter)])
        life = Life(["unshare", "--mount", "--propagation", "private", "sh", "-c", script], port)
        self.expect("it starts on a read-only root", life.listening.wait(PATIENCE_SECONDS) and life.process.poll() is None, life.log)
        print(f"# container: listens {1000 * life.start_seconds:.0f} ms after it is started", flush=True)
        self.expect("later starts print no key", life.key is None)
        status, body = life.ask("/v1/meshes/square/distance?from=v:0&to=v:2", key)
        self.expect("the key and the mesh are there again", status == 200 and abs(json.loads(body)["distance"] - 2**0.5) < 1e-12, body)
        facts = status_of(life.daemon())
        self.expect("it has no capability", all(int(facts[name], 16) == 0 for name in ("CapEff", "CapPrm", "CapBnd")), facts)
        self.expect("its root is read-only", any(" / / ro" in line or re.search(r" / ro[, ]", line)
                                                 for line in (life.daemon() / "mountinfo").read_text().splitlines()))
        self.expect("it ends when it is told to, again", life.stop() == 0)


def why_not():
    for program in ("buildah", "mmdebstrap", "unshare"):
        if not shutil.which(program):
            return f"{program} is not installed"
    return None if os.geteuid() == 0 else "chroot isolation wants root"


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--place", type=pathlib.Path, default=SOURCE / "build/container")
    arguments.add_argument("--jobs", type=int, default=2)
    options = arguments.parse_args()
    if reason := why_not():
        print(f"skip container: {reason}")
        return 0
    options.place.mkdir(parents=True, exist_ok=True)
    store = Store(options.place.resolve())
    begun = time.monotonic()
    store.make_base()
    store.make_image(options.jobs)
    print(f"# container: image built in {time.monotonic() - begun:.0f} s", flush=True)
    with tempfile.TemporaryDirectory() as volume:
        os.chown(volume, USER, USER)
        trial = Trial(store, volume)
        trial.look_at_the_image()
        container = store("from", "--pull-never", IMAGE)
        try:
            trial.look_at_the_labels()
            trial.look_at_the_parts(pathlib.Path(store("mount", container)), store.place)
            trial.second_life(container, trial.first_life(container))
        finally:
            store("rm", container)
    return 1 if trial.failed else 0


if __name__ == "__main__":
    sys.exit(main())
