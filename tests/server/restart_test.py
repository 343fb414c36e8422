"""Kills, orderly stops and second servers."""

import os
import shutil
import tempfile
import threading
import time

from server_test import EXECUTABLE, ServerTest, assert_same_frames, endless_case, main, quicksand, small_case
from service_process import ServiceProcess


class RestartTest(ServerTest):
    """Killed, stopped and started again. Each test has a state folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="quicksand-walk-")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.state = os.path.join(self.folder, self.id().split(".")[-1], "state")
        os.makedirs(self.state)
        self.server = ServiceProcess(EXECUTABLE, self.state, ["--workers", "1"]).start()

    def tearDown(self):
        if self.server.process.poll() is None:
            self.server.kill()

    def started_endless(self):
        """A run with at least one flushed frame on disk."""
        run_id = self.submit(endless_case())
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline:
            progress = self.server.get(f"/v1/runs/{run_id}").json()["progress"]
            if progress and progress["frames"] >= 2:
                return run_id
            time.sleep(0.05)
        self.fail("no frames after 30 s")

    def test_kill_in_the_middle(self):
        done = self.finished(small_case())
        kept = self.server.get(f"/v1/runs/{done}/results").json()
        running = self.started_endless()
        queued = self.submit(small_case())
        self.server.kill()
        run_folder = os.path.join(self.state, "runs", running)
        self.assertIn("result.vtkhdf.part", os.listdir(run_folder))

        self.server.start()
        runs = {run["id"]: run for run in self.server.get("/v1/runs").json()["runs"]}
        self.assertEqual(set(runs), {done, running, queued})
        self.assertEqual(runs[done]["status"], "succeeded")
        self.assertEqual(self.server.get(f"/v1/runs/{done}/results").json(), kept)
        run = self.server.wait_for(running, "running")
        self.assertEqual(run["retries"], 1)
        self.assertEqual(self.server.get(f"/v1/runs/{running}/results").json(), {"results": []})

        self.cancel(running)
        self.assertEqual(self.server.wait_for(queued, "succeeded")["retries"], 0)

    def wait_for_checkpoint(self, run_id):
        """On disk, and after the server's own start."""
        checkpoint = os.path.join(self.state, "runs", run_id, "checkpoint")
        begin, deadline = time.time(), time.monotonic() + 30
        while time.monotonic() < deadline:
            if os.path.exists(checkpoint) and os.path.getmtime(checkpoint) > begin:
                return
            time.sleep(0.02)
        self.fail("no checkpoint after 30 s")

    def log_of(self, run_id):
        with open(os.path.join(self.state, "runs", run_id, "run.log")) as log:
            return log.read()

    def test_a_killed_run_goes_on_to_the_same_frames(self):
        case = small_case()
        case["stages"][0]["duration"] = 2.0
        run_id = self.submit(case)
        for end in (self.server.kill, self.server.stop, self.server.kill):
            self.wait_for_checkpoint(run_id)
            end()
            self.server.start()
        self.server.wait_for(run_id, "succeeded", seconds=120)
        self.assertGreaterEqual(self.log_of(run_id).count("resumed at"), 2)
        self.assertNotIn("checkpoint", os.listdir(os.path.join(self.state, "runs", run_id)))
        again = self.finished(case)
        files = [os.path.join(self.state, "runs", name, "result.vtkhdf") for name in (run_id, again)]
        assert_same_frames(self, *files)

    def test_canceling_when_killed_is_canceled(self):
        run_id = self.submit(endless_case())
        self.server.wait_for(run_id, "running")
        self.server.call("POST", f"/v1/runs/{run_id}/cancel")
        self.server.kill()
        self.server.start()
        self.assertEqual(self.server.get(f"/v1/runs/{run_id}").json()["status"], "canceled")

    def test_an_orderly_stop_continues_at_the_next_start(self):
        run_id = self.submit(endless_case())
        self.server.wait_for(run_id, "running")
        poll = threading.Thread(target=self.server.get, args=[f"/v1/runs/{run_id}"], kwargs={"Prefer": "wait=30"})
        poll.start()
        with self.server.open(f"/v1/runs/{run_id}/events"):
            time.sleep(0.3)
            self.assertLess(self.server.stop(), 10)
        poll.join()
        self.assertFalse(os.path.exists(os.path.join(self.state, "server.json")))
        self.server.start()
        run = self.server.wait_for(run_id, "running")
        self.assertEqual(run["retries"], 0)
        self.cancel(run_id)

    def test_two_servers_on_one_state(self):
        second = quicksand("serve", "--port", "auto", "--state", self.state)
        self.assertEqual(second.returncode, 1)
        self.assertIn("another server uses the state folder", second.stderr)
        self.assertIn(self.server.url, second.stderr)
        self.assertEqual(self.server.get("/readyz").status, 200)

    def test_two_servers_get_two_ports(self):
        other = ServiceProcess(EXECUTABLE, self.state + "-2")
        other.start()
        self.assertNotEqual(other.url, self.server.url)
        other.kill()
        taken = quicksand("serve", "--port", str(self.server.address.port), "--state", self.state + "-3")
        self.assertEqual(taken.returncode, 1)
        self.assertIn("not free", taken.stderr)


if __name__ == "__main__":
    main()
