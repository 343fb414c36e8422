"""Many clients behind the shipped nginx: 5 000 runs in the store, 64 clients polling, 16 streaming, 8 downloading 1 GB
in ranges while two runs compute.

usage: load.py QUICKSAND SMALL_CASE [--minutes N] [--runs N] [--megabytes-per-s RATE]

Clients come and go: times with and without them alternate, so that what else the machine does weighs on both, and the
runs' speed is compared within each pair. Each client downloads RATE at most. The processor time of runs, service, nginx
and clients is told apart: clients belong on other machines, so what they themselves take of this one is not counted
against the service (`less than alone` tells it with and without).
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


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        return [int(word) for word in file.read().split()]


class Load:
    """The service with its runs, nginx and the clients."""

    def __init__(self, options, folder):
        self.server, self.key, done, self.running = prepare(options, folder)
        self.nginx = NginxProcess(folder + "/nginx", self.server.address.port).start()
        facts = {"ids": [f"{k:016x}" for k in range(options.runs - 1)], "running": self.running, "large": done,
                 "rate": options.megabytes_per_s * 1e6}
        self.clients = {kind: subprocess.Popen(
            [sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), "load_clients.py"), str(self.nginx.port),
             folder + "/nginx/cert", self.key, kind, json.dumps(facts)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for kind in ("pollers", "streams", "downloads")}
        self.latencies, self.statuses, self.events, self.bytes = [], {}, 0, 0
        self.slower, self.without_clients, self.dearer, self.memory, self.seconds = [], [], [], [], {}

    def steps(self):
        text = self.server.call("GET", "/metrics", headers={"X-API-Key": self.key}).body.decode()
        return float(re.search(r"^quicksand_steps_total (\S+)", text, re.M)[1])

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


def report(load, seconds):
    latencies = sorted(load.latencies)
    p99 = latencies[len(latencies) * 99 // 100]
    slower = statistics.median(load.without_clients)
    print(f"{len(latencies)} polls in {seconds:.0f} s: median {latencies[len(latencies) // 2] * 1000:.1f} ms, "
          f"p99 {p99 * 1000:.1f} ms [50]; answers {dict(sorted(load.statuses.items()))}")
    print(f"{load.events} events, {load.bytes / 1e6 / seconds:.0f} MB/s downloaded, memory {load.memory[0]:.0f} MB at first, "
          f"{load.memory[-1]:.0f} MB at the end, {max(load.memory):.0f} MB at most [200]")
    print(f"steps/s of the runs with clients: {slower:.1%} less than alone, without what the clients take (median of "
          f"{len(load.slower)} pairs, {min(load.without_clients):.1%} to {max(load.without_clients):.1%}) [10 %]; "
          f"{statistics.median(load.slower):.1%} with it; per second of processor time {statistics.median(load.dearer):.1%} less")
    print("processors busy with: " + ", ".join(f"{name} {used / seconds:.3f}" for name, used in load.seconds.items())
          + f" of {os.cpu_count()}")
    assert set(load.statuses) <= {200, 206, 429, 503}, load.statuses
    assert p99 < 0.05 and max(load.memory) < 200 and slower < 0.1


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
