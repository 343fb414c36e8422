"""The HTTP walk of an engineer, against the real server process."""

import hashlib
import json
import os
import threading
import time

import h5py

from server_test import RESULT_NAMES, ServerTest, endless_case, main, small_case


class WalkTest(ServerTest):
    """Validate, submit, watch, download, delete."""

    def test_the_service_describes_itself(self):
        self.assertEqual(self.server.get("/healthz").json(), {"status": "ok"})
        self.assertEqual(self.server.get("/readyz").json(), {"status": "ready"})
        info = self.server.get("/v1/service-info").json()
        self.assertEqual(info["case_formats"], ["quicksand.case/1"])
        self.assertGreater(info["limits"]["max_body_bytes"], 1 << 20)
        self.assertIn("draft-07", self.server.get("/v1/schemas/case").json()["$schema"])
        self.assertIn(b"openapi: 3.1", self.server.get("/v1/openapi.yaml").body)
        with open(os.path.join(self.state, "server.json")) as file:
            self.assertEqual(json.load(file), {"url": self.server.url, "pid": self.server.process.pid})

    def test_shipped_cases_are_listed_and_can_be_validated(self):
        cases = self.server.get("/v1/cases").json()["cases"]
        for case in cases:
            text = self.server.get(case["href"]).body
            self.assertEqual(self.server.call("POST", "/v1/validate", text).status, 200, case["name"])
        self.assert_problem(self.server.get("/v1/cases/none"), 404)

    def test_validate_tells_the_plan(self):
        answer = self.server.call("POST", "/v1/validate", small_case())
        self.assertEqual(answer.status, 200, answer.body)
        self.assertIn("cell_size", answer.json())

    def test_bad_cases_never_reach_the_queue(self):
        before = len(self.server.get("/v1/runs").json()["runs"])
        two_faults = small_case()
        two_faults["colour"] = "blue"
        two_faults["domain"]["cell_size"] = -1
        for path in ("/v1/runs", "/v1/validate"):
            answer = self.server.call("POST", path, two_faults)
            self.assert_problem(answer, 422)
            pointers = {error["pointer"] for error in answer.json()["errors"]}
            self.assertLessEqual({"/colour", "/domain/cell_size"}, pointers)
            self.assertTrue(all(error["detail"] for error in answer.json()["errors"]))
            for text in ("", "{", "[]", "null", "[" * 100_000, '{"a":1,"a":2}', "\xff"):
                self.assert_problem(self.server.call("POST", path, text.encode("latin-1")), 422)
        self.assertEqual(len(self.server.get("/v1/runs").json()["runs"]), before)

    def test_submit_watch_and_download(self):
        text = json.dumps(small_case())
        answer = self.server.call("POST", "/v1/runs?label=first%20try", text)
        self.assertEqual(answer.status, 201)
        run = answer.json()
        self.assertEqual(answer.headers["Location"], f"/v1/runs/{run['id']}")
        self.assertEqual((run["name"], run["label"]), ("small column", "first try"))
        self.assertEqual(run["case_sha256"], hashlib.sha256(text.encode()).hexdigest())

        run = self.server.get(f"/v1/runs/{run['id']}", Prefer="wait=30").json()
        self.assertEqual(run["status"], "succeeded", run["failure"])
        self.assertAlmostEqual(run["progress"]["fraction"], 1, places=6)
        self.assertLess(run["created"], run["finished"])
        self.assertEqual(self.server.get(f"/v1/runs/{run['id']}/case").body, text.encode())
        log = self.server.get(f"/v1/runs/{run['id']}/log").body.decode()
        self.assertIn("ended: succeeded", log)
        self.assertTrue(all(f"run={run['id']} " in line for line in log.splitlines()), log)

        results = self.server.get(f"/v1/runs/{run['id']}/results").json()["results"]
        self.assertEqual([result["name"] for result in results], RESULT_NAMES)
        for result in results:
            body = self.server.get(result["href"]).body
            self.assertEqual(len(body), result["bytes"])
            self.assertEqual(hashlib.sha256(body).hexdigest(), result["sha256"])
        self.check_file(results[0]["href"], text, run["progress"]["frames"])

    def check_file(self, href, text, frames):
        path = os.path.join(self.folder, "downloaded.vtkhdf")
        with open(path, "wb") as file:
            file.write(self.server.get(href).body)
        with h5py.File(path) as file:
            self.assertGreaterEqual(len(file["frames"]), 5)
            self.assertEqual(len(file["frames"]), frames)
            first = file["frames/000000"]
            self.assertEqual(first["position"].shape, (first["phase"].shape[0], 3))
            self.assertEqual(set(first["phase"][()]), {0, 1})
            self.assertEqual(file["run/case"][()].decode(), text)
            for name in ("case_resolved", "plan", "units", "host", "report"):
                json.loads(file["run/" + name][()])
            self.assertRegex(file["run/engine_version"][()].decode(), r"^\d+\.\d+\.\d+$")

    def test_unknown_things_are_404(self):
        for path in ("", "/case", "/log", "/results", "/results/run.json"):
            self.assert_problem(self.server.get("/v1/runs/0123456789abcdef" + path), 404)
        self.assert_problem(self.server.call("POST", "/v1/runs/0123456789abcdef/cancel"), 404)
        self.assert_problem(self.server.call("DELETE", "/v1/runs/0123456789abcdef"), 404)
        self.assert_problem(self.server.get("/v1/nothing"), 404)

    def test_only_listed_results_can_be_read(self):
        run_id = self.finished(small_case())
        for name in ("run.log", "..%2F..%2Fquicksand.db", "%2e%2e", "result.vtkhdf.part", "%00"):
            self.assert_problem(self.server.get(f"/v1/runs/{run_id}/results/{name}"), 404)

    def test_delete_takes_record_and_files(self):
        run_id = self.finished(small_case())
        self.assertTrue(os.path.isdir(os.path.join(self.state, "runs", run_id)))
        answer = self.server.call("DELETE", f"/v1/runs/{run_id}")
        self.assertEqual((answer.status, answer.body), (204, b""))
        self.assertIsNone(answer.headers["Content-Length"])
        self.assertFalse(os.path.exists(os.path.join(self.state, "runs", run_id)))
        self.assert_problem(self.server.get(f"/v1/runs/{run_id}"), 404)

    def test_idempotency_key(self):
        first = self.submit(small_case())
        keyed = {"Idempotency-Key": "night 7"}
        a = self.server.call("POST", "/v1/runs", small_case(), keyed)
        b = self.server.call("POST", "/v1/runs", small_case(), keyed)
        self.assertEqual((a.status, b.status), (201, 201))
        self.assertEqual(a.json()["id"], b.json()["id"])
        self.assertNotEqual(a.json()["id"], first)
        other = small_case()
        other["name"] = "another"
        self.assert_problem(self.server.call("POST", "/v1/runs", other, keyed), 422)
        too_long = {"Idempotency-Key": "x" * 256}
        self.assert_problem(self.server.call("POST", "/v1/runs", small_case(), too_long), 400)

    def test_list_pages_and_filters(self):
        case = small_case()
        ids = []
        for k in range(3):
            case["name"] = f"paged {k}"
            ids.append(self.submit(case, "/v1/runs?label=paging"))
        page = self.server.get("/v1/runs?label=paging&limit=2").json()
        self.assertEqual([run["id"] for run in page["runs"]], [ids[2], ids[1]])
        page = self.server.get(f"/v1/runs?label=paging&limit=2&page_token={page['next_page_token']}").json()
        self.assertEqual([run["id"] for run in page["runs"]], [ids[0]])
        self.assertIsNone(page["next_page_token"])
        named = self.server.get("/v1/runs?name_prefix=paged%201").json()["runs"]
        self.assertEqual([run["id"] for run in named], [ids[1]])
        for run in ids:
            self.server.wait_for(run, "succeeded")
        done = self.server.get("/v1/runs?status=succeeded&label=paging").json()["runs"]
        self.assertEqual(len(done), 3)
        self.assertEqual(self.server.get("/v1/runs?created_after=2999-01-01T00:00:00Z").json()["runs"], [])
        for query in ("status=done", "limit=0", "limit=x", "limit=201", "page_token=x", "created_after=today",
                      "color=red"):
            self.assert_problem(self.server.get("/v1/runs?" + query), 400)
        self.assert_problem(self.server.call("POST", "/v1/runs?preset=draft", small_case()), 400)


class ActiveRunTest(ServerTest):
    """What can be done while a run computes. One worker: what is submitted second waits."""

    options = ("--workers", "1")

    def test_cancel_within_a_second(self):
        run_id = self.submit(endless_case())
        self.server.wait_for(run_id, "running")
        self.assert_problem(self.server.call("DELETE", f"/v1/runs/{run_id}"), 409)
        self.assertEqual(self.server.get(f"/v1/runs/{run_id}/results").json(), {"results": []})
        self.assert_problem(self.server.get(f"/v1/runs/{run_id}/results/result.vtkhdf"), 404)
        time.sleep(0.5)
        begin = time.monotonic()
        run = self.cancel(run_id)
        self.assertLess(time.monotonic() - begin, 1)
        self.assertIsNone(run["failure"])
        self.assertEqual(self.cancel(run_id)["status"], "canceled")  # again: no harm
        names = [r["name"] for r in self.server.get(f"/v1/runs/{run_id}/results").json()["results"]]
        self.assertEqual(names, RESULT_NAMES)  # what it had computed stays
        self.assertEqual(self.server.call("DELETE", f"/v1/runs/{run_id}").status, 204)

    def test_a_queued_run_is_canceled_at_once(self):
        running = self.submit(endless_case())
        self.server.wait_for(running, "running")
        queued = self.submit(small_case())
        self.assertEqual(self.server.call("POST", f"/v1/runs/{queued}/cancel").json()["status"], "canceled")
        self.cancel(running)
        self.assertIsNone(self.server.get(f"/v1/runs/{queued}").json()["started"])

    def test_long_poll(self):
        running = self.submit(endless_case())
        self.server.wait_for(running, "running")
        queued = self.submit(small_case())
        path = f"/v1/runs/{queued}"
        etag = self.server.get(path).headers["ETag"]
        self.assertTrue(etag.startswith('W/"'))
        self.assertEqual(self.server.get(path, If_None_Match=etag).status, 304)

        begin = time.monotonic()  # nothing happens to a queued run
        answer = self.server.get(path, If_None_Match=etag, Prefer="wait=1")
        self.assertEqual(answer.status, 304)
        self.assertEqual(answer.headers["Preference-Applied"], "wait=1")
        self.assertGreater(time.monotonic() - begin, 0.9)

        begin = time.monotonic()  # a running one reports
        etag = self.server.get(f"/v1/runs/{running}").headers["ETag"]
        answer = self.server.get(f"/v1/runs/{running}", If_None_Match=etag, Prefer="wait=20")
        self.assertEqual(answer.status, 200)
        self.assertLess(time.monotonic() - begin, 5)
        self.assertEqual(
            set(answer.json()["progress"]),
            {"fraction", "stage", "sim_time", "end_time", "step", "time_step", "bound", "frames", "eta_s"})

        timer = threading.Timer(0.5, self.cancel, [running])  # the end wakes who waits for it
        timer.start()
        begin = time.monotonic()
        answer = self.server.get(f"/v1/runs/{running}", Prefer="wait=20")
        self.assertEqual(answer.json()["status"], "canceled")
        self.assertLess(time.monotonic() - begin, 5)
        timer.join()
        self.server.wait_for(queued, "succeeded")

    def test_long_polls_leave_room_for_others(self):
        running = self.submit(endless_case())
        limit = self.server.get("/v1/service-info").json()["limits"]["max_waiters"]

        def hold():  # until it has had a place among those who wait
            while not self.server.get(f"/v1/runs/{running}", Prefer="wait=30").headers["Preference-Applied"]:
                time.sleep(0.05)

        polls = [threading.Thread(target=hold) for _ in range(limit)]
        for poll in polls:
            poll.start()
        deadline = time.monotonic() + 20  # when all are in, one more is answered at once
        while self.server.get(f"/v1/runs/{running}", Prefer="wait=1").headers["Preference-Applied"]:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.3)  # leaves the place it had to the poll that it kept out
        begin = time.monotonic()
        self.assertIsNone(self.server.get(f"/v1/runs/{running}", Prefer="wait=30").headers["Preference-Applied"])
        self.assertEqual(self.server.get("/healthz").status, 200)
        self.assertLess(time.monotonic() - begin, 2)
        self.cancel(running)
        for poll in polls:
            poll.join()


if __name__ == "__main__":
    main()
