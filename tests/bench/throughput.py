#!/usr/bin/env python3
"""Measures the daemon over HTTP against a bare libmicrohttpd program, alternately (A B A B). Prints
tables and writes bench-http.json.

usage: tests/bench/throughput.py [--build DIR] [--turns N] [--seconds S] [--threads N]
                                 [--connections N] [--batch] [--mesh "SAMPLE KEY=VALUE…"]
                                 [--large "SAMPLE KEY=VALUE…"] [--only WORD] [--quick]

Throughput: wrk repeatedly requests 10,000 distinct pairs whose fields are cached, from the daemon
and from gd_http_bare. gd_http_bare answers each request with a fixed body, which is as large as the
daemon's average answer, and with the headers of one of the daemon's answers. It uses as many
threads as the daemon. /metrics must show that the cache answered every request. A ratio is the
median of the turns' ratios of requests a second. The table also has each program's processor time
per request (user and kernel, in microseconds), which hardly depends on the machine's load. With
--batch the kernel schedules wrk as a batch job. Then wrk does not preempt a server on the same
processors at each answer.

Latency: wrk requests the same pairs at half of the throughput. By wrk's delay(), each connection
waits before each request, so a slow answer delays only the next request of its own connection.
Meanwhile a worker builds fields of a large mesh, one after the other. --quick measures almost
nothing. It checks that the program works, and prints `ok` and `not ok` lines.
"""
import contextlib
import http.client
import json
import os
import pathlib
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time

from common import Checks, Failure, bench_arguments, find_program, machine, number, print_table, record, run_lines, show_progress, write_json

PAIRS = 10_000
SOURCES = 20
ASKED = 17  # number of queries from each source, so that the source's field is cached
START_SECONDS = 20
SIZES = 500  # number of answers whose sizes are averaged
OWN_HEADERS = "Date", "Content-Length", "Connection"
# parameters of the request, the required ratio, the intended ratio
KINDS = {"distance": ("", 0.7, 0.9), "path": ("&geometry=xyz", 0.5, 0.75)}
PACED_CONNECTIONS = 64
P99_MS = 1.5

# Every thread of wrk starts at a different target; each line of the file is a target. PAUSE:
# milliseconds before each request.
SCRIPT = """
local targets, at, threads = {}, 0, 0
function setup(thread) thread:set("number", threads); threads = threads + 1 end
function init(arguments)
    for target in io.lines(arguments[1]) do targets[#targets + 1] = wrk.format("GET", target) end
    at = number * math.floor(#targets / 2)
end
function request() at = at % #targets + 1; return targets[at] end
PACE
function done(summary, latency, requests)
    local errors = summary.errors
    io.write(string.format('{"requests":%d,"seconds":%.6f,"failed":%d,"p50_ms":%.3f,"p99_ms":%.3f,"max_ms":%.3f}\\n',
        summary.requests, summary.duration / 1e6, errors.connect + errors.read + errors.write + errors.status + errors.timeout,
        latency:percentile(50) / 1e3, latency:percentile(99) / 1e3, latency.max / 1e3))
end
"""
PACE = "local low, high = %d, %d\nfunction delay() return math.random(low, high) end"


def processor_seconds(process):
    """Returns the processor time of a running program so far."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")  # utime, stime


class Daemon:
    """A running geodesicd that logs into a file, and its requests."""

    def __init__(self, build, folder, threads):
        self.log = pathlib.Path(folder) / "log"
        command = [find_program(build / "geodesicd"), "--listen", "127.0.0.1:0", "--store", "memory", "--landmarks", "0",
                   "--memory-budget", "10GiB", "--http-threads", str(threads)]
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=log)
        self.port = self._wait_for_port()

    def _wait_for_port(self):
        until = time.monotonic() + START_SECONDS
        while time.monotonic() < until and self.process.poll() is None:
            for line in self.log.read_text().splitlines():
                if '"event":"listening"' in line:
                    return int(json.loads(line)["address"].rpartition(":")[2])
            time.sleep(0.02)
        self.stop()
        raise Failure(f"the daemon did not start: {self.log.read_text()[-300:]}")

    def stop(self):
        self.process.terminate()
        return self.process.wait(60)

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=600)

    def ask(self, connection, method, target, body=None):
        connection.request(method, target, body)
        answer = connection.getresponse()
        text = answer.read()
        if answer.status >= 300:
            raise Failure(f"{method} {target}: {answer.status} {text[:200]!r}")
        return text

    def upload(self, name, mesh):
        return json.loads(self.ask(self.connect(), "PUT", f"/v1/meshes/{name}", mesh))

    def metrics(self):
        text = self.ask(self.connect(), "GET", "/metrics").decode()
        pairs = (line.rpartition(" ") for line in text.splitlines() if not line.startswith("#"))
        return {name.removeprefix("geodesicd_"): float(value) for name, _, value in pairs}


class Bare:
    """A running gd_http_bare that answers with these headers and a body of this many bytes."""

    def __init__(self, build, threads, size, headers):
        command = [find_program(build / "gd_http_bare"), str(threads), str(size), *(text for header in headers for text in header)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.port = int(self.process.stdout.readline() or 0)
        if not self.port:
            raise Failure("gd_http_bare did not start")

    def stop(self):
        self.process.communicate()
        return self.process.returncode


@contextlib.contextmanager
def running(program):
    """Yields the program, and stops it at the end."""
    try:
        yield program
    finally:
        program.stop()


class Work:
    """A mesh with cached fields, and the pairs that they answer."""

    def __init__(self, daemon, folder, mesh, pairs, sources):
        self.daemon, self.folder, self.pairs = daemon, pathlib.Path(folder), pairs
        draw = random.Random(1)
        described = daemon.upload("mesh", mesh)
        self.faces = described["faces"]
        self.sources = draw.sample(range(described["vertices"]), sources)
        self.targets = [self._target(draw, self.sources[i % sources]) for i in range(pairs)]
        self._warm()

    def _target(self, draw, source):
        u, v = sorted(draw.sample(range(1, 1000), 2))
        return f"from=v:{source}&to=f:{draw.randrange(self.faces)}:{u / 1000},{(v - u) / 1000},{1 - v / 1000:.3f}"

    def _warm(self):
        connection = self.daemon.connect()
        for source in self.sources:
            for _ in range(ASKED):
                self.daemon.ask(connection, "GET", f"/v1/meshes/mesh/distance?from=v:{source}&to=v:{source}")
        if (fields := self.daemon.metrics()["cache_fields"]) != len(self.sources):
            raise Failure(f"{fields:g} fields are cached, not {len(self.sources)}")

    def urls(self, kind):
        return [f"/v1/meshes/mesh/{kind}?{target}{KINDS[kind][0]}" for target in self.targets]

    def size(self, kind):
        """Returns the mean size of an answer."""
        connection = self.daemon.connect()
        return round(statistics.mean(len(self.daemon.ask(connection, "GET", url)) for url in self.urls(kind)[:SIZES]))

    def headers(self, kind):
        """Returns the headers of an answer, without those that libmicrohttpd adds itself."""
        connection = self.daemon.connect()
        connection.request("GET", self.urls(kind)[0])
        answer = connection.getresponse()
        answer.read()
        return [header for header in answer.getheaders() if header[0] not in OWN_HEADERS]

    def load(self, program, kind, options, connections, pace=""):
        """Returns wrk's measurements, and the processor time of the program."""
        script, targets = self.folder / "script.lua", self.folder / f"{kind}.txt"
        script.write_text(SCRIPT.replace("PACE", pace))
        targets.write_text("".join(url + "\n" for url in self.urls(kind)))
        batch = ["chrt", "--batch", "0"] if options.batch and not pace else []
        command = [*batch, "wrk", "-t", options.threads, "-c", connections, "-d", options.seconds, "-s", script,
                   f"http://127.0.0.1:{program.port}", "--", targets]
        before = processor_seconds(program.process)
        done = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600)
        if done.returncode != 0:
            raise Failure(f"wrk: {done.stderr.strip() or done.stdout.strip()}")
        result = json.loads(done.stdout.splitlines()[-1])
        if result["failed"]:
            raise Failure(f"wrk: {result['failed']} requests failed")
        taken = processor_seconds(program.process) - before
        return result | {"rate": result["requests"] / result["seconds"], "cpu_us": taken / result["requests"] * 1e6}

    def load_daemon(self, *arguments):
        """Like `load`, for the daemon. All answers must come from the cache."""
        before = self.daemon.metrics()
        result = self.load(self.daemon, *arguments)
        after = self.daemon.metrics()
        hits, searches = (after[name] - before[name] for name in ("cache_hits_total", "searches_total"))
        if hits < result["requests"] or searches:
            raise Failure(f"{result['requests']} requests, but {hits:g} hits of the cache and {searches:g} searches")
        return result


# --- throughput ---------------------------------------------------------------------------------


def race(work, kind, options):
    """Runs the kind's turns against the bare program."""
    size = work.size(kind)
    turns = []
    with running(Bare(options.build, options.threads, size, work.headers(kind))) as bare:
        for turn in range(options.turns):
            show_progress(f"{kind}: turn {turn + 1} of {options.turns}")
            ours = work.load_daemon(kind, options, options.connections)
            turns.append({"daemon": ours, "bare": work.load(bare, kind, options, options.connections)})
    show_progress("")
    ratios = [turn["daemon"]["rate"] / turn["bare"]["rate"] for turn in turns]
    return {"bytes": size, "turns": turns, "ratio": statistics.median(ratios), "ratio_least": min(ratios), "ratio_most": max(ratios)}


def median_of(result, program, key):
    return statistics.median(turn[program][key] for turn in result["turns"])


def print_races(results):
    programs = "daemon", "bare"
    rows = [[kind, number(result["bytes"]), *(number(median_of(result, program, "rate")) for program in programs),
             *(f"{median_of(result, program, 'cpu_us'):.2f}" for program in programs), f"{result['ratio']:.3f}",
             f"{result['ratio_least']:.3f}-{result['ratio_most']:.3f}", *(f"{wanted:g}" for wanted in KINDS[kind][1:])]
            for kind, result in results.items()]
    print_table(["answers", "bytes", "daemon /s", "bare /s", "daemon cpu us", "bare cpu us", "ratio", "range", "to reach", "aim"], rows)


# --- latency ------------------------------------------------------------------------------------


class Building(threading.Thread):
    """Keeps one worker busy with building fields of the large mesh until it is stopped."""

    def __init__(self, daemon, vertices):
        super().__init__(daemon=True)
        self.server, self.vertices, self.fields, self.is_over, self.failure = daemon, vertices, 0, threading.Event(), None

    def run(self):
        draw, connection = random.Random(2), self.server.connect()
        try:
            while not self.is_over.is_set():
                body = json.dumps({"set": {"points": [{"vertex": draw.randrange(self.vertices)}]}})
                connection.request("POST", "/v1/meshes/large/fields", body, {"Content-Type": "application/json"})
                answer = connection.getresponse()
                identity = json.loads(answer.read())
                if answer.status not in (200, 201):
                    raise Failure(f"POST /v1/meshes/large/fields: {identity}")
                self.fields += 1
                self.server.ask(connection, "DELETE", f"/v1/meshes/large/fields/{identity['id']}")
        except (Failure, OSError, http.client.HTTPException, KeyError) as failure:
            self.failure = failure

    def stop(self):
        self.is_over.set()
        self.join(600)
        if self.failure or not self.fields:
            raise Failure(f"building fields: {self.failure or 'none was built'}")


def pace_for(rate):
    """Returns the delay() function of a wrk script. It pauses for random whole milliseconds around
    the exact pause, so that PACED_CONNECTIONS together send about `rate` requests a second."""
    mean = PACED_CONNECTIONS / rate * 1e3
    return PACE % (max(0, round(mean) - 1), round(mean) + 1)


def paced(work, options, rate, is_building):
    building = Building(work.daemon, work.large["vertices"]) if is_building else None
    if building:
        building.start()
        time.sleep(0.2)
    try:
        result = work.load_daemon("distance", options, PACED_CONNECTIONS, pace_for(rate))
    finally:
        if building:
            building.stop()
    return result | {"building": is_building}


def measure_latency(work, options, rate):
    """Measures the latency at `rate`, in alternating turns: without a field being built, and with a
    field being built."""
    work.large = work.daemon.upload("large", sample_of(options, options.large))
    return [paced(work, options, rate, is_building) for _ in range(options.turns) for is_building in (False, True)]


def print_latency(turns, faces):
    rows = []
    for is_building, name in ((False, "nothing else"), (True, f"a field of {faces:,} faces being built")):
        some = [turn for turn in turns if turn["building"] == is_building]
        rows.append([name] + [number(statistics.median(turn[key] for turn in some)) for key in ("rate", "p50_ms", "p99_ms", "max_ms")] +
                    ["to " + number(max(turn["p99_ms"] for turn in some)), f"{P99_MS:g}"])
    print_table(["cached distance besides", "/s", "p50 ms", "p99 ms", "max ms", "worst p99", "p99 to reach"], rows)


# --- all of it ----------------------------------------------------------------------------------


def sample_of(options, words):
    return subprocess.run([find_program(options.build / "gd_sample"), *words.split()], check=True, stdout=subprocess.PIPE).stdout


def read_options():
    arguments = bench_arguments("measurements")
    arguments.add_argument("--turns", type=int, default=5)
    arguments.add_argument("--seconds", type=int, default=4)
    arguments.add_argument("--threads", type=int, default=2, help="of wrk, and of HTTP in both programs")
    arguments.add_argument("--connections", type=int, default=32)
    arguments.add_argument("--batch", action="store_true", help="run wrk by chrt --batch")
    arguments.add_argument("--mesh", default="icosphere level=4", help="whose fields are cached")
    arguments.add_argument("--large", default="terrain cells=708", help="whose field is being built while latency is measured")
    return arguments.parse_args()


def measure(options, folder):
    with running(Daemon(options.build, folder, options.threads)) as daemon:
        work = Work(daemon, folder, sample_of(options, options.mesh), PAIRS, SOURCES)
        races = {kind: race(work, kind, options) for kind in KINDS if options.only in kind}
        results = {"faces": work.faces, "races": races}
        if races:
            print_races(races)
        if options.only in "latency":
            most = median_of(races["distance"], "daemon", "rate") if races else work.load_daemon("distance", options, options.connections)["rate"]
            latency = measure_latency(work, options, most / 2)
            print_latency(latency, work.large["faces"])
            results |= {"latency": latency, "large_faces": work.large["faces"]}
    return results


def check_promises(options):
    """Checks a few requests of each kind, on small meshes."""
    options.turns, options.seconds, options.large = 1, 1, "icosphere level=3"
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder, running(Daemon(options.build, folder, 2)) as daemon:
        work = Work(daemon, folder, sample_of(options, "icosphere level=2"), 100, 4)
        for kind in KINDS:
            def test():
                result = race(work, kind, options)
                assert result["ratio"] > 0 and result["bytes"] > 0, result
            checks.check(f"{kind} from cached fields races the bare program", test)

        def test_latency():
            assert all(turn["p99_ms"] > 0 for turn in measure_latency(work, options, 1000))
        checks.check("latency is measured while fields are built", test_latency)
    return checks.status


def main():
    options = read_options()
    if not shutil.which("wrk"):
        print("skip the daemon against bare libmicrohttpd: wrk is not installed (apt-get install wrk)")
        return 0
    if options.quick:
        return check_promises(options)
    before = machine()
    with tempfile.TemporaryDirectory() as folder:
        results = measure(options, folder)
    path = options.build / "bench-http.json"
    write_json(path, {"machine": before, "load_at_end": machine()["load"], "mesh": options.mesh, "batch": options.batch, **results})
    print(f"written: {path}; {options.threads} threads, {options.connections} connections, {options.turns} turns of {options.seconds} s; "
          f"load {before['load'][0]:.1f} at the start, {machine()['load'][0]:.1f} at the end")
    if options.record:
        record("http", before)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failure as failure:
        sys.exit(f"{failure}")
