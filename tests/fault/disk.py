#!/usr/bin/env python3
"""A disk that fails (inject.c): after a failed fsync, at whichever call, the store takes no changes and goes on answering;
on a full disk, at whichever write, uploads are refused, reads and deletes work, and it recovers without a restart.

    tests/fault/disk.py [--most N]      tries the first N calls (until nothing fails any more)
"""
import argparse
import pathlib
import sys
import tempfile

from common import Ledger, Shimmed, build_shim, check, edges, mesh


class Trial:
    """A daemon over a folder with two meshes, whose disk fails on order."""

    def __init__(self, place, number, library):
        self.folder, self.order = place / f"data{number}", place / f"order{number}"
        self.order.write_text("fine")
        self.daemon = Shimmed(self.folder, library=library,
                              environment={"INJECT_ROOT": str(self.folder), "INJECT_ORDER": str(self.order)})
        self.wrong, self.ledger = [], Ledger()
        for name, edge in (("a", 1.5), ("b", 2.5)):
            self.put(name, edge)

    def expect(self, what, got, *allowed):
        if got not in allowed:
            self.wrong.append(f"{what}: {got}, not one of {allowed}")

    def put(self, name, edge, padding=0):
        self.ledger.begin(name, edge)
        answer = self.daemon.put(name, mesh(edge, padding))
        if answer.status in (200, 201):
            self.ledger.end(name, edge)
        return answer

    def delete(self, name):
        self.ledger.begin(name, None)
        answer = self.daemon.request("DELETE", f"/v1/meshes/{name}")
        if answer.status == 204:
            self.ledger.end(name, None)
        return answer

    def expect_reads(self, when):
        for name, edge in self.ledger.acknowledged.items():
            answer = self.daemon.get(f"/v1/meshes/{name}/distance?from=v:0&to=v:1")
            if edge is not None:
                self.expect(f"{when}: distance on {name}", answer.json.get("distance"), edge)

    def end(self):
        """After the next start everything that was acknowledged is there."""
        self.order.write_text("fine")
        self.expect("exit status", self.daemon.stop(), 0)
        if (result := check(self.folder)).returncode:
            self.wrong.append(result.stdout)
        with Shimmed(self.folder) as daemon:
            self.wrong += self.ledger.faults(edges(daemon))
            self.expect("upload after the restart", daemon.put("after", mesh(1)).status, 201)
        return self.wrong


def changes(trial):
    """An upload, a replacement, a delete; their statuses."""
    return [trial.put("c", 0.75, 5000).status, trial.put("a", 1.25).status, trial.delete("b").status]


def try_fsync(place, number, library, call):
    trial = Trial(place, number, library)
    trial.order.write_text(f"fsync {call}")
    statuses = changes(trial)
    ready = trial.daemon.get("/readyz")
    failed = ready.json["status"] == "read_only"
    trial.expect("readyz", ready.status, 200)
    if 507 in statuses:
        trial.expect("after the failed fsync", (set(statuses[statuses.index(507) :]), failed), ({507}, True))
    if failed:
        trial.expect("metric", trial.daemon.metric("store_writable"), 0)
        trial.expect("problem", trial.put("d", 1).json.get("code"), "insufficient_storage")
        trial.expect_reads("read-only")
        trial.ledger.possible.pop("d")  # it was not even tried
    return trial.end(), failed


def try_full(place, number, library, call):
    trial = Trial(place, number, library)
    trial.order.write_text(f"full {call}")
    status = trial.put("c", 0.75, 3000000).status
    trial.expect("upload", status, 201, 507)
    trial.expect("replacement", trial.put("a", 1.25, 3000000).status, 200, 507)
    failed = status == 507
    if failed:
        trial.ledger.possible.pop("c")  # nothing was changed
        trial.expect("the refused upload", trial.daemon.get("/v1/meshes/c").status, 404)
        trial.expect("metric", trial.daemon.metric("store_writable"), 1)
        trial.expect_reads("full disk")
        trial.expect("delete", trial.delete("b").status, 204)
        trial.expect("deleted", trial.daemon.get("/v1/meshes/b").status, 404)
        trial.order.write_text("fine")
        trial.expect("upload once there is room", trial.put("c", 0.75, 3000000).status, 201)
        trial.expect("ballast", (trial.folder / "ballast").exists(), True)
    return trial.end(), failed


def run(kind, one, place, library, most, wrong):
    """Fails each call in turn until the changes end before it."""
    for call in range(1, most + 1):
        faults, failed = one(place, f"{kind}{call}", library, call)
        wrong += [f"{kind} {call}: {fault}" for fault in faults]
        if not failed:
            return call - 1
    return most


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--most", type=int, default=60)
    options = arguments.parse_args()
    wrong = []
    with tempfile.TemporaryDirectory() as text:
        place = pathlib.Path(text).resolve()
        library = build_shim("inject", place)
        syncs = run("fsync", try_fsync, place, library, options.most, wrong)
        writes = run("full", try_full, place, library, options.most, wrong)
    for fault in wrong[:20]:
        print(f"wrong: {fault}")
    print(f"# failing disk: each of {syncs} fsyncs failed once, the disk full from each of {writes} writes on, {len(wrong)} faults")
    print("not ok disk" if wrong or not syncs or not writes else "ok disk")
    return 1 if wrong or not syncs or not writes else 0


if __name__ == "__main__":
    sys.exit(main())
