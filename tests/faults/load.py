"""Many clients behind the shipped nginx: 5 000 runs in the store, 64 clients polling, 16 streaming, 8 downloading 1 GB
in ranges while two runs compute.

usage: load.py QUICKSAND SMALL_CASE [--minutes N] [--runs N] [--megabytes-per-s RATE]

Clients come and go: times with and without them alternate, so that what else the machine does weighs on both, and the
runs' speed is compared within each pair. Each client downloads RATE at most. The processor time of runs, service, nginx
and clients is told apart: clients belong on other machines, so what they themselves take of this one is not counted
against the service (`less than alone` tells it with and without). What pollers measure includes their own waiting for a
processor, which is told beside it. Service, nginx and each kind of client have a session of their own, as on machines of
their own or as systemd starts them: where kernels share processors out between sessions, niceness counts only within one.
"""

import argparse
import contextlib
import glob
import json
import os
import re
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../server"))

from download import enlarge, resident_mb  # noqa: E402  (the folders are added above)
from load_clients import SIZE  # noqa: E402
from nginx_process import NginxProcess  # noqa: E402
from server_test import make_key  # noqa: E402
from service_process import ServiceProcess  # noqa: E402

RUN_THREADS = "quicksand-run"
FLAT = 0.1  # of the memory after a third of the time: what it may grow until the end
SETTLING = 10  # pairs of times, before which memory still fills its bounded stores


def fill_store(server, run_id, count):
    """Copies of an ended run."""
    with contextlib.closing(sqlite3.connect(server.state + "/quicksand.db")) as store, store:
        names = [row[1] for row in store.execute("PRAGMA table_info(runs)") if row[1] not in ("sequence", "id")]
        columns = ", ".join(names)
        store.executemany(f"INSERT INTO runs (id, {columns}) SELECT ?, {columns} FROM runs WHERE id = ?",
                          [(f"{k:016x}", run_id) for k in range(count - 1)])


def thread_seconds(pid):
    """Processor time of a process by the names of its threads, s; of threads that have ended nothing."""
    seconds = {}
    for path in glob.glob(f"/proc/{pid}/task/*/stat"):
        with contextlib.suppress(OSError), open(path) as file:
            head, _, rest = file.read().rpartition(")")
            fields = rest.split()
            name = head.partition("(")[2]
            seconds[name] = seconds.get(name, 0) + (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return seconds


def process_seconds(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def machine_seconds():
    """Of everything on this machine."""
    with open("/proc/stat") as file:
        user, nice, system, _idle, _wait, irq, softirq = map(int, file.readline().split()[1:8])
    return (user + nice + system + irq + softirq) / os.sysconf("SC_CLK_TCK")


def peak_mb(process):
    """The most memory that it ever had."""
    with open(f"/proc/{process.pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM")) / 1000


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        return [int(word) for word in file.read().split()]


class Load:
    """The service with its runs, nginx and the clients."""

    def __init__(self, options, folder):
        self.server, self.key, done, self.running = prepare(options, folder)
        self.nginx = NginxProcess(folder + "/nginx", self.server.address.port, alone=True).start()
        facts = {"ids": [f"{k:016x}" for k in range(options.runs - 1)], "running": self.running, "large": done,
                 "rate": options.megabytes_per_s * 1e6}
        self.clients = {kind: subprocess.Popen(
            [sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), "load_clients.py"), str(self.nginx.port),
             folder + "/nginx/cert", self.key, kind, json.dumps(facts)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, start_new_session=True) for kind in ("pollers", "streams", "downloads")}
        self.latencies, self.late, self.statuses, self.events, self.bytes = [], [], {}, 0, 0
        self.slower, self.without_clients, self.dearer, self.memory, self.seconds = [], [], [], [], {}

    def metric(self, name):
        text = self.server.call("GET", "/metrics", headers={"X-API-Key": self.key}).body.decode()
        return float(re.search("^" + re.escape("quicksand_" + name) + r" (\S+)", text, re.M)[1])

    def steps(self):
        return self.metric("steps_total")

    def within(self, seconds):
        """Part of the polls that the service itself, without waiting for it or for nginx, answered within that time."""
        bucket = 'http_seconds_bucket{{method="GET",route="/v1/runs/{{id}}",le="{}"}}'
        return self.metric(bucket.format(seconds)) / self.metric(bucket.format("+Inf"))

    def processor(self):
        by_thread = thread_seconds(self.server.process.pid)
        whole = process_seconds(self.server.process.pid)  # with threads that have ended
        runs = by_thread.get(RUN_THREADS, 0)
        used = {"runs": runs, "service": whole - runs,
                "nginx": sum(process_seconds(pid) for pid in [self.nginx.process.pid, *children(self.nginx.process.pid)]),
                **{kind: process_seconds(process.pid) for kind, process in self.clients.items()}}
        return {**used, "others": machine_seconds() - sum(used.values())}

    def speed(self, doing):
        """Of the runs together, while `doing` is done: steps per second, and per second of processor time."""
        first, begin, used = self.steps(), time.monotonic(), thread_seconds(self.server.process.pid)[RUN_THREADS]
        doing()
        steps, used = self.steps() - first, thread_seconds(self.server.process.pid)[RUN_THREADS] - used
        return steps / (time.monotonic() - begin), steps / used

    def with_clients(self, seconds):
        for process in self.clients.values():
            process.stdin.write(f"{seconds}\n")
            process.stdin.flush()
        for process in self.clients.values():
            met = json.loads(process.stdout.readline())
            self.latencies += met["latencies"]
            self.late += met["late"]
            for status, count in met["statuses"].items():
                self.statuses[int(status)] = self.statuses.get(int(status), 0) + count
            self.events += met["events"]
            self.bytes += met["bytes"]

    def pair(self, quiet, loaded):
        """Half of the quiet time before, half after."""
        alone = self.speed(lambda: time.sleep(quiet / 2))
        before, begin = self.processor(), time.monotonic()
        busy = self.speed(lambda: self.with_clients(loaded))
        used = {name: seconds - before[name] for name, seconds in self.processor().items()}
        for name, seconds in used.items():
            self.seconds[name] = self.seconds.get(name, 0) + seconds
        clients = sum(used[kind] for kind in self.clients) / (time.monotonic() - begin) / os.cpu_count()
        after = self.speed(lambda: time.sleep(quiet / 2))
        alone = [(a + b) / 2 for a, b in zip(alone, after)]
        self.slower.append(1 - busy[0] / alone[0])
        self.without_clients.append(1 - busy[0] / alone[0] / (1 - clients))
        self.dearer.append(1 - busy[1] / alone[1])
        self.memory.append(resident_mb(self.server.process))
        print(f"  steps/s {alone[0]:.0f} alone, {busy[0]:.0f} with clients: {self.slower[-1]:.1%} less "
              f"({self.dearer[-1]:.1%} per second of processor time); {self.memory[-1]:.0f} MB", flush=True)

    def stop(self):
        for process in self.clients.values():
            process.stdin.close()
            process.wait(timeout=60)
        self.nginx.stop()
        self.server.kill()


def prepare(options, folder):
    """A server with its runs, two of which compute."""
    server = ServiceProcess(options.quicksand, folder + "/state", ["--workers", "2", "--set", "short_workers=0", "--threads", "1"])
    server.alone, server.equal = True, []
    key = make_key(server.state, "root", "admin")
    headers = {"X-API-Key": key}
    server.start()
    with open(options.small_case) as file:
        case = json.load(file)
    done = server.call("POST", "/v1/runs", case, headers).json()["id"]
    while server.call("GET", f"/v1/runs/{done}", headers=headers).json()["status"] != "succeeded":
        time.sleep(0.05)
    server.stop()
    fill_store(server, done, options.runs)
    enlarge(server, done, SIZE)
    server.start()
    case["stages"][0]["duration"] = 10_000
    case["output"] = {"frame_interval": 1}
    case["numerics"] = {"time_step": 1e-4}
    running = [server.call("POST", "/v1/runs", case, headers).json()["id"] for _ in range(2)]
    while not all(server.call("GET", f"/v1/runs/{i}", headers=headers).json()["progress"] for i in running):
        time.sleep(0.05)
    return server, key, done, running


def part(values, share):
    return sorted(values)[int(len(values) * share)]


def report(load, seconds):
    p99 = part(load.latencies, 0.99)
    slower = statistics.median(load.without_clients)
    settled, last = load.memory[len(load.memory) // 3], load.memory[-1]
    print(f"{len(load.latencies)} polls in {seconds:.0f} s: median {part(load.latencies, 0.5) * 1000:.1f} ms, p99 "
          f"{p99 * 1000:.1f} ms [50], {part(load.latencies, 0.999) * 1000:.0f} ms at 99.9 %; answers "
          f"{dict(sorted(load.statuses.items()))}")
    print(f"of that the pollers' own waiting for a processor: p99 {part(load.late, 0.99) * 1000:.1f} ms; the service by "
          f"itself answered {load.within(0.005):.2%} within 5 ms, {load.within(0.05):.2%} within 50 ms")
    print(f"{load.events} events, {load.bytes / 1e6 / seconds:.0f} MB/s downloaded; memory with the runs {load.memory[0]:.0f} "
          f"MB at first, {settled:.0f} MB after a third, {last:.0f} MB at the end [{FLAT:.0%} more], "
          f"{peak_mb(load.server.process):.0f} MB at most [200]")
    print(f"steps/s of the runs with clients: {slower:.1%} less than alone, without what the clients take (median of "
          f"{len(load.slower)} pairs, {min(load.without_clients):.1%} to {max(load.without_clients):.1%}) [10 %]; "
          f"{statistics.median(load.slower):.1%} with it; per second of processor time {statistics.median(load.dearer):.1%} less")
    print("processors busy with: " + ", ".join(f"{name} {used / seconds:.3f}" for name, used in load.seconds.items())
          + f" of {os.cpu_count()}")
    assert set(load.statuses) <= {200, 206, 429, 503}, load.statuses
    assert p99 < 0.05, "polling is too slow"
    assert slower < 0.1, "the runs are too slow"
    assert peak_mb(load.server.process) < 200, "too much memory"
    assert last < (1 + FLAT) * settled or len(load.memory) < SETTLING, "memory grows"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("quicksand")
    parser.add_argument("small_case")
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--runs", type=int, default=5000)
    parser.add_argument("--megabytes-per-s", type=float, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="quicksand-load-") as folder:
        load = Load(options, folder)
        try:
            time.sleep(5)  # first checkpoints and allocations are over
            pairs = max(2, round(options.minutes))
            each = options.minutes * 60 / pairs
            for _ in range(pairs):
                load.pair(each / 10, each)
            report(load, pairs * each)
        finally:
            load.stop()


if __name__ == "__main__":
    main()
