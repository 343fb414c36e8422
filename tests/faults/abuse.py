"""Clients that mean no good: the probe table, slow clients, mutated requests and mutated cases.

usage: abuse.py QUICKSAND SMALL_CASE [--requests N] [--cases N] [--seed S]

The service has to stay alive and quick, keep its limits and answer every request that it answers with a status below
500 or 503. QUICKSAND may be built with the address sanitizer: what it reports ends the service and this test.
"""

import argparse
import concurrent.futures
import copy
import json
import multiprocessing
import os
import random
import socket
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../server"))

from service_process import ServiceProcess  # noqa: E402  (the folder is added above)

MAX_QUEUED = 5
TYPE = b"Content-Type: application/json\r\n"


def request(method, path, headers=b"", body=b""):
    head = method + b" " + path + b" HTTP/1.1\r\nHost: localhost\r\n" + headers
    if body:
        head += b"Content-Length: %d\r\n" % len(body)
    return head + b"\r\n" + body


def watch(server, ended, slowest):
    """Asks /healthz all the time and keeps the slowest answer; -1 when one is wrong."""
    os.setsid()
    while not ended.is_set():
        begin = time.monotonic()
        if server.get("/healthz").status != 200:
            slowest.value = -1
            return
        slowest.value = max(slowest.value, time.monotonic() - begin)
        time.sleep(0.02)


class Watch:
    """In a process and a session of its own, as it would wait for the many clients in this one."""

    def __init__(self, server):
        self.ended, self.slowest = multiprocessing.Event(), multiprocessing.Value("d", 0)
        self.process = multiprocessing.Process(target=watch, args=(server, self.ended, self.slowest))

    def start(self):
        self.process.start()

    def end(self):
        self.ended.set()
        self.process.join()
        assert self.process.exitcode == 0 and self.slowest.value > 0
        return self.slowest.value


def probe_table(server):
    """Each row of what the HTTP library accepts by itself, and the status it gets here."""
    chunked = b"".join(b"10000\r\n" + b"x" * 65536 + b"\r\n" for _ in range(320)) + b"0\r\n\r\n"
    gzipped = b"\x1f\x8b" + b"\0" * 194_000
    rows = [
        ("20 MB chunked", request(b"POST", b"/v1/runs", TYPE + b"Transfer-Encoding: chunked\r\n") + chunked, 411),
        ("compressed body", request(b"POST", b"/v1/runs", TYPE + b"Content-Encoding: gzip\r\n", gzipped), 415),
        ("length and chunks", request(b"POST", b"/v1/runs", TYPE + b"Transfer-Encoding: chunked\r\n", b"{}"), 411),
        ("two lengths", request(b"POST", b"/v1/runs", TYPE + b"Content-Length: 3\r\n", b"{}"), 400),
        ("length abc", request(b"POST", b"/v1/runs", TYPE + b"Content-Length: abc\r\n"), 400),
        ("length 2^64", request(b"POST", b"/v1/runs", TYPE + b"Content-Length: 18446744073709551616\r\n"), 400),
        ("length 10 GB", request(b"POST", b"/v1/runs", TYPE + b"Content-Length: 10000000000\r\n"), 413),
        ("50 MB header line", request(b"GET", b"/healthz", b"A: " + b"x" * 50_000_000 + b"\r\n"), 400),
        ("no host", b"GET /v1/runs HTTP/1.1\r\n\r\n", 400),
        ("another host", b"GET /v1/runs HTTP/1.1\r\nHost: lab.example\r\n\r\n", 421),
        ("wrong method", request(b"PATCH", b"/v1/runs"), 405),
        ("long path", request(b"GET", b"/" + b"x" * 9000), 414),
        ("100 000 brackets", request(b"POST", b"/v1/validate", TYPE, b"[" * 100_000), 422),
        ("key twice", request(b"POST", b"/v1/validate", TYPE, b'{"a":1,"a":2}'), 422),
        ("up the tree", request(b"GET", b"/v1/runs/..%2f..%2fquicksand.db/log"), 404),
        ("nothing but zeros", b"\0" * 1000 + b"\r\n\r\n", 400),
    ]
    for name, bytes_, status in rows:
        found, head, _ = server.raw(bytes_)
        assert found == status, f"{name}: {found} instead of {status}\n{head}"
        assert "EXCEPTION" not in head, head
    print(f"probe table: {len(rows)} rows as they should be")


def slow_clients(server, count=40):
    address = (server.address.hostname, server.address.port)
    watch = Watch(server)
    slow = []
    for k in range(count):
        sock = socket.create_connection(address)
        sock.sendall([b"GET /healthz HT", request(b"POST", b"/v1/runs", TYPE + b"Content-Length: 4000\r\n") + b"{"][k % 2])
        slow.append(sock)
    watch.start()
    deadline = time.monotonic() + 4
    while time.monotonic() < deadline:  # a byte now and then keeps them all open
        for sock in slow:
            try:
                sock.sendall(b" ")
            except OSError:
                pass  # given up by the service
        time.sleep(0.5)
    slowest = watch.end()
    for sock in slow:
        sock.close()
    print(f"{count} slow clients: /healthz in at most {slowest * 1000:.0f} ms [1000]")
    assert slowest < 1


def mutate_bytes(rng, bytes_):
    data = bytearray(bytes_)
    for _ in range(rng.randint(1, 6)):
        at = rng.randrange(len(data) + 1)
        kind = rng.randrange(5)
        if kind == 0 and data:
            data[at % len(data)] = rng.randrange(256)
        elif kind == 1:
            data[at:at] = bytes(rng.choices(b"\0\r\n :;,/%?&=\xff0123456789", k=rng.randint(1, 8)))
        elif kind == 2:
            del data[at:at + rng.randint(1, 20)]
        elif kind == 3:
            data[at:at] = data[rng.randrange(len(data) + 1):][:rng.randint(1, 60)]
        else:
            data[at:at] = rng.choice([b"\r\nContent-Length: 5", b"\r\nTransfer-Encoding: chunked", b"\r\nRange: bytes=-",
                                      b"\r\nHost: x", b"99999999999999999999", b"%00", b"../"])
    return bytes(data)


def seeds(case, run_id):
    run = b"/v1/runs/" + run_id.encode()
    paths = [b"", b"/case", b"/log", b"/events", b"/series?name=probe.below&format=csv", b"/frames/0?fields=position&stride=2",
             b"/results", b"/results/run.json"]
    yield from (request(b"GET", run + path) for path in paths)
    yield request(b"GET", run + b"/results/result.vtkhdf", b'Range: bytes=0-99\r\nIf-Range: "a"\r\n')
    yield request(b"GET", run, b"Prefer: wait=0\r\nIf-None-Match: W/\"a\"\r\n")
    yield request(b"GET", b"/v1/runs?status=succeeded&label=a&created_after=2024-05-06T07:08:09Z&limit=5&page_token=9")
    yield request(b"POST", b"/v1/runs?label=x&priority=-1", TYPE + b"Idempotency-Key: k\r\n", case)
    yield request(b"POST", b"/v1/validate", TYPE, case)
    yield request(b"POST", b"/v1/runs/0/cancel")
    yield request(b"DELETE", b"/v1/runs/0")
    yield request(b"OPTIONS", b"/v1/runs", b"Origin: http://a\r\nAccess-Control-Request-Method: POST\r\n")


def send(server, bytes_, timeout=8):
    """Status of the first answer; 0 for none."""
    with socket.create_connection((server.address.hostname, server.address.port), timeout=timeout) as sock:
        try:
            sock.sendall(bytes_)
            head = sock.recv(64)
        except (ConnectionError, socket.timeout):
            return 0
    return int(head[9:12]) if head.startswith(b"HTTP/1.1 ") and head[9:12].isdigit() else 0


def mutated_requests(server, case, run_id, count, rng):
    corpus = list(seeds(case, run_id))
    statuses = {}
    with concurrent.futures.ThreadPoolExecutor(24) as clients:  # many wait for an answer to half a request
        for status in clients.map(lambda bytes_: send(server, bytes_),
                                  [mutate_bytes(rng, rng.choice(corpus)) for _ in range(count)]):
            statuses[status] = statuses.get(status, 0) + 1
    queued = server.get("/v1/service-info").json()["runs"]["queued"]
    print(f"{count} mutated requests: {dict(sorted(statuses.items()))}")
    assert not [s for s in statuses if s >= 500 and s != 503], statuses
    assert queued <= MAX_QUEUED, queued


ODD = [None, True, 0, -1, -0.0, 1e308, -1e308, 5e-324, 2**31, 2**63, 10**400, "", "x" * 300, "\u0000", "\ud83d\ude00", [], {},
       [[]], [1], {"": 0}, 0.5, 3, "draft", "NaN"]


def places(value, path=()):
    yield path
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield from places(child, path + (key,))


def mutate_case(rng, case):
    case = copy.deepcopy(case)
    for _ in range(rng.randint(1, 4)):
        path = rng.choice(list(places(case)))
        if not path:
            continue
        parent = case
        for key in path[:-1]:
            parent = parent[key]
        key, kind = path[-1], rng.randrange(5)
        if kind == 0:
            del parent[key]
        elif kind == 1 and isinstance(parent[key], (int, float)) and abs(parent[key]) < 1e300:
            parent[key] = parent[key] * rng.choice([0, -1, 1e-12, 0.1, 10, 1e12, 1e300])
        elif kind == 2 and isinstance(parent, list):
            parent.extend([copy.deepcopy(parent[key])] * rng.choice([1, 2, 200]))
        elif kind == 3 and isinstance(parent, dict):
            parent[rng.choice([str(key) + "x", "name", "region", "kind"])] = copy.deepcopy(parent[key])
        else:
            parent[key] = copy.deepcopy(rng.choice(ODD))
    return case


def mutated_cases(server, cases, count, rng, longest):
    """One in ten is tried on larger cells as well, if it is accepted."""
    statuses, slowest, tried = {}, 0, 0
    for k in range(count):
        text = json.dumps(mutate_case(rng, rng.choice(cases)))
        begin = time.monotonic()
        answer = server.call("POST", "/v1/validate" + ("?trial=1" if k % 10 == 0 else ""), text)
        status = answer.status
        tried += status == 200 and answer.json()["trial"] is not None
        took = time.monotonic() - begin
        if took > slowest:
            slowest, slowest_text = took, text
        if status not in (200, 413, 422):
            raise AssertionError(f"{status} for {text[:2000]}")
        statuses[status] = statuses.get(status, 0) + 1
    print(f"{count} mutated cases: {dict(sorted(statuses.items()))}, {tried} tried, the slowest took {slowest:.2f} s [{longest:g}]")
    assert slowest < longest, slowest_text[:2000]


def resident_mb(server):
    with open(f"/proc/{server.process.pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1000


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("quicksand")
    parser.add_argument("small_case")
    parser.add_argument("--requests", type=int, default=10_000)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--longest", type=float, default=5, help="s that checking a case may take")
    options = parser.parse_args()
    with open(options.small_case, "rb") as file:
        text = file.read()
    with tempfile.TemporaryDirectory(prefix="quicksand-abuse-") as folder:
        server = ServiceProcess(options.quicksand, folder + "/state",
                                ["--workers", "1", "--set", f"max_queued={MAX_QUEUED}", "--log-level", "error"])
        server.alone = True
        server.start()
        try:
            cases = [json.loads(text)] + [server.get(case["href"]).json() for case in server.get("/v1/cases").json()["cases"]]
            run_id = server.call("POST", "/v1/runs", text).json()["id"]
            server.wait_for(run_id, "succeeded")
            probe_table(server)
            slow_clients(server)
            before = resident_mb(server)
            watch = Watch(server)
            watch.start()
            try:
                mutated_requests(server, text, run_id, options.requests, random.Random(options.seed))
                mutated_cases(server, cases, options.cases, random.Random(options.seed), options.longest)
            finally:
                slowest = watch.end()
            print(f"meanwhile /healthz in at most {slowest * 1000:.0f} ms [1000], "
                  f"memory {before:.0f} MB before and {resident_mb(server):.0f} MB after")
            assert slowest < 1
            assert server.process.poll() is None
        finally:
            if server.process.poll() is None:
                server.stop()
            else:
                with open(folder + "/server.log") as file:
                    print(file.read()[-4000:])
                raise SystemExit("the service died")


if __name__ == "__main__":
    main()
