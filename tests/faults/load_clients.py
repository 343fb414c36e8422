"""Clients of the load test, a process of their own, so that their processor time is not the service's.

usage: load_clients.py PORT CERTIFICATE KEY pollers|streams|downloads FACTS; then a line with seconds on standard input
starts them, and a line of JSON on standard output tells what they met.

Only pollers, who measure, have the priority of their caller: who only has to keep the service busy must not take the
processor before those who take the time of it.
"""

import asyncio
import contextlib
import json
import os
import ssl
import sys
import time

POLLERS, STREAMS, DOWNLOADS = 64, 16, 8
LOWEST_PRIORITY = 19
SIZE, RANGE = 10**9, 16 << 20


class Clients:
    def __init__(self, port, certificate, key, facts):
        self.port, self.key, self.facts = port, key, facts
        self.context = ssl.create_default_context(cafile=certificate)
        self.end = 0

    def forget(self):
        self.latencies, self.statuses, self.events, self.bytes = [], {}, 0, 0
        self.late = []  # s that the pollers themselves woke too late: they waited for a processor

    async def connect(self):
        return await asyncio.open_connection("127.0.0.1", self.port, ssl=self.context, server_hostname="lab.example",
                                             limit=1 << 20)

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
        """Once a second, over one connection, as a browser or a script does."""
        await asyncio.sleep(k / POLLERS)
        connection = await self.connect()
        n = 0
        while time.monotonic() < self.end:
            n += 1
            begin = time.monotonic()
            status, length = await self.ask(connection, f"/v1/runs/{self.facts['ids'][(k * 77 + n) % len(self.facts['ids'])]}")
            await connection[0].readexactly(length)
            self.latencies.append(time.monotonic() - begin)
            assert status in (200, 429, 503), status
            if n % 900 == 0:  # nginx ends a connection after 1000 requests
                connection[1].close()
                connection = await self.connect()
            await self.sleep_until(begin + 1)
        connection[1].close()

    async def sleep_until(self, due):
        left = due - time.monotonic()
        await asyncio.sleep(max(0, left))
        if left > 0:
            self.late.append(time.monotonic() - due)

    async def stream(self, k):
        running = self.facts["running"]
        while time.monotonic() < self.end:
            connection = await self.connect()
            await self.ask(connection, f"/v1/runs/{running[k % len(running)]}/events")
            with contextlib.suppress(asyncio.TimeoutError):
                while (left := self.end - time.monotonic()) > 0:
                    line = await asyncio.wait_for(connection[0].readline(), min(20, left))
                    if not line:
                        break
                    self.events += line.startswith(b"id: ")
            connection[1].close()
            await asyncio.sleep(0.5)

    async def download(self, k):
        at, rate = k * RANGE, self.facts["rate"]
        connection = await self.connect()
        while time.monotonic() < self.end:
            begin = time.monotonic()
            status, length = await self.ask(connection, f"/v1/runs/{self.facts['large']}/results/result.vtkhdf",
                                            f"Range: bytes={at}-{at + RANGE - 1}\r\n")
            assert status in (206, 429, 503), status
            assert status != 206 or length == RANGE, length
            got = 0
            while got < length and time.monotonic() < self.end:
                piece = await connection[0].read(min(1 << 18, length - got))
                assert piece, "cut"
                got += len(piece)
                self.bytes += len(piece)
                await asyncio.sleep(max(0, begin + got / rate - time.monotonic()))
            at = (at + RANGE) % (SIZE - RANGE)
        connection[1].close()

    async def run(self, kind, seconds):
        self.forget()
        self.end = time.monotonic() + seconds
        one, count = {"pollers": (self.poll, POLLERS), "streams": (self.stream, STREAMS),
                      "downloads": (self.download, DOWNLOADS)}[kind]
        await asyncio.gather(*(one(k) for k in range(count)))


def main():
    port, certificate, key, kind, facts = sys.argv[1:]
    if kind != "pollers":
        os.nice(LOWEST_PRIORITY)
    clients = Clients(int(port), certificate, key, json.loads(facts))
    for line in sys.stdin:
        asyncio.run(clients.run(kind, float(line)))
        print(json.dumps({"latencies": clients.latencies, "late": clients.late, "statuses": clients.statuses,
                          "events": clients.events, "bytes": clients.bytes}), flush=True)


if __name__ == "__main__":
    main()
