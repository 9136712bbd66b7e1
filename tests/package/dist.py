#!/usr/bin/env python3
"""Makes the files of `make dist` from a clone, and checks them: checksums, contents, the list of
parts.

    tests/package/dist.py
"""
import hashlib
import json
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
failed = 0


def expect(what, holds, told=""):
    global failed
    print(f"{'ok' if holds else 'not ok'} dist: {what}" + ("" if holds else f": {told}"), flush=True)
    failed += not holds


def make(checkout, folder):
    return subprocess.run([checkout / "docker/dist.py", folder], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def look_at_list(folder):
    [path] = folder.glob("*.spdx.json")
    document = json.loads(path.read_text())
    identifiers = [package["SPDXID"] for package in document["packages"]]
    ends = {end for each in document["relationships"] for end in (each["spdxElementId"], each["relatedSpdxElement"])}
    expect("SPDX: identifiers are unique, and relationships name them", len(set(identifiers)) == len(identifiers) and ends == {*identifiers, "SPDXRef-DOCUMENT"})
    members = {"SPDXID", "name", "downloadLocation", "filesAnalyzed", "licenseDeclared", "licenseConcluded", "copyrightText"}
    expect("SPDX: packages are complete", all(members <= package.keys() for package in document["packages"]))
    names = {package["name"] for package in document["packages"]}
    expect("SPDX: it lists what is linked and what pages contain", {"libmicrohttpd-dev", "three"} <= names, names)


def main():
    if not shutil.which("git") or not (SOURCE / ".git").exists():
        return print("skip dist: this is not a checkout of git")
    with tempfile.TemporaryDirectory() as name:
        place = pathlib.Path(name)
        subprocess.run(["git", "clone", "--quiet", "--shared", SOURCE, place / "checkout"], check=True)
        done = make(place / "checkout", place / "dist")
        expect("it is made", done.returncode == 0, done.stdout)
        rows = [line.split("  ") for line in (place / "dist/SHA256SUMS").read_text().splitlines()]
        expect("checksums are right", all(hashlib.sha256((place / "dist" / path).read_bytes()).hexdigest() == sum for sum, path in rows))
        expect("all files have one", {path for _, path in rows} | {"SHA256SUMS"} ==
               {path.relative_to(place / "dist").as_posix() for path in (place / "dist").rglob("*") if path.is_file()})
        sources = rows[0]
        with tarfile.open(place / "dist" / sources[1]) as archive:
            files = {path.partition("/")[2] for path in archive.getnames()}
        tracked = set(subprocess.run(["git", "-C", SOURCE, "ls-tree", "-r", "--name-only", "-z", "HEAD"], check=True, stdout=subprocess.PIPE, text=True).stdout.split("\0"))
        expect("the sources are the commit's files", tracked - {""} <= files, sorted(tracked - files)[:5])
        look_at_list(place / "dist")
        make(place / "checkout", place / "dist")
        expect("the sources are the same bytes each time", (place / "dist/SHA256SUMS").read_text().split("\n")[0].split("  ") == sources)
        (place / "checkout/Makefile").write_text("")
        expect("changes that are not committed are refused", make(place / "checkout", place / "other").returncode != 0)
        (place / "mine").mkdir()
        expect("a folder of others is refused", make(place / "checkout", place / "mine").returncode != 0 and (place / "mine").exists())
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
