"""Many clients behind the shipped nginx: 5 000 runs in the store, 64 clients polling, 16 streaming, 8 downloading 1 GB
in ranges while two runs compute.

usage: load.py QUICKSAND SMALL_CASE [--minutes N] [--runs N] [--megabytes-per-s RATE]

Each poller asks once a second; each download is held to RATE, so that the figures are those of the service and not of
a machine that is busy with encrypting.
"""

import argparse
import asyncio
import contextlib
import json
import os
import sqlite3
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../server"))

from download import enlarge, resident_mb  # noqa: E402  (the folders are added above)
from nginx_process import NginxProcess  # noqa: E402
from server_test import make_key  # noqa: E402
from service_process import ServiceProcess  # noqa: E402

POLLERS, STREAMS, DOWNLOADS = 64, 16, 8
SIZE, RANGE = 10**9, 16 << 20


def fill_store(server, run_id, count):
    """Copies of an ended run."""
    with contextlib.closing(sqlite3.connect(server.state + "/quicksand.db")) as store, store:
        names = [row[1] for row in store.execute("PRAGMA table_info(runs)") if row[1] not in ("sequence", "id")]
        columns = ", ".join(names)
        store.executemany(f"INSERT INTO runs (id, {columns}) SELECT ?, {columns} FROM runs WHERE id = ?",
                          [(f"{k:016x}", run_id) for k in range(count - 1)])


class Load:
    def __init__(self, nginx, key, ids, large, rate):
        self.nginx, self.key, self.ids, self.large, self.rate = nginx, key, ids, large, rate
        self.latencies, self.statuses, self.events, self.bytes = [], {}, 0, 0
        self.end = 0

    async def connect(self):
        return await asyncio.open_connection("127.0.0.1", self.nginx.port, ssl=self.nginx.context,
                                             server_hostname="lab.example", limit=1 << 20)

    async def ask(self, connection, path, headers=""):
        """Status and length of the body, which is still to be read; None when it ends with the connection."""
        reader, writer = connection
        writer.write(f"GET {path} HTTP/1.1\r\nHost: lab.example\r\nX-API-Key: {self.key}\r\n{headers}\r\n".encode())
        head = (await reader.readuntil(b"\r\n\r\n")).decode()
        status = int(head.split()[1])
        self.statuses[status] = self.statuses.get(status, 0) + 1
        if status in (429, 503):
            assert "Retry-After" in head, head
        length = [line.split(": ")[1] for line in head.split("\r\n") if line.lower().startswith("content-length: ")]
        return status, int(length[0]) if length else None

    async def poll(self, k):
        """Over one connection, as a browser or a script does."""
        await asyncio.sleep(k / POLLERS)
        connection = await self.connect()
        n = 0
        while time.monotonic() < self.end:
            n += 1
            begin = time.monotonic()
            status, length = await self.ask(connection, f"/v1/runs/{self.ids[(k * 77 + n) % len(self.ids)]}")
            await connection[0].readexactly(length)
            self.latencies.append(time.monotonic() - begin)
            assert status in (200, 429, 503), status
            if n % 900 == 0:  # nginx ends a connection after 1000 requests
                connection[1].close()
                connection = await self.connect()
            await asyncio.sleep(max(0, begin + 1 - time.monotonic()))
        connection[1].close()

    async def stream(self, run_id):
        while time.monotonic() < self.end:
            connection = await self.connect()
            await self.ask(connection, f"/v1/runs/{run_id}/events")
            with contextlib.suppress(asyncio.TimeoutError):
                while time.monotonic() < self.end and (line := await asyncio.wait_for(connection[0].readline(), 20)):
                    self.events += line.startswith(b"id: ")
            connection[1].close()
            await asyncio.sleep(0.5)

    async def download(self, k):
        at = k * RANGE
        connection = await self.connect()
        while time.monotonic() < self.end:
            begin = time.monotonic()
            status, length = await self.ask(connection, f"/v1/runs/{self.large}/results/result.vtkhdf",
                                            f"Range: bytes={at}-{at + RANGE - 1}\r\n")
            assert status in (206, 429, 503), status
            assert status != 206 or length == RANGE, length
            got = 0
            while got < length:
                piece = await connection[0].read(min(1 << 18, length - got))
                assert piece, "cut"
                got += len(piece)
                self.bytes += len(piece)
                await asyncio.sleep(max(0, begin + got / self.rate - time.monotonic()))
            at = (at + RANGE) % (SIZE - RANGE)
        connection[1].close()

    async def run(self, seconds, running):
        self.end = time.monotonic() + seconds
        await asyncio.gather(*(self.poll(k) for k in range(POLLERS)),
                             *(self.stream(running[k % len(running)]) for k in range(STREAMS)),
                             *(self.download(k) for k in range(DOWNLOADS)))


def steps_per_s(server, key, running, seconds):
    """Of the runs together, counted over some time."""
    def steps():
        return sum(server.call("GET", f"/v1/runs/{i}", headers={"X-API-Key": key}).json()["progress"]["step"] for i in running)
    first, begin = steps(), time.monotonic()
    time.sleep(seconds)
    return (steps() - first) / (time.monotonic() - begin)


def prepare(options, folder):
    """A server with its runs, two of which compute, and nginx in front."""
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


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("quicksand")
    parser.add_argument("small_case")
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--runs", type=int, default=5000)
    parser.add_argument("--megabytes-per-s", type=float, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="quicksand-load-") as folder:
        server, key, large, running = prepare(options, folder)
        nginx = NginxProcess(folder + "/nginx", server.address.port).start()
        try:
            alone = steps_per_s(server, key, running, 10)
            ids = [f"{k:016x}" for k in range(options.runs - 1)]
            load = Load(nginx, key, ids, large, options.megabytes_per_s * 1e6)
            memory = [resident_mb(server.process)]
            seconds = options.minutes * 60
            first = sum(progress(server, key, i) for i in running)
            begin = time.monotonic()
            asyncio.run(load.run(seconds, running))
            loaded = (sum(progress(server, key, i) for i in running) - first) / (time.monotonic() - begin)
            memory.append(resident_mb(server.process))
            report(load, alone, loaded, memory, seconds)
        finally:
            nginx.stop()
            server.kill()


def progress(server, key, run_id):
    return server.call("GET", f"/v1/runs/{run_id}", headers={"X-API-Key": key}).json()["progress"]["step"]


def report(load, alone, loaded, memory, seconds):
    latencies = sorted(load.latencies)
    p99 = latencies[len(latencies) * 99 // 100]
    slower = 1 - loaded / alone
    print(f"{len(latencies)} polls in {seconds:.0f} s: median {latencies[len(latencies) // 2] * 1000:.1f} ms, "
          f"p99 {p99 * 1000:.1f} ms [50]; answers {dict(sorted(load.statuses.items()))}")
    print(f"{load.events} events, {load.bytes / 1e6 / seconds:.0f} MB/s downloaded, memory {memory[0]:.0f} MB before and "
          f"{memory[1]:.0f} MB after [200], steps/s {alone:.0f} alone and {loaded:.0f} under load: {slower:.1%} less [10 %]")
    assert set(load.statuses) <= {200, 206, 429, 503}, load.statuses
    assert p99 < 0.05 and max(memory) < 200 and slower < 0.1


if __name__ == "__main__":
    main()
