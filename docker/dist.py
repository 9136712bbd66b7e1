#!/usr/bin/env python3
"""Writes the files of a release: the sources, the packages of the clients, a software bill of
materials, and checksums.

usage: docker/dist.py FOLDER

Writes into FOLDER: geodesicd-VERSION.tar.gz (the files of the commit; a commit gives the same bytes
each time); the Python and npm packages of the clients, if the tools for them are installed;
geodesicd-VERSION.spdx.json (SPDX 2.3); SHA256SUMS. The working tree must have no uncommitted
changes.
"""
import datetime
import gzip
import hashlib
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[1]


def git(*arguments):
    return subprocess.run(["git", "-C", SOURCE, *arguments], check=True, stdout=subprocess.PIPE).stdout


def pack_sources(folder, name):
    archive = git("archive", "--format=tar", f"--prefix={name}/", "HEAD")
    (folder / f"{name}.tar.gz").write_bytes(gzip.compress(archive, mtime=0))


def pack_clients(folder):
    """Packs a copy of the sources, because the tools write files into the folder of the sources."""
    with tempfile.TemporaryDirectory() as place:
        copy = pathlib.Path(place) / "source"
        subprocess.run(["tar", "-x", "-C", place], input=git("archive", "--format=tar", "--prefix=source/", "HEAD"), check=True)
        for python in (sys.executable, "/usr/bin/python3"):
            if not subprocess.run([python, "-c", "import setuptools, wheel"], stderr=subprocess.DEVNULL).returncode:
                for made in ("sdist", "wheel"):
                    script = f"import setuptools.build_meta as backend; backend.build_{made}({str(folder)!r})"
                    subprocess.run([python, "-c", script], cwd=copy / "clients/python", check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                break
        else:
            print("dist: setuptools or wheel is not installed, so no Python package is made", file=sys.stderr)
        if shutil.which("npm"):
            subprocess.run(["npm", "pack", "--silent", "--pack-destination", folder], cwd=copy / "clients/js", check=True, stdout=subprocess.DEVNULL)
        else:
            print("dist: npm is not installed, so no npm package is made", file=sys.stderr)


def checksum(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def parts():
    """Yields (name, version, licence, purl) of each library that the daemon links or that its pages
    contain."""
    lists = re.findall(r"^(?:OPENMESH_)?PACKAGES? := ((?:.*\\\n)*.*)", (SOURCE / "docker/setup.mk").read_text(), re.M)
    for name in " ".join(lists).replace("\\", "").split():
        if name.startswith("lib") or name == "zlib1g-dev":
            yield name, None, "NOASSERTION", f"pkg:deb/debian/{name}"
    bundled = re.search(r"for package in (.*); do", (SOURCE / "clients/web/build.sh").read_text())[1].split()
    locked = json.loads((SOURCE / "clients/web/package-lock.json").read_text())["packages"]
    for name in bundled:
        about = locked[f"node_modules/{name}"]
        yield name, about["version"], about.get("license", "NOASSERTION"), f"pkg:npm/{name}@{about['version']}"


def package(identifier, name, version, licence, **more):
    return {"SPDXID": identifier, "name": name, **({"versionInfo": version} if version else {}), "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION", "licenseDeclared": licence, "copyrightText": "NOASSERTION", **more}


def spdx(name, version, files):
    created = datetime.datetime.fromtimestamp(int(git("log", "-1", "--format=%ct")), datetime.timezone.utc)
    packages, relationships = [], []
    for i, path in enumerate(files):
        packages.append(package(f"SPDXRef-File-{i}", path.name, version, "MIT", packageFileName=path.name,
                                checksums=[{"algorithm": "SHA256", "checksumValue": checksum(path)}]))
        relationships.append({"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": f"SPDXRef-File-{i}"})
    for i, (part, number, licence, purl) in enumerate(parts()):
        packages.append(package(f"SPDXRef-Part-{i}", part, number, licence, externalRefs=[
            {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": purl}]))
        relationships.append({"spdxElementId": "SPDXRef-File-0", "relationshipType": "DEPENDS_ON", "relatedSpdxElement": f"SPDXRef-Part-{i}"})
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": name,
            "documentNamespace": f"urn:geodesicd:dist:{version}:{git('rev-parse', 'HEAD').decode().strip()}",
            "creationInfo": {"created": created.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: geodesicd-dist"]},
            "packages": packages, "relationships": relationships}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.split("\n\n")[1])
    if git("status", "--porcelain", "--untracked-files=no").strip():
        sys.exit("dist: the working tree has uncommitted changes, which the archive would lack: commit them")
    folder = pathlib.Path(sys.argv[1]).resolve()
    if folder.exists() and not (folder / "SHA256SUMS").exists():
        sys.exit(f"dist: {folder} was not made by this program: name another folder")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    version = re.search(r"^  version: *(\S+)", (SOURCE / "proto/openapi.yaml").read_text(), re.M)[1]
    name = f"geodesicd-{version}"
    pack_sources(folder, name)
    sources = folder / f"{name}.tar.gz"
    clients = folder / "clients"
    clients.mkdir()
    pack_clients(clients)
    files = [sources, *sorted(clients.iterdir())]
    (folder / f"{name}.spdx.json").write_text(json.dumps(spdx(name, version, files), indent=1) + "\n")
    published = [*files, folder / f"{name}.spdx.json"]
    (folder / "SHA256SUMS").write_text("".join(f"{checksum(path)}  {path.relative_to(folder)}\n" for path in published))
    print(*(path.relative_to(folder) for path in published), "SHA256SUMS", sep="\n")


if __name__ == "__main__":
    main()
