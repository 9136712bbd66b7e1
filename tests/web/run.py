#!/usr/bin/env python3
"""Checks the pages' types, then tests the pages in Debian's chromium, driven by playwright-core,
against the test's own daemon.

    tests/web/run.py --build BUILD [--all] [--only WORD,WORD...]

Screenshots stay in BUILD/web-tests. Skipped without chromium, without node, or if npm could not
install playwright-core (`make web-peers`).
"""
import argparse
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE.parent / "api"))
SHARED = pathlib.Path(os.environ.get("GEODESICD_SHARED") or ROOT.parent / "shared") / "meshes"
# `make setup-test` unpacks this browser
UNPACKED = str(ROOT / "build/chromium/usr/lib/chromium/chromium-headless-shell")
BROWSERS = (UNPACKED, "chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
FACES = 70000  # faces of the mesh that points are dragged on


def browser():
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def why_not(peers):
    if not shutil.which("node"):
        return "there is no node"
    if not browser():
        return "there is no chromium (make setup-test installs it)"
    return None if (peers / "complete").exists() else "npm has not brought playwright-core (make web-peers)"


def check_types(pages):
    begun = time.monotonic()
    done = subprocess.run([ROOT / "clients/web/build.sh", "check", pages], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(f"{'not ok' if done.returncode else 'ok'} {time.monotonic() - begun:7.3f} s  web: types\n{done.stdout}", end="", flush=True)
    return done.returncode


def large_mesh(harness):
    """Returns the mesh that points are dragged on: the bunny if it is available."""
    bunny = SHARED / "stanford-bunny.obj"
    return ("bunny", bunny.read_bytes()) if bunny.exists() else ("terrain", harness.sample("terrain", cells=round((FACES / 2) ** 0.5)))


def free_origin():
    """Returns a free origin for the foreign pages that the daemon permits."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        return f"http://127.0.0.1:{free.getsockname()[1]}"


def run_in_browser(options, place, pages):
    import harness  # reads $GEODESICD

    place.mkdir(parents=True, exist_ok=True)
    host = free_origin()
    with harness.Daemon("--frame-ancestors", host, "--cors-origin", host) as daemon:
        name, file = large_mesh(harness)
        assert daemon.put(name, file).status == 201
        settings = {"url": f"http://{daemon.address}", "host": host, "daemon": daemon.process.pid, "large": name, "browser": browser(), "place": str(place),
                    "peers": str(options.build / "web-peers"), "pages": str(pages), "only": options.only.split(","), "sampler": str(options.build / "gd_sample"),
                     "all": options.all}
        return subprocess.run(["node", HERE / "main.mjs", json.dumps(settings)], stdin=subprocess.DEVNULL).returncode


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    arguments.add_argument("--all", action="store_true", help="the long form: every operation on the API's page, meshes of 1.1 million faces")
    arguments.add_argument("--only", default="", help="tests that have one of these words in their names; `types` checks the types")
    options = arguments.parse_args()
    options.build = options.build.resolve()
    os.environ.setdefault("GEODESICD", str(options.build / "geodesicd"))
    if reason := why_not(options.build / "web-peers"):
        print(f"skip web: {reason}")
        return 0
    pages = pathlib.Path(os.environ.get("PAGES_BUILD") or options.build / "web")
    failed = check_types(pages) if options.only.split(",")[0] in ("", "types") else 0
    return run_in_browser(options, options.build / "web-tests", pages.resolve()) or failed


if __name__ == "__main__":
    sys.exit(main())
