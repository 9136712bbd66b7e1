"""The resources of a daemon, as counted by the kernel and by the daemon itself."""
import os
import pathlib


def status(daemon):
    lines = pathlib.Path(f"/proc/{daemon.process.pid}/status").read_text().splitlines()
    return dict(line.split(":", 1) for line in lines)


def resident(daemon):
    """Returns the size in bytes of the resident memory that is not backed by a file."""
    return int(status(daemon)["RssAnon"].split()[0]) << 10


def threads(daemon):
    return int(status(daemon)["Threads"])


def descriptors(daemon):
    return len(os.listdir(f"/proc/{daemon.process.pid}/fd"))


def cpu_seconds(daemon):
    fields = pathlib.Path(f"/proc/{daemon.process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def metrics(daemon):
    """Returns all metrics without buckets, by name and labels."""
    lines = daemon.get("/metrics").body.decode().splitlines()
    pairs = (line.rpartition(" ") for line in lines if line and not line.startswith("#") and "_bucket{" not in line)
    return {name.removeprefix("geodesicd_"): float(value) for name, _, value in pairs}
