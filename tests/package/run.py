#!/usr/bin/env python3
"""Checks `make install` and the Debian packages: they are complete, work when installed, and can be
removed.

    tests/package/run.py [--build DIR] [--chroot]

Packages the files in DIR, so run `make build client-c` first. --chroot: installs the hardened
packages of `make deb` in a fresh Debian (mmdebstrap, as root), starts the daemon by the command of
its systemd unit, sends requests, and removes everything again. Parts whose programs are missing
(debhelper, lintian, pkg-config) are skipped with a message.
"""
import argparse
import math
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
VERSION = re.search(r'SERVER_VERSION "(.*)"', (SOURCE / "server/base/version.h").read_text())[1]

EXPECTED = {
    "geodesicd": {"/usr/bin/geodesicd", "/lib/systemd/system/geodesicd.service", "/etc/geodesicd/environment",
                  "/usr/share/man/man8/geodesicd.8.gz", "/usr/share/doc/geodesicd/copyright"},
    "geodesicd-clients": {"/usr/bin/geodesic", "/usr/share/man/man1/geodesic.1.gz", "/usr/share/bash-completion/completions/geodesic",
                          "/usr/share/zsh/vendor-completions/_geodesic", "/usr/share/fish/vendor_completions.d/geodesic.fish",
                          "/usr/lib/python3/dist-packages/geodesicd/__init__.py"},
    "libgeodesic0": {"/usr/lib/{multiarch}/libgeodesic.so.0", "/usr/lib/{multiarch}/libgeodesic-tools.so.0", "/usr/lib/{multiarch}/libgeodesic-smooth.so.0"},
    "libgeodesic-dev": {"/usr/include/geodesic/gd/geodesic.h", "/usr/lib/{multiarch}/libgeodesic.so", "/usr/lib/{multiarch}/libgeodesic.a",
                        "/usr/lib/{multiarch}/pkgconfig/geodesic.pc", "/usr/share/man/man3/geodesic.3.gz",
                        "/usr/share/doc/libgeodesic-dev/examples/geodesic.c"},
    "libgeodesicd-dev": {"/usr/include/geodesicd.h", "/usr/include/geodesicd.hpp",
                         "/usr/lib/{multiarch}/cmake/geodesicd-client/geodesicd-client-config.cmake", "/usr/lib/{multiarch}/libgeodesicd-client.a", "/usr/lib/{multiarch}/pkgconfig/geodesicd-client.pc"},
}


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), cwd=SOURCE, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, **options)
    if done.returncode:
        raise RuntimeError(f"{command[0]} {command[1]} ended with {done.returncode}:\n{done.stdout[-3000:]}")
    return done.stdout


class Report:
    """Prints a line for each expectation."""

    def __init__(self):
        self.failed = 0

    def expect(self, what, holds, told=""):
        print(f"{'ok' if holds else 'not ok'} package: {what}" + ("" if holds else f": {told}"), flush=True)
        self.failed += not holds

    def skip(self, what, reason):
        print(f"skip package: {what}: {reason}", flush=True)


def make(build, *targets):
    """Runs make with the compiler and flags of the tests, which make passes in the environment."""
    return run("make", "--no-print-directory", f"BUILD={build}", *targets)


# --- make install -------------------------------------------------------------------------------


def look_at_libraries(report, build, prefix):
    """Builds a user's program with the flags of pkg-config and nothing else."""
    if not shutil.which("pkg-config"):
        return report.skip("libraries by pkg-config", "pkg-config is not installed")
    found = dict(os.environ, PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"))
    flags = run("pkg-config", "--cflags", "--libs", "geodesic", env=found).split()
    run("cc", "-std=c17", HERE / "around_the_cube.c", "-o", prefix / "cube", *flags)
    distance = float(run(prefix / "cube", "", env={"LD_LIBRARY_PATH": str(prefix / "lib")}))
    report.expect("the installed engine computes", abs(distance - math.sqrt(5)) < 1e-14, distance)
    flags = run("pkg-config", "--cflags", "--libs", "geodesicd-client", env=found).split()
    run("cc", "-std=c17", SOURCE / "clients/c/example.c", "-o", prefix / "example", *flags)
    report.expect("the client library links", (prefix / "example").exists())
    version = run("pkg-config", "--modversion", "geodesic", env=found).strip()
    report.expect("libraries have the daemon's version", version == VERSION, version)
    for name in ("cube", "example"):
        (prefix / name).unlink()


def look_at_install(report, build):
    with tempfile.TemporaryDirectory() as place:
        prefix = pathlib.Path(place) / "usr"
        make(build, "install", f"PREFIX={prefix}")
        report.expect("the installed daemon runs", run(prefix / "bin/geodesicd", "--version") == f"geodesicd {VERSION}\n")
        alone = {"PATH": os.environ["PATH"], "HOME": place}
        report.expect("the installed command runs", run(prefix / "bin/geodesic", "--version", env=alone).strip() == VERSION)
        unit = (prefix / "lib/systemd/system/geodesicd.service").read_text()
        report.expect("the unit starts what was installed", f"ExecStart={prefix}/bin/geodesicd " in unit)
        look_at_libraries(report, build, prefix)
        make(build, "uninstall", f"PREFIX={prefix}")
        left = [path for path in prefix.rglob("*") if not path.is_dir()]
        report.expect("uninstall leaves no file", not left, left)


# --- the Debian packages ------------------------------------------------------------------------


def packages_of(build):
    return {path.name.partition("_")[0]: path for path in (build / "deb").glob("*.deb")}


def look_at_packages(report, build):
    packages = packages_of(build)
    report.expect("there are all packages and no others", set(packages) == set(EXPECTED), packages)
    multiarch = run("dpkg-architecture", "-qDEB_HOST_MULTIARCH").strip()
    for name, package in packages.items():
        paths = {line.split(maxsplit=5)[5].removeprefix(".").partition(" -> ")[0] for line in run("dpkg-deb", "--contents", package).splitlines()}
        paths = {path.replace("/usr/lib/systemd/", "/lib/systemd/") for path in paths}
        expected = {path.format(multiarch=multiarch) for path in EXPECTED[name]}
        report.expect(f"{name} has what it should", expected <= paths, expected - paths)
        version = run("dpkg-deb", "--field", package, "Version").strip()
        report.expect(f"{name} has the daemon's version", version == VERSION, version)
    report.expect("settings are a conffile", run("dpkg-deb", "--info", packages["geodesicd"], "conffiles").split() == ["/etc/geodesicd/environment"])
    if not shutil.which("lintian"):
        return report.skip("lintian", "it is not installed")
    root = ["--allow-root"] if os.geteuid() == 0 else []
    said = subprocess.run(["lintian", *root, "--fail-on", "error,warning", *packages.values()], capture_output=True, text=True)
    report.expect("lintian has nothing to say", said.returncode == 0 and not said.stdout, said.stdout + said.stderr)


# --- in a fresh Debian --------------------------------------------------------------------------


def dependencies(packages):
    """Returns the names of the other packages on which these packages depend."""
    fields = ",".join(run("dpkg-deb", "--field", package, "Depends") for package in packages)
    return sorted({word.split()[0] for word in fields.split(",") if word.split()} - set(EXPECTED))


class Fresh:
    """A minimal Debian with the dependencies of the packages, but without the packages."""

    def __init__(self, place, packages):
        self.root = place / "root"
        run("mmdebstrap", "--quiet", "--variant=minbase", f"--include={','.join([*dependencies(packages), 'gcc', 'g++', 'pkg-config'])}", "bookworm", self.root)
        for package in packages:
            shutil.copy(package, self.root / "tmp")

    def __call__(self, *command, **variables):
        clean = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C.UTF-8", **variables}
        return run("unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c",
                   f'mount --bind /dev {self.root}/dev && mount -t proc proc {self.root}/proc && exec chroot {self.root} "$@"', "sh", *command, env=clean)

    def files(self):
        """Returns all files, without those in which dpkg and apt keep their state."""
        skipped = ("proc", "dev", "sys", "run", "tmp", "var/lib/dpkg", "var/cache", "var/log", "var/lib/systemd/deb-systemd-helper-enabled")
        inside = (str(path.relative_to(self.root)) for path in self.root.rglob("*"))
        return {path for path in inside if not path.startswith(skipped)}


# Runs the command of the systemd unit with the unit's user and settings. Then runs a demo by the
# installed command.
SESSION = r"""
set -eu
unit=/lib/systemd/system/geodesicd.service
of() { sed -n "s/^$1=-\{0,1\}//p" $unit; }
set -a; . "$(of EnvironmentFile)"; set +a
setpriv --reuid="$(of User)" --regid="$(of Group)" --clear-groups --bounding-set=-all --inh-caps=-all --no-new-privs $(of ExecStart) 2>/tmp/log &
daemon=$!
for _ in $(seq 200); do grep -qs '"listening"' /tmp/log && break; sleep 0.05; done
export GEODESICD_URL=http://$GEODESICD_LISTEN
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n' >/tmp/square.obj
geodesic upload /tmp/square.obj >/dev/null
geodesic distance square v:1 v:3
kill $daemon; wait $daemon
stat -c '%U %a' /var/lib/geodesicd
"""


def look_at_a_life(report, fresh):
    installed = sorted(f"/tmp/{path.name}" for path in (fresh.root / "tmp").glob("*.deb"))
    before = fresh.files()
    fresh("dpkg", "--install", *installed)
    settings = fresh.root / "etc/geodesicd/environment"
    settings.write_text(settings.read_text() + f"GEODESICD_LISTEN=127.0.0.1:{free_port()}\n")
    told = fresh("sh", "-c", SESSION).split("\n")
    report.expect("the daemon answers, started as its unit says", abs(float(told[0]) - math.sqrt(2)) < 1e-15, told)
    report.expect("its folder is its own", told[1] == "geodesicd 700", told)
    log = (fresh.root / "tmp/log").read_text()
    report.expect("its sandbox is on", '"level":"info","event":"sandbox"' in log or re.search(r'"event":"sandbox"[^\n]*info|info[^\n]*"event":"sandbox"', log), log)
    (fresh.root / "tmp/cube.c").write_bytes((HERE / "around_the_cube.c").read_bytes())
    cube = fresh("sh", "-c", "cc -o /tmp/cube /tmp/cube.c $(pkg-config --cflags --libs geodesic) && /tmp/cube")
    report.expect("a program is built with the engine", abs(float(cube) - math.sqrt(5)) < 1e-14, cube)
    fresh("dpkg", "--install", *installed)
    report.expect("installed again, settings stay", "GEODESICD_LISTEN=127" in settings.read_text())
    fresh("dpkg", "--remove", *EXPECTED)
    stored = list((fresh.root / "var/lib/geodesicd").rglob("*"))
    report.expect("removed, meshes and settings stay", settings.exists() and stored)
    fresh("dpkg", "--purge", *EXPECTED)
    left = {path for path in fresh.files() - before if not path.startswith(("etc/passwd", "etc/shadow", "etc/group", "etc/gshadow", "etc/subuid", "etc/subgid"))}
    report.expect("purged, nothing is left but the user", not left, sorted(left))


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def look_at_hardening(report, package):
    with tempfile.TemporaryDirectory() as place:
        run("dpkg-deb", "--extract", package, place)
        program = f"{place}/usr/bin/geodesicd"
        header, symbols = run("readelf", "--wide", "--dynamic", "--file-header", program), run("readelf", "--wide", "--dyn-syms", program)
    report.expect("hardened: position-independent, bound at once, checked copies, stack protector",
                  all((re.search(r"DYN \(Position-Independent", header), "NOW" in header, "_chk@" in symbols, "__stack_chk_fail" in symbols)))


def look_in_chroot(report, build, place):
    missing = [program for program in ("mmdebstrap", "unshare", "setpriv") if not shutil.which(program)]
    if missing or os.geteuid() != 0:
        return report.skip("in a fresh Debian", f"{', '.join(missing)} not installed" if missing else "wants root")
    packages = packages_of(build)
    look_at_hardening(report, packages["geodesicd"])
    look_at_a_life(report, Fresh(pathlib.Path(place), packages.values()))


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", type=pathlib.Path, default=SOURCE / "build")
    arguments.add_argument("--chroot", action="store_true")
    options = arguments.parse_args()
    build, report = options.build.resolve(), Report()
    look_at_install(report, build)
    if not shutil.which("dh") or not shutil.which("dh_python3"):
        report.skip("Debian packages", "debhelper and dh-python are not installed")
        return report.failed > 0
    begun = time.monotonic()
    make(build, "deb", *([] if options.chroot else [f"DEB_BUILD={build}"]))
    look_at_packages(report, build)
    if options.chroot:
        with tempfile.TemporaryDirectory() as place:
            look_in_chroot(report, build, place)
    print(f"# packages of {sum(path.stat().st_size for path in packages_of(build).values()) / 1e6:.1f} MB built and looked at in {time.monotonic() - begun:.0f} s")
    return report.failed > 0


if __name__ == "__main__":
    sys.exit(main())
