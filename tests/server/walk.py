"""The HTTP walk of an engineer, and of those who mean no good, against the real server process.

usage: walk.py QUICKSAND SMALL_CASE [unittest options]
"""

import copy
import hashlib
import json
import os
import re
import shutil
import socket
import subprocess
import tempfile
import threading
import time

import h5py
import numpy

from server_test import EXECUTABLE, RESULT_NAMES, SMALL_CASE, ServerTest, endless_case, main, quicksand, small_case
from service_process import ServiceProcess


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
        self.check_file(results[0]["href"], text)

    def check_file(self, href, text):
        path = os.path.join(self.folder, "downloaded.vtkhdf")
        with open(path, "wb") as file:
            file.write(self.server.get(href).body)
        with h5py.File(path) as file:
            self.assertGreaterEqual(len(file["frames"]), 5)
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
        self.server.wait_for(ids[2], "succeeded")
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


class DownloadTest(ServerTest):
    """Ranges and conditions on a result, by raw socket."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_id = cls().finished(small_case())
        cls.result = cls.server.get(f"/v1/runs/{cls.run_id}/results").json()["results"][0]
        cls.body = cls.server.get(cls.result["href"]).body
        cls.etag = f'"{cls.result["sha256"]}"'

    def runTest(self):
        """Only so that setUpClass can use the helpers."""

    def ask(self, *headers, method="GET"):
        lines = "".join(f"{header}\r\n" for header in headers)
        return self.server.raw(f"{method} {self.result['href']} HTTP/1.1\r\nHost: localhost\r\n{lines}\r\n".encode())

    def test_whole_and_head(self):
        status, head, body = self.ask()
        self.assertEqual((status, body), (200, self.body))
        self.assertIn(f"ETag: {self.etag}", head)
        self.assertIn("Accept-Ranges: bytes", head)
        status, head, body = self.ask(method="HEAD")
        self.assertEqual((status, body), (200, b""))
        self.assertIn(f"Content-Length: {len(self.body)}", head)

    def test_ranges(self):
        size = len(self.body)
        for text, first, last in (("0-0", 0, 0), ("10-99", 10, 99), (f"{size - 5}-", size - 5, size - 1),
                                  ("-7", size - 7, size - 1), (f"100-{size * 10}", 100, size - 1)):
            status, head, body = self.ask(f"Range: bytes={text}")
            self.assertEqual((status, body), (206, self.body[first:last + 1]), text)
            self.assertIn(f"Content-Range: bytes {first}-{last}/{size}", head)
            self.assertIn(f"Content-Length: {last - first + 1}", head)

    def test_curl_continues_what_broke_off(self):
        path = os.path.join(self.folder, "curled.vtkhdf")
        for have in (0, 1000, len(self.body) - 1):
            with open(path, "wb") as file:
                file.write(self.body[:have])
            curl = subprocess.run(["curl", "-fsS", "-C", "-", "-o", path, self.server.url + self.result["href"]],
                                  capture_output=True, text=True)
            self.assertEqual(curl.returncode, 0, curl.stderr)
            with open(path, "rb") as file:
                self.assertEqual(file.read(), self.body)

    def test_several_ranges_give_the_whole(self):
        status, _, body = self.ask("Range: bytes=0-1,5-6")
        self.assertEqual((status, body), (200, self.body))

    def test_past_the_end(self):
        for text in (f"{len(self.body)}-", "9999999999999-", "-0"):
            status, head, body = self.ask(f"Range: bytes={text}")
            self.assertEqual(status, 416, text)
            self.assertIn(f"Content-Range: bytes */{len(self.body)}", head)
            self.assertEqual(json.loads(body)["status"], 416)

    def test_conditions(self):
        status, head, body = self.ask(f"If-None-Match: {self.etag}")
        self.assertEqual((status, body), (304, b""))
        self.assertIn(f"ETag: {self.etag}", head)
        self.assertEqual(self.ask('If-None-Match: "other"')[0], 200)
        status, _, body = self.ask("Range: bytes=0-9", f"If-Range: {self.etag}")
        self.assertEqual((status, body), (206, self.body[:10]))
        for stale in ('"other"', f"W/{self.etag}", "Wed, 21 Oct 2015 07:28:00 GMT"):
            status, _, body = self.ask("Range: bytes=0-9", f"If-Range: {stale}")
            self.assertEqual((status, len(body)), (200, len(self.body)), stale)

    def test_strong_etag_means_the_same_bytes_whatever_is_accepted(self):
        for result in self.server.get(f"/v1/runs/{self.run_id}/results").json()["results"]:
            answer = self.server.get(result["href"], Accept_Encoding="gzip, br")
            self.assertIsNone(answer.headers["Content-Encoding"], result["name"])
            self.assertEqual(hashlib.sha256(answer.body).hexdigest(), result["sha256"])

    def test_ranges_do_not_touch_other_answers(self):
        answer = self.server.get("/v1/service-info", Range="bytes=0-3")
        self.assertEqual(answer.status, 200)
        self.assertEqual(answer.json()["name"], "quicksand")


class HardeningTest(ServerTest):
    """Requests that the HTTP library would accept by itself."""

    def tearDown(self):
        begin = time.monotonic()
        self.assertEqual(self.server.get("/healthz").status, 200)
        self.assertLess(time.monotonic() - begin, 1)
        self.assertEqual(self.server.get("/v1/runs").json()["runs"], [])

    def post(self, headers, body=b""):
        return self.server.raw(b"POST /v1/runs HTTP/1.1\r\nHost: localhost\r\n" + headers + b"\r\n\r\n" + body)

    def assert_refused(self, answer, *allowed):
        status, head, body = answer
        self.assertIn(status, allowed, head)
        self.assertIn("application/problem+json", head)
        self.assertEqual(json.loads(body)["status"], status)
        self.assertNotIn("EXCEPTION", head)

    def test_framing(self):
        json_type = b"Content-Type: application/json\r\n"
        chunked = b"2\r\n{}\r\n0\r\n\r\n"
        self.assert_refused(self.post(json_type + b"Transfer-Encoding: chunked", chunked), 411)
        self.assert_refused(self.post(json_type + b"Transfer-Encoding: chunked\r\nContent-Length: 2", chunked), 411)
        self.assert_refused(self.post(json_type + b"Content-Encoding: gzip\r\nContent-Length: 2", b"{}"), 415)
        self.assert_refused(self.post(json_type + b"Content-Length: 2\r\nContent-Length: 3", b"{}"), 400)
        for length in (b"abc", b"-1", b"+2", b"2, 2", b"99999999999999999999999"):
            self.assert_refused(self.post(json_type + b"Content-Length: " + length, b"{}"), 400)
        self.assert_refused(self.post(json_type[:-2]), 411)
        self.assert_refused(self.post(b"Content-Type: text/plain\r\nContent-Length: 2", b"{}"), 415)
        self.assert_refused(self.post(b"Content-Length: 2", b"{}"), 415)

    def test_too_large(self):
        huge = b"Content-Type: application/json\r\nContent-Length: 10000000000"
        begin = time.monotonic()
        self.assert_refused(self.post(huge), 413)
        self.assert_refused(self.post(huge + b"\r\nExpect: 100-continue"), 413)
        self.assertLess(time.monotonic() - begin, 2)

    def test_expect_continue(self):
        with socket.create_connection((self.server.address.hostname, self.server.address.port), timeout=10) as sock:
            sock.sendall(b"POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                         b"Content-Length: 2\r\nExpect: 100-continue\r\n\r\n")
            self.assertTrue(sock.recv(1000).startswith(b"HTTP/1.1 100 "))
            sock.sendall(b"{}")
            self.assertTrue(sock.recv(10000).startswith(b"HTTP/1.1 422 "))

    def test_headers_and_paths(self):
        self.assert_refused(self.server.raw(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nA: " + b"x" * (1 << 20) + b"\r\n\r\n"), 400, 431)
        self.assert_refused(self.server.raw(b"GET /" + b"x" * 9000 + b" HTTP/1.1\r\n\r\n"), 414)
        self.assert_refused(self.server.raw(b"nonsense\r\n\r\n"), 400)
        self.assert_refused(self.server.raw(b"GET /" + b"x" * 8000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n"), 404)
        ranges = b"0-0," * 2000
        self.assertIn(self.server.raw(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nRange: bytes=" + ranges + b"0-0\r\n\r\n")[0], (200, 416))
        self.assertIn(self.server.raw(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nRange: bytes=9-1\r\n\r\n")[0], (200, 416))
        self.assert_refused(self.server.raw(b"POST /" + b"x" * 8000 + b" HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n\r\nx"), 404)

    def test_host(self):
        self.assert_refused(self.server.raw(b"GET /v1/runs HTTP/1.1\r\n\r\n"), 400)
        self.assert_refused(self.server.raw(b"GET /v1/runs HTTP/1.1\r\nHost: localhost\r\nHost: b\r\n\r\n"), 400)
        for host in ("127.0.0.1", "localhost:8080", "[::1]:8080"):
            self.assertEqual(self.server.get("/v1/runs", Host=host).status, 200, host)
        for host in ("lab.example", "127.0.0.1.lab.example", "localhost.lab.example:80", "[::2]", "["):
            self.assert_problem(self.server.get("/v1/runs", Host=host), 421)

    def test_a_path_cannot_write_a_line_of_the_log(self):
        self.assert_problem(self.server.get("/a%0A2026-01-01T00:00:00.000Z%20info%20run=forged"), 404)
        with open(os.path.join(self.folder, "server.log")) as file:
            log = file.read()
        self.assertIn("run=forged", log)
        self.assertFalse([line for line in log.splitlines() if line.startswith("2026-01-01T00:00:00")])

    def test_security_headers_on_every_answer(self):
        for path, status in (("/healthz", 200), ("/v1/runs", 200), ("/none", 404), ("/v1/runs?x=1", 400)):
            headers = self.server.get(path).headers
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
            self.assertEqual(headers["Cross-Origin-Resource-Policy"], "same-origin")
            self.assertIsNone(headers["Access-Control-Allow-Origin"])
            self.assertIsNone(headers["Server"])

    def test_wrong_method(self):
        for method, path, allow in (("PUT", "/v1/runs", "GET, HEAD, POST"), ("DELETE", "/healthz", "GET, HEAD"),
                                    ("GET", "/v1/validate", "POST"), ("OPTIONS", "/v1/runs", "GET, HEAD, POST"),
                                    ("POST", "/v1/schemas/case", "GET, HEAD")):
            answer = self.server.call(method, path)
            self.assert_problem(answer, 405)
            self.assertEqual(answer.headers["Allow"], allow)

    def test_a_post_without_body_does_not_wait_for_one(self):
        begin = time.monotonic()
        status, _, _ = self.server.raw(b"POST /v1/runs/00/cancel HTTP/1.1\r\nHost: localhost\r\n\r\n")
        self.assertEqual(status, 404)
        self.assertLess(time.monotonic() - begin, 2)

    def test_idle_clients_do_not_block_others(self):
        address = (self.server.address.hostname, self.server.address.port)
        idle = [socket.create_connection(address) for _ in range(20)]
        for sock in idle[:10]:
            sock.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost")
        self.tearDown()
        for sock in idle:
            sock.close()

    def test_no_other_site_than_this_machine(self):
        state = os.path.join(self.folder, "other")
        refused = quicksand("serve", "--host", "0.0.0.0", "--port", "auto", "--state", state)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("127.0.0.1", refused.stderr)


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

        time.sleep(0.5)
        self.server.kill()  # the second time it is given up, and the next one gets its turn
        self.server.start()
        run = self.server.get(f"/v1/runs/{running}").json()
        self.assertEqual((run["status"], run["failure"]["code"]), ("failed", "interrupted"))
        self.assertEqual(self.server.get(f"/v1/runs/{running}/results").json(), {"results": []})
        self.assertEqual(self.server.wait_for(queued, "succeeded")["retries"], 0)

    def test_a_restarted_run_gives_the_same_frames(self):
        case = small_case()
        case["stages"][0]["duration"] = 0.5
        run_id = self.submit(case)
        self.server.wait_for(run_id, "running")
        self.server.kill()
        self.server.start()
        self.server.wait_for(run_id, "succeeded")
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


def assert_same_frames(test, first, second):
    """Bit for bit, every field of every frame."""
    with h5py.File(first) as a, h5py.File(second) as b:
        test.assertEqual(list(a["frames"]), list(b["frames"]))
        test.assertGreater(len(a["frames"]), 1)
        for frame in a["frames"]:
            test.assertEqual(set(a["frames"][frame]), set(b["frames"][frame]))
            for field in a["frames"][frame]:
                left, right = a["frames"][frame][field][()], b["frames"][frame][field][()]
                test.assertTrue(numpy.array_equal(left, right), f"{frame}/{field} differs")


class CommandLineTest(ServerTest):
    """The same through `quicksand`."""

    def client(self, *arguments):
        return quicksand(*arguments, env={**os.environ, "QUICKSAND_URL": self.server.url})

    def bad_case(self):
        case = copy.deepcopy(small_case())
        case["colour"] = "blue"
        case["domain"]["cell_size"] = -1
        path = os.path.join(self.folder, "bad.json")
        with open(path, "w") as file:
            json.dump(case, file)
        return path

    def test_check(self):
        good = quicksand("check", SMALL_CASE)
        self.assertEqual(good.returncode, 0, good.stderr)
        self.assertIn("cell_size", json.loads(good.stdout))
        bad = quicksand("check", self.bad_case())
        self.assertEqual(bad.returncode, 2)
        self.assertIn("/colour", bad.stderr)
        self.assertIn("/domain/cell_size", bad.stderr)
        self.assertEqual(quicksand("check", "/nowhere.json").returncode, 2)

    def test_run_gives_the_same_frames_as_the_service(self):
        out = os.path.join(self.folder, "here")
        here = quicksand("run", SMALL_CASE, "--out", out, "--threads", "1")
        self.assertEqual(here.returncode, 0, here.stderr)
        self.assertIn("small column: succeeded", here.stdout)
        self.assertIn("result.xdmf", here.stdout)
        self.assertEqual(sorted(os.listdir(out)), RESULT_NAMES)

        there = os.path.join(self.folder, "there")
        sent = self.client("submit", SMALL_CASE, "--label", "cli", "--wait")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        self.assertIn("small column: succeeded", sent.stdout)
        self.assertIn("100 %", sent.stderr)
        run_id = sent.stdout.split()[0]
        fetched = self.client("fetch", run_id, "--out", there)
        self.assertEqual(fetched.returncode, 0, fetched.stderr)
        self.assertEqual(sorted(os.listdir(there)), RESULT_NAMES)
        assert_same_frames(self, os.path.join(out, "result.vtkhdf"), os.path.join(there, "result.vtkhdf"))

    def test_exit_status_of_run(self):
        out = os.path.join(self.folder, "file")
        self.assertEqual(quicksand("run", self.bad_case(), "--out", out).returncode, 2)
        self.assertFalse(os.path.exists(out))
        with open(out, "w"):
            pass
        self.assertEqual(quicksand("run", SMALL_CASE, "--out", out).returncode, 3)
        self.assertEqual(quicksand("run").returncode, 2)

    def test_run_keeps_earlier_results(self):
        out = os.path.join(self.folder, "kept")
        self.assertEqual(quicksand("run", SMALL_CASE, "--out", out).returncode, 0)
        result = os.path.join(out, "result.vtkhdf")
        before = os.stat(result).st_mtime_ns
        again = quicksand("run", SMALL_CASE, "--out", out)
        self.assertEqual(again.returncode, 3)
        self.assertIn("--overwrite", again.stderr)
        self.assertEqual(os.stat(result).st_mtime_ns, before)
        self.assertEqual(quicksand("run", SMALL_CASE, "--out", out, "--overwrite").returncode, 0)
        self.assertGreater(os.stat(result).st_mtime_ns, before)
        os.rename(result, result + ".part")  # what a killed run leaves
        for name in ("result.xdmf", "run.json"):
            os.remove(os.path.join(out, name))
        self.assertEqual(quicksand("run", SMALL_CASE, "--out", out).returncode, 3)

    def test_schema(self):
        printed = quicksand("schema")
        self.assertEqual(printed.returncode, 0)
        self.assertEqual(json.loads(printed.stdout), self.server.get("/v1/schemas/case").json())

    def test_fetch_resumes_and_repairs(self):
        run_id = self.finished(small_case())
        out = os.path.join(self.folder, "resumed")
        os.makedirs(out)
        with open(os.path.join(self.state, "runs", run_id, "result.vtkhdf"), "rb") as file:
            whole = file.read()
        part = os.path.join(out, "result.vtkhdf.part")
        with open(part, "wb") as file:
            file.write(whole[:1000])
        self.assertEqual(self.client("fetch", run_id, "--out", out).returncode, 0)
        self.assertEqual(sorted(os.listdir(out)), RESULT_NAMES)
        with open(os.path.join(out, "result.vtkhdf"), "rb") as file:
            self.assertEqual(file.read(), whole)

        os.remove(os.path.join(out, "result.vtkhdf"))
        with open(part, "wb") as file:  # another file's beginning: seen by its sum, gone at the next try
            file.write(b"\0" * 1000)
        damaged = self.client("fetch", run_id, "--out", out)
        self.assertNotEqual(damaged.returncode, 0)
        self.assertIn("SHA-256", damaged.stderr)
        self.assertEqual(self.client("fetch", run_id, "--out", out).returncode, 0)

    def test_status_and_cancel(self):
        path = os.path.join(self.folder, "endless.json")
        with open(path, "w") as file:
            json.dump(endless_case(), file)
        run_id = self.client("submit", path).stdout.strip()
        self.assertRegex(run_id, re.compile("^[0-9a-f]{16}$"))
        self.server.wait_for(run_id, "running")
        self.assertIn("running", self.client("status", run_id).stdout)
        self.assertIn(run_id, self.client("status").stdout)
        self.assertEqual(self.client("fetch", run_id, "--out", self.folder).returncode, 1)
        self.assertEqual(self.client("delete", run_id).returncode, 1)  # it has not ended
        self.assertEqual(self.client("cancel", run_id).returncode, 0)
        self.server.wait_for(run_id, "canceled")
        log = self.client("log", run_id)
        self.assertEqual(log.returncode, 0)
        self.assertIn("ended: canceled", log.stdout)
        self.assertEqual(self.client("delete", run_id).returncode, 0)
        self.assertEqual(self.client("log", run_id).returncode, 1)

    def test_submit_tells_what_is_wrong(self):
        bad = self.client("submit", self.bad_case())
        self.assertEqual(bad.returncode, 2)
        self.assertIn("/colour", bad.stderr)
        self.assertIn("/domain/cell_size", bad.stderr)
        self.assertEqual(self.client("status", "0123456789abcdef").returncode, 1)
        nobody = quicksand("status", "--url", "http://127.0.0.1:9")
        self.assertEqual(nobody.returncode, 4)
        self.assertIn("no answer", nobody.stderr)

    def test_preset_is_written_into_the_case(self):
        run_id = self.client("submit", SMALL_CASE, "--preset", "draft").stdout.strip()
        case = self.server.get(f"/v1/runs/{run_id}/case").json()
        self.assertEqual(case["numerics"]["preset"], "draft")


if __name__ == "__main__":
    main()
