#!/usr/bin/env python3
"""Tests failures of the system other than memory and disk:
- No descriptors are left (RLIMIT_NOFILE).
- Clients have disconnected when their sockets are read, written (ECONNRESET) or accepted
  (ECONNABORTED).
- The clock jumps.
- The process is stopped and continued, which interrupts every wait.
- Written files and sockets have no reader.
The daemon survives, its answers are correct, and afterwards its state is as before.

    tests/fault/scarcity.py [--calls N]      the first N calls of sockets fail in turn
"""
import argparse
import contextlib
import pathlib
import resource
import signal
import socket
import sys
import tempfile
import time

from common import GONE, Shimmed, build_shim, check, harness, mesh
from figures import conclude, report
from process import cpu_seconds, descriptors

DESCRIPTORS, CLIENTS = 64, 150
JUMPS = (86400 * 400, -86400 * 400, 3)  # seconds
PATIENCE_SECONDS = 10


def expect(wrong, what, got, *allowed):
    if got not in allowed:
        wrong.append(f"{what}: {got}, not one of {allowed}")


def ask(daemon, wrong, when):
    """Checks that a query's answer is correct, and that an upload and a removal work."""
    expect(wrong, f"{when}: distance", daemon.get("/v1/meshes/a/distance?from=v:0&to=v:1").json.get("distance"), 1.5)
    expect(wrong, f"{when}: upload", daemon.put("new", mesh(2.5)).status, 201)
    expect(wrong, f"{when}: removal", daemon.request("DELETE", "/v1/meshes/new").status, 204)


def start(place, name, library=None, **environment):
    daemon = Shimmed(place / name, library=library, environment=environment)
    assert daemon.put("a", mesh(1.5)).status == 201
    return daemon


def finish(daemon, folder, wrong):
    expect(wrong, "exit status", daemon.stop(), 0)
    if (result := check(folder)).returncode:
        wrong.append(result.stdout)
    return wrong


def settle(daemon, wrong, when):
    """Waits until only the test's own connection is open."""
    until = time.monotonic() + PATIENCE_SECONDS
    while (connections := daemon.metric("connections")) > 1 and time.monotonic() < until:
        time.sleep(0.02)
    expect(wrong, f"{when}: connections", connections, 1)


# --- descriptors --------------------------------------------------------------------------------


@contextlib.contextmanager
def few_descriptors():
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (DESCRIPTORS, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def crowd(daemon, wrong, cpu_most, *upload_statuses):
    """Connects more clients than the daemon has descriptors. The daemon answers the clients that it
    has accepted, and the other clients wait. `cpu_most` limits the processor time for each second
    of waiting."""
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(socket.create_connection(("127.0.0.1", daemon.port), timeout=PATIENCE_SECONDS)) for _ in range(CLIENTS)]
        for client in clients:
            client.sendall(b"GET /v1/meshes/a/distance?from=v:0&to=v:1 HTTP/1.1\r\nHost: localhost\r\n\r\n")
        expect(wrong, "the first client's answer", b" 200 " in clients[0].recv(4096), True)
        body = mesh(2)
        clients[0].sendall(b"PUT /v1/meshes/b HTTP/1.1\r\nHost: localhost\r\nContent-Length: %d\r\n\r\n%b" % (len(body), body))
        expect(wrong, "an upload beside them", clients[0].recv(4096).split()[1], *upload_statuses)
        begun = cpu_seconds(daemon)
        time.sleep(1)
        if (spent := cpu_seconds(daemon) - begun) > cpu_most:
            wrong.append(f"{spent:.2f} s of processor time in a second without descriptors")
    settle(daemon, wrong, "after the descriptors came back")
    daemon.request("DELETE", "/v1/meshes/b")
    ask(daemon, wrong, "after the descriptors came back")


def start_with_few(place):
    """Starts a daemon with few descriptors. The daemon limits the number of its connections, so
    that it keeps enough descriptors for its other needs."""
    wrong = []
    with few_descriptors():
        daemon = start(place, "few")
    expect(wrong, "the log says how many", any(line["event"] == "descriptors" for line in daemon.log), True)
    crowd(daemon, wrong, 0.2, b"201")
    return finish(daemon, place / "few", wrong)


def run_out(place):
    """Takes the descriptors for connections and for files from a running daemon, as if the whole
    system had run out of descriptors. Uploads are refused during this time only. An HTTP thread of
    libmicrohttpd that has no connection repeats accept at once, so it may use a whole processor
    during this time."""
    wrong, daemon = [], start(place, "none")
    limits = resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE)
    resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE, (descriptors(daemon) + 8, limits[1]))
    crowd(daemon, wrong, 1.2, b"507", b"503", b"500")
    return finish(daemon, place / "none", wrong)


# --- sockets ------------------------------------------------------------------------------------


def reset_clients(place, library, most):
    """Makes each of the first `most` socket calls report that the client has disconnected."""
    wrong, order = [], place / "reset-order"
    order.write_text("fine")
    daemon = start(place, "reset", library, INJECT_ROOT=str(place / "reset"), INJECT_ORDER=str(order))
    for call in range(1, most + 1):
        order.write_text(f"reset {call}")
        for _ in range(3):
            with contextlib.suppress(*GONE):
                daemon.put("b", mesh(2.5, 100000))
                expect(wrong, f"reset {call}: distance", daemon.get("/v1/meshes/b/distance?from=v:0&to=v:1").json.get("distance"), 2.5, None)
        order.write_text("fine")
        expect(wrong, f"reset {call}: alive", daemon.get("/livez").status, 200)
    settle(daemon, wrong, "after resets")
    daemon.request("DELETE", "/v1/meshes/b")
    ask(daemon, wrong, "after resets")
    return finish(daemon, place / "reset", wrong)


# --- the clock ----------------------------------------------------------------------------------


def jump_clock(place, library):
    """Deadlines, rates and waits use a clock that does not jump; dates follow the injected
    clock."""
    wrong, order = [], place / "clock-order"
    order.write_text("fine")
    daemon = start(place, "clock", library, INJECT_ROOT=str(place / "clock"), INJECT_ORDER=str(order))
    daemon.put("ball", harness.sample("icosphere", level=4))
    for jump in JUMPS:
        order.write_text(f"clock {jump}")
        ask(daemon, wrong, f"clock {jump:+d} s")
        answer = daemon.ask("ball", "fields?timeout_ms=20000", {"set": {"points": [{"vertex": abs(jump) % 97}]}})
        expect(wrong, f"clock {jump:+d} s: a field with a deadline", answer.status, 200, 201)
        expect(wrong, f"clock {jump:+d} s: ready", daemon.get("/readyz").status, 200)
    expect(wrong, "the clock jumped", order.with_name("clock-order.fired").exists(), True)
    return finish(daemon, place / "clock", wrong)


# --- signals ------------------------------------------------------------------------------------


def stop_and_go(place):
    """Stops and continues the daemon repeatedly while it works. Also sends SIGPIPE, which the
    daemon ignores."""
    wrong = []
    daemon = start(place, "signals")
    for number in range(40):
        connection = daemon.connect()
        connection.request("PUT", "/v1/meshes/b", mesh(1 + number / 64, 300000))
        daemon.process.send_signal(signal.SIGSTOP)
        time.sleep(0.002)
        daemon.process.send_signal(signal.SIGPIPE)
        daemon.process.send_signal(signal.SIGCONT)
        expect(wrong, "upload between stops", connection.getresponse().status, 200, 201)
        connection.close()
        expect(wrong, "distance", daemon.get("/v1/meshes/b/distance?from=v:0&to=v:1").json.get("distance"), 1 + number / 64)
    daemon.request("DELETE", "/v1/meshes/b")
    ask(daemon, wrong, "after stops")
    return finish(daemon, place / "signals", wrong)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--calls", type=int, default=40)
    options = arguments.parse_args()
    with tempfile.TemporaryDirectory() as text:
        place = pathlib.Path(text).resolve()
        library = build_shim("inject", place)
        trials = (
            (f"RLIMIT_NOFILE={DESCRIPTORS}, {CLIENTS} clients", "lives, does not spin, recovers", start_with_few(place)),
            ("no descriptor left while it runs", "uploads are refused, lives, recovers", run_out(place)),
            (f"ECONNRESET or ECONNABORTED at each of {options.calls} calls of sockets", "lives, recovers", reset_clients(place, library, options.calls)),
            ("clock jumps by 400 days, both ways", "no effect", jump_clock(place, library)),
            ("SIGSTOP and SIGCONT, SIGPIPE", "no effect", stop_and_go(place)))
    for _, _, wrong in trials:
        for fault in wrong[:20]:
            print(f"wrong: {fault}")
    return conclude("scarcity", [report(promise, asked, f"{len(wrong)} faults", not wrong) for promise, asked, wrong in trials])


if __name__ == "__main__":
    sys.exit(main())
