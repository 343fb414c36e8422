"""A large result: constant memory of the service, cuts in the middle, the same sum in the end.

usage: download.py QUICKSAND SMALL_CASE [--gigabytes N]
"""

import argparse
import contextlib
import hashlib
import os
import random
import sqlite3
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../server"))

from service_process import ServiceProcess  # noqa: E402  (the folder is added above)

PIECE = 1 << 20


def resident_mb(process):
    with open(f"/proc/{process.pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1000


def enlarge(server, run_id, bytes_):
    """Puts a large file, mostly holes, in place of a run's result. The server must be stopped."""
    path = os.path.join(server.state, "runs", run_id, "result.vtkhdf")
    with open(path, "r+b") as file:
        file.truncate(bytes_)
        for k in range(100):  # so that a piece in the wrong place is seen
            file.seek(k * bytes_ // 100)
            file.write(f"mark {k}".encode())
    total = hashlib.sha256()
    with open(path, "rb") as file:
        while piece := file.read(PIECE):
            total.update(piece)
    with contextlib.closing(sqlite3.connect(server.state + "/quicksand.db")) as store, store:
        store.execute("UPDATE results SET bytes = ?, sha256 = ? WHERE run_id = ? AND name = 'result.vtkhdf'",
                      [bytes_, total.hexdigest(), run_id])
    return total.hexdigest()


def download(server, path, size, rng, cuts):
    """Sum of the file, fetched with so many cuts and resumed each time; and the most memory of the service."""
    total, have, most, etag = hashlib.sha256(), 0, 0, None
    ends = sorted(rng.randrange(size) for _ in range(cuts)) + [size]
    for end in ends:
        headers = {"Range": f"bytes={have}-", "If-Range": etag} if etag else {}
        with server.open(path, headers) as response:
            assert response.status == (206 if etag else 200), response.status
            assert not etag or response.headers["Content-Range"] == f"bytes {have}-{size - 1}/{size}"
            etag = response.headers["ETag"]
            while have < end and (piece := response.read(min(PIECE, end - have))):
                total.update(piece)
                have += len(piece)
                if have % (64 * PIECE) < PIECE:
                    most = max(most, resident_mb(server.process))
    return total.hexdigest(), most


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("quicksand")
    parser.add_argument("small_case")
    parser.add_argument("--gigabytes", type=float, default=3)
    options = parser.parse_args()
    size = int(options.gigabytes * 1e9)
    with tempfile.TemporaryDirectory(prefix="quicksand-download-") as folder:
        server = ServiceProcess(options.quicksand, folder + "/state").start()
        try:
            with open(options.small_case, "rb") as file:
                run_id = server.call("POST", "/v1/runs", file.read()).json()["id"]
            server.wait_for(run_id, "succeeded")
            server.stop()
            expected = enlarge(server, run_id, size)
            server.start()
            before = resident_mb(server.process)
            begin = time.monotonic()
            found, most = download(server, f"/v1/runs/{run_id}/results/result.vtkhdf", size, random.Random(1), cuts=5)
            took = time.monotonic() - begin
            assert found == expected, "other bytes"
            print(f"{size / 1e9:.1f} GB with 5 cuts: sha256 equal, {size / 1e6 / took:.0f} MB/s, "
                  f"memory {before:.0f} MB before and at most {most:.0f} MB [before + 20]")
            assert most < before + 20
        finally:
            server.kill()


if __name__ == "__main__":
    main()
