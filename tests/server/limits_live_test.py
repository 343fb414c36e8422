"""Limits and fairness on a running service: memory, points, time, and short runs beside long ones.

usage: limits_live_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import time

from server_test import ServerTest, endless_case, main, make_key, small_case


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


class TimeLimitAcrossRestartsTest(ServerTest):
    options = ("--set", "max_run_s=5")

    def test_what_was_computed_before_counts(self):
        run_id = self.submit(endless_case())
        self.server.wait_for(run_id, "running")
        time.sleep(3.5)
        self.server.stop()
        self.server.start()
        begin = time.monotonic()
        run = self.server.wait_for(run_id, "failed", seconds=20)
        self.assertEqual(run["failure"]["code"], "time_limit")
        self.assertLess(time.monotonic() - begin, 4.5)


class PriorityNeedsAnAdminTest(ServerTest):
    def test_above_zero(self):
        key = {"X-API-Key": make_key(self.state, "anna", "submit")}
        admin = {"X-API-Key": make_key(self.state, "root", "admin")}
        self.assert_problem(self.server.call("POST", "/v1/runs?priority=1", small_case(), key), 403)
        self.assertEqual(self.server.call("POST", "/v1/runs?priority=-1", small_case(), key).status, 201)
        self.assertEqual(self.server.call("POST", "/v1/runs?priority=1", small_case(), admin).status, 201)


if __name__ == "__main__":
    main()
