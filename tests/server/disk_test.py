"""A disk that is full, beyond its quota or read-only under a running service: runs stop and say why, reads are served,
and all goes on by itself, to the same bits, when that has passed.

usage: disk_test.py QUICKSAND SMALL_CASE READ_ONLY_LIBRARY [unittest options]
"""

import contextlib
import json
import os
import shutil
import subprocess
import sys
import time
import unittest

READ_ONLY_LIBRARY = sys.argv.pop(3)
PATIENCE = 180  # s, of a machine that has much else to do

from server_test import EXECUTABLE, ServerTest, assert_same_frames, endless_case, main, quicksand, small_case  # noqa: E402
from service_process import ServiceProcess  # noqa: E402


def case_of_many_frames(duration):
    """Some 135 MB per second of simulated time, at most 10 MB per second of wall time."""
    case = endless_case()
    case["stages"][0]["duration"] = duration
    case["output"]["frame_interval"] = 0.0006
    for box in (case["domain"], *(body["region"]["box"] for body in case["bodies"])):
        box["max"][0] = 0.16
    return case


class DiskTest(ServerTest):
    def stopped_for(self, run_id, code, seconds=PATIENCE):
        """The record of the run while it waits for the disk."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            run = self.server.get(f"/v1/runs/{run_id}").json()
            if run["status"] == "queued" and run["failure"]:
                self.assertEqual(run["failure"]["code"], code)
                self.assertNotIn(self.folder, run["failure"]["message"])
                return run
            time.sleep(0.02)
        self.fail(f"run is {run}")

    def log_of(self, run_id):
        return self.server.get(f"/v1/runs/{run_id}/log").body.decode()

    def wait_for_log(self, run_id, words, meanwhile):
        deadline = time.monotonic() + PATIENCE
        while words not in self.log_of(run_id):
            self.assertLess(time.monotonic(), deadline, self.log_of(run_id))
            meanwhile()
            time.sleep(0.1)

    def begun(self, case):
        """A run with frames and a checkpoint on disk."""
        run_id = self.submit(case)
        self.wait_for_checkpoint(run_id)
        return run_id

    def wait_for_checkpoint(self, run_id):
        checkpoint = os.path.join(self.state, "runs", run_id, "checkpoint")
        deadline = time.monotonic() + PATIENCE
        while not os.path.exists(checkpoint):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def assert_reads(self, done):
        """What is there can be read."""
        self.assertEqual(self.server.get("/healthz").status, 200)
        self.assertEqual(self.server.get("/v1/runs").status, 200)
        self.assertEqual(self.server.get(f"/v1/runs/{done}").json()["status"], "succeeded")
        self.assertEqual(self.server.get(f"/v1/runs/{done}/results/result.vtkhdf").status, 200)
        self.assertEqual(self.server.get(f"/v1/runs/{done}/frames/1").status, 200)

    def assert_undisturbed_frames(self, case, run_id):
        path, out = os.path.join(self.folder, "case.json"), os.path.join(self.folder, "undisturbed")
        with open(path, "w") as file:
            json.dump(case, file)
        ran = quicksand("run", path, "--out", out, "--overwrite")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        assert_same_frames(self, os.path.join(out, "result.vtkhdf"),
                           os.path.join(self.state, "runs", run_id, "result.vtkhdf"))


class QuotaTest(DiskTest):
    options = ("--workers", "1", "--set", "disk_quota=32M")

    def test_a_run_stops_and_goes_on_when_something_is_deleted(self):
        old = self.finished(case_of_many_frames(0.15))
        case = case_of_many_frames(0.2)
        run_id, waiting = self.submit(case), self.submit(small_case())
        run = self.stopped_for(run_id, "disk_full")
        self.assertIn("32M (disk_quota)", run["failure"]["message"])
        self.assertGreater(run["failure"]["at"]["time"], 0)
        self.assertEqual(self.server.get(f"/v1/runs/{run_id}/frames/1").status, 200)
        self.assert_problem(self.server.call("POST", "/v1/runs", small_case()), 507)
        self.assert_problem(self.server.get("/readyz"), 503)
        time.sleep(2.5)  # longer than the queue pauses: there is still no room
        self.assertEqual(self.server.get(f"/v1/runs/{run_id}").json()["status"], "queued")
        self.assertEqual(self.server.get(f"/v1/runs/{waiting}").json()["status"], "queued")
        self.assertEqual(self.server.call("DELETE", f"/v1/runs/{old}").status, 204)
        run = self.server.wait_for(run_id, "succeeded")
        self.assertIsNone(run["failure"])
        self.assertIn("resumed at", self.log_of(run_id))
        self.server.wait_for(waiting, "succeeded")
        with open(os.path.join(self.folder, "server.log")) as file:
            log = file.read()
        self.assertLess(log.index("the queue waits: "), log.index("the queue goes on"))
        self.assert_undisturbed_frames(case, run_id)


class TooMuchForTheQuotaTest(DiskTest):
    options = ("--workers", "1", "--set", "disk_quota=2M")

    def test_what_waits_can_be_canceled_and_keeps_its_frames(self):
        run_id, waiting = self.submit(case_of_many_frames(10)), self.submit(small_case())
        self.stopped_for(run_id, "disk_full")
        self.assertIsNone(self.cancel(run_id)["failure"])
        deadline = time.monotonic() + PATIENCE
        results = {}
        while "result.vtkhdf" not in results:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
            results = {result["name"]: result for result in self.server.get(f"/v1/runs/{run_id}/results").json()["results"]}
        path = f"/v1/runs/{run_id}/results/result.vtkhdf"
        self.assertEqual(self.server.get(path).headers["ETag"], f'"{results["result.vtkhdf"]["sha256"]}"')
        self.assertNotIn("checkpoint", os.listdir(os.path.join(self.state, "runs", run_id)))
        self.assertEqual(self.server.get(f"/v1/runs/{waiting}").json()["status"], "queued")
        self.assertEqual(self.server.call("DELETE", f"/v1/runs/{run_id}").status, 204)
        self.server.wait_for(waiting, "succeeded")


@unittest.skipUnless(os.geteuid() == 0, "mounting a small disk needs root")
class FullDiskTest(DiskTest):
    """A disk that is really full, on a tmpfs of 64 MB, without a reserve."""

    options = ("--workers", "1", "--set", "disk_reserve=0")

    @classmethod
    def setUpClass(cls):
        try:
            super().setUpClass()
        except Exception:  # then nothing is torn down
            subprocess.run(["umount", cls.disk], capture_output=True)
            raise

    @classmethod
    def prepare(cls):
        super().prepare()
        cls.disk = os.path.join(cls.folder, "disk")
        os.makedirs(cls.disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", cls.disk], capture_output=True).returncode:
            raise unittest.SkipTest("no tmpfs can be mounted here")
        cls.state = os.path.join(cls.disk, "state")
        cls.server = ServiceProcess(EXECUTABLE, cls.state, cls.options)
        cls.server.log_folder = cls.folder

    @classmethod
    def tearDownClass(cls):
        cls.server.kill()
        subprocess.run(["umount", cls.disk], check=True)
        super().tearDownClass()

    def test_full_and_room_again(self):
        done = self.finished(small_case())
        ballast = os.path.join(self.disk, "ballast")
        case = case_of_many_frames(0.12)  # 16 MB, so that it finds the disk full however fast it is
        with open(ballast, "wb") as file:
            os.posix_fallocate(file.fileno(), 0, shutil.disk_usage(self.disk).free - 12_000_000)
        run_id = self.begun(case)
        with open(ballast, "ab", buffering=0) as file, contextlib.suppress(OSError):
            while True:  # against the run, which writes as well
                file.write(b"\0" * 50_000)
        deadline = time.monotonic() + 3  # the log, too, may have found no room
        while time.monotonic() < deadline:
            self.assert_reads(done)
            time.sleep(0.3)
        self.assertNotIn(self.server.get(f"/v1/runs/{run_id}").json()["status"], ("succeeded", "failed"))
        os.remove(ballast)
        self.stopped_for(run_id, "disk_full")
        self.server.wait_for(run_id, "succeeded")
        self.assertIn("resumed at", self.log_of(run_id))
        self.assert_undisturbed_frames(case, run_id)
        self.finished(small_case())


class ReadOnlyTest(DiskTest):
    """A kernel lets nobody remount a disk while a file on it is open for writing; a broken disk turns read-only all the
    same. So a library between the service and the system says EROFS while a file is there."""

    options = ("--workers", "1")

    @classmethod
    def prepare(cls):
        super().prepare()
        cls.switch = os.path.join(cls.folder, "read-only")
        cls.server.environment = {"LD_PRELOAD": READ_ONLY_LIBRARY, "READ_ONLY_FOLDER": cls.state,
                                  "READ_ONLY_WHILE": cls.switch, "ASAN_OPTIONS": "verify_asan_link_order=0"}

    def test_read_only_and_writable_again(self):
        done = self.finished(small_case())
        case = case_of_many_frames(0.12)
        run_id = self.submit(case)
        waiting = self.submit(small_case())  # before it is looked whether the other has begun, which would soon end
        self.wait_for_checkpoint(run_id)
        open(self.switch, "w").close()
        self.wait_for_log(run_id, "Read-only file system", lambda: self.assert_reads(done))
        for method, path, body in (("POST", "/v1/runs", small_case()), ("DELETE", f"/v1/runs/{done}", None)):
            refused = self.server.call(method, path, body)
            self.assert_problem(refused, 503)
            self.assertIn("Retry-After", refused.headers)
        self.assert_problem(self.server.get("/readyz"), 503)
        self.assert_reads(done)
        self.assertNotIn(self.server.get(f"/v1/runs/{run_id}").json()["status"], ("succeeded", "failed"))
        os.remove(self.switch)
        self.stopped_for(run_id, "read_only")
        self.server.wait_for(run_id, "succeeded")
        self.server.wait_for(waiting, "succeeded")
        self.assertIn("resumed at", self.log_of(run_id))
        self.assertEqual(self.server.get("/readyz").status, 200)
        self.assert_undisturbed_frames(case, run_id)

    def test_an_orderly_stop_of_a_read_only_service(self):
        case = case_of_many_frames(0.12)
        run_id = self.begun(case)
        open(self.switch, "w").close()
        self.assertLess(self.server.stop(), 10)
        os.remove(self.switch)
        self.server.start()
        self.server.wait_for(run_id, "succeeded", seconds=120)


if __name__ == "__main__":
    main()
