#!/usr/bin/env python3
"""Stops the thread of a running query, as a system call that never returns would do. SIGTERM ends
the daemon nevertheless, with the status 1 and a message. Takes half a minute."""
import contextlib
import ctypes
import http.client
import os
import pathlib
import sys
import threading

from common import Daemon
from figures import conclude, report
from harness import sample, wait_until

WAIT_ALL = 0x40000000  # __WALL
PTRACE_SEIZE, PTRACE_INTERRUPT = 0x4206, 0x4207
LIMIT_SECONDS = 30  # END_MS of server/main.c
MARGIN_SECONDS = 30  # for a busy machine


def processor_time(thread):
    return int((thread / "stat").read_text().rpartition(")")[2].split()[11])


def busiest_thread(daemon):
    """Returns the id of the thread that computes, once it has used half a second."""
    threads = pathlib.Path(f"/proc/{daemon.process.pid}/task").iterdir()
    longest, thread = max((processor_time(thread), thread) for thread in threads)
    return longest >= os.sysconf("SC_CLK_TCK") / 2 and int(thread.name)


def stop_thread(thread):
    ptrace = ctypes.CDLL(None, use_errno=True).ptrace
    ptrace.argtypes = [ctypes.c_long] * 4
    for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
        if ptrace(request, thread, 0, 0):
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    os.waitpid(thread, WAIT_ALL)


def ask(daemon):
    with contextlib.suppress(OSError, http.client.HTTPException):  # there is no answer
        daemon.ask("large", "farthest-points", {"count": 1000})


def main():
    daemon = Daemon("--drain-ms", "0")
    daemon.put("large", sample("icosphere", level=7))
    threading.Thread(target=ask, args=[daemon], daemon=True).start()
    thread = wait_until(lambda: busiest_thread(daemon))
    try:
        stop_thread(thread)
    except OSError as error:
        daemon.process.kill()
        return print(f"skip stuck_worker: {error.strerror} (ptrace)")
    daemon.terminate()
    # the process has ended when its last thread is reaped
    try:
        wait_until(lambda: os.waitpid(thread, WAIT_ALL | os.WNOHANG)[0], LIMIT_SECONDS + MARGIN_SECONDS)
    except TimeoutError:
        daemon.process.kill()
        raise
    status = daemon.process.wait(MARGIN_SECONDS)
    told = [line["event"] for line in daemon.log][-1:]
    return conclude("stuck_worker", [report("a worker that never returns: SIGTERM ends the daemon", "status 1, stop_failed", f"status {status}, {told}",
                                            (status, told) == (1, ["stop_failed"]))])


if __name__ == "__main__":
    sys.exit(main())
