"""Limits and fairness on a running service: disk, memory, points, and short runs beside long ones.

usage: limits_live_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import contextlib
import os
import subprocess
import time
import unittest

from server_test import EXECUTABLE, ServerTest, endless_case, main, make_key, small_case
from service_process import ServiceProcess


def case_of_many_frames():
    """Some MB per second."""
    case = endless_case()
    case["stages"][0]["duration"] = 10
    case["output"]["frame_interval"] = 0.0002
    return case


class CaseLimitsTest(ServerTest):
    """A case that is too large is refused before anything of it is stored."""

    options = ("--set", "max_points=100", "--set", "max_memory=1k")

    def test_points_and_memory(self):
        for path in ("/v1/runs", "/v1/validate"):
            answer = self.server.call("POST", path, small_case())
            self.assert_problem(answer, 422)
            details = " ".join(error["detail"] for error in answer.json()["errors"])
            self.assertIn("100 (max_points)", details)
            self.assertIn("(max_memory)", details)

    def test_what_no_machine_holds(self):
        case = small_case()
        for cell_size in (1e-5, 1e-7, 1e-12, 1e-300):
            case["domain"]["cell_size"] = cell_size
            begin = time.monotonic()
            self.assert_problem(self.server.call("POST", "/v1/validate", case), 422)
            self.assertLess(time.monotonic() - begin, 5, cell_size)


class FairnessTest(ServerTest):
    """Two workers, one of them for short runs."""

    def test_a_short_run_does_not_wait_for_a_long_one(self):
        first, second = self.submit(endless_case()), self.submit(endless_case())
        self.server.wait_for(first, "running")
        begin = time.monotonic()
        self.finished(small_case())
        self.assertLess(time.monotonic() - begin, 10)
        self.assertEqual(self.server.get(f"/v1/runs/{second}").json()["status"], "queued")
        self.assertEqual(self.server.get(f"/v1/runs/{first}").json()["status"], "running")
        for run_id in (second, first):
            self.cancel(run_id)

    def test_priority(self):
        run = self.server.call("POST", "/v1/runs?priority=-3", small_case()).json()
        self.assertEqual(run["priority"], -3)
        for priority in ("11", "-11", "high"):
            self.assert_problem(self.server.call("POST", f"/v1/runs?priority={priority}", small_case()), 400)

    def test_the_log_tells_the_threads(self):
        run_id = self.finished(small_case())
        self.assertIn("threads 1\n", self.server.get(f"/v1/runs/{run_id}/log").body.decode())


class TimeLimitTest(ServerTest):
    options = ("--set", "max_run_s=1",)

    def test_a_run_ends_and_keeps_its_frames(self):
        run_id = self.submit(endless_case())
        run = self.server.wait_for(run_id, "failed", seconds=20)
        self.assertEqual(run["failure"]["code"], "time_limit")
        self.assertIn("1 (max_run_s)", run["failure"]["message"])
        self.assertGreater(run["failure"]["at"]["time"], 0)
        results = self.server.get(f"/v1/runs/{run_id}/results").json()["results"]
        self.assertEqual([result["name"] for result in results], ["result.vtkhdf", "result.xdmf", "run.json"])


class PriorityNeedsAnAdminTest(ServerTest):
    def test_above_zero(self):
        key = {"X-API-Key": make_key(self.state, "anna", "submit")}
        admin = {"X-API-Key": make_key(self.state, "root", "admin")}
        self.assert_problem(self.server.call("POST", "/v1/runs?priority=1", small_case(), key), 403)
        self.assertEqual(self.server.call("POST", "/v1/runs?priority=-1", small_case(), key).status, 201)
        self.assertEqual(self.server.call("POST", "/v1/runs?priority=1", small_case(), admin).status, 201)


class QuotaTest(ServerTest):
    """What computes ends when the results have become too many, and what waits goes on when there is room."""

    options = ("--workers", "1", "--set", "disk_quota=2M")

    def test_quota(self):
        case = case_of_many_frames()
        run_id, waiting = self.submit(case), self.submit(small_case())
        run = self.server.wait_for(run_id, "failed")
        self.assertEqual(run["failure"]["code"], "disk_full")
        self.assertIn("2M (disk_quota)", run["failure"]["message"])
        self.assertEqual(self.server.get(f"/v1/runs/{run_id}/results").status, 200)
        self.assert_problem(self.server.call("POST", "/v1/runs", small_case()), 507)
        self.assertEqual(self.server.get(f"/v1/runs/{waiting}").json()["status"], "queued")
        self.assert_problem(self.server.get("/readyz"), 503)
        self.assertEqual(self.server.call("DELETE", f"/v1/runs/{run_id}").status, 204)
        self.server.wait_for(waiting, "succeeded")
        with open(os.path.join(self.folder, "server.log")) as file:
            log = file.read()
        self.assertLess(log.index("the queue waits: "), log.index("the queue goes on"))


@unittest.skipUnless(os.geteuid() == 0, "mounting a small disk needs root")
class FullDiskTest(ServerTest):
    """A disk that is really full, on a tmpfs of 8 MB, without a reserve."""

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
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", cls.disk], capture_output=True).returncode:
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
        case = case_of_many_frames()
        run_id = self.submit(case)
        self.server.wait_for(run_id, "running")
        with open(ballast, "wb", buffering=0) as file, contextlib.suppress(OSError):
            while True:  # against the run, which writes as well
                file.write(b"\0" * 50_000)
        log = f"/v1/runs/{run_id}/log"
        deadline = time.monotonic() + 30
        while "ended" not in self.server.get(log).body.decode():
            self.assertLess(time.monotonic(), deadline)
            self.assertEqual(self.server.get(f"/v1/runs/{done}").json()["status"], "succeeded")
            self.assertEqual(self.server.get(f"/v1/runs/{done}/results/result.vtkhdf").status, 200)
            if self.server.get(f"/v1/runs/{run_id}").json()["status"] == "failed":
                break  # the log's last line may have found no room
            time.sleep(0.1)
        os.remove(ballast)
        run = self.server.wait_for(run_id, "failed")
        self.assertEqual(run["failure"]["code"], "disk_full")
        self.assertNotIn(self.disk, run["failure"]["message"])
        self.assertEqual(self.server.call("DELETE", f"/v1/runs/{run_id}").status, 204)
        self.finished(small_case())


if __name__ == "__main__":
    main()
