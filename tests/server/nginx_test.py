"""The service behind deploy/nginx.conf as it is shipped; only addresses and certificate are this test's own.

usage: nginx_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import contextlib
import http.client
import json
import os
import time

from nginx_process import NginxProcess
from server_test import ServerTest, endless_case, main, make_key, small_case
from service_process import Answer


class NginxTest(ServerTest):
    options = ("--workers", "1")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.key = make_key(cls.state, "anna", "admin")
        cls.nginx = NginxProcess(os.path.join(cls.folder, "nginx"), cls.server.address.port).start()

    @classmethod
    def tearDownClass(cls):
        cls.nginx.stop()
        super().tearDownClass()

    @contextlib.contextmanager
    def connection(self):
        """To lab.example, its certificate checked, by TLS to nginx."""
        connection = http.client.HTTPSConnection("lab.example", self.nginx.port, timeout=30)
        connection.sock = self.nginx.connect()
        try:
            yield connection
        finally:
            connection.close()

    def call(self, method, path, body=None, **headers):
        headers = {"X-API-Key": self.key, **({"Content-Type": "application/json"} if body else {}),
                   **{name.replace("_", "-"): value for name, value in headers.items()}}
        with self.connection() as connection:
            connection.request(method, path, body, headers, encode_chunked="Transfer-Encoding" in headers)
            response = connection.getresponse()
            return Answer(response.status, response.headers, response.read())

    def run_through(self, case):
        answer = self.call("POST", "/v1/runs", json.dumps(case))
        self.assertEqual(answer.status, 201, answer.body)
        return answer.json()["id"]

    def finished_through(self):
        run_id = self.run_through(small_case())
        run = self.call("GET", f"/v1/runs/{run_id}", Prefer="wait=30").json()
        self.assertEqual(run["status"], "succeeded")
        return run_id

    def test_tls_only(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.nginx.plain)
        connection.request("GET", "/v1/runs?limit=1", headers={"Host": "lab.example"})
        response = connection.getresponse()
        self.assertEqual((response.status, response.headers["Location"]), (308, "https://lab.example/v1/runs?limit=1"))
        connection.close()
        answer = self.call("GET", "/healthz")
        self.assertEqual(answer.status, 200)
        self.assertIn("max-age", answer.headers["Strict-Transport-Security"])
        self.assertEqual(answer.headers["X-Content-Type-Options"], "nosniff")
        self.assertEqual(answer.headers["Server"], "nginx")

    def test_ranges_and_conditions(self):
        run_id = self.finished_through()
        path = f"/v1/runs/{run_id}/results/result.vtkhdf"
        whole = self.call("GET", path)
        etag, size = whole.headers["ETag"], len(whole.body)
        part = self.call("GET", path, Range="bytes=10-99", If_Range=etag)
        self.assertEqual((part.status, part.body), (206, whole.body[10:100]))
        self.assertEqual(part.headers["Content-Range"], f"bytes 10-99/{size}")
        self.assertEqual(self.call("GET", path, Range="bytes=10-99", If_Range='"other"').body, whole.body)
        self.assertEqual(self.call("GET", path, If_None_Match=etag).status, 304)
        for other in ("lines=1-2", "bytes=a-b"):  # to be ignored (RFC 9110, 14.2)
            self.assertEqual(self.call("GET", path, Range=other).body, whole.body)
        past = self.call("GET", path, Range=f"bytes={size}-")
        self.assertEqual((past.status, past.headers["Content-Range"]), (416, f"bytes */{size}"))
        head = self.call("HEAD", path)
        self.assertEqual((head.status, head.headers["Content-Length"], head.body), (200, str(size), b""))

    def test_events_come_when_they_happen(self):
        run_id = self.run_through(endless_case())
        with self.connection() as connection:
            connection.request("GET", f"/v1/runs/{run_id}/events", headers={"X-API-Key": self.key})
            response = connection.getresponse()
            self.assertEqual(response.headers["Content-Type"], "text/event-stream")
            begin = time.monotonic()
            ids = []
            while len(ids) < 4:  # some every second
                line = response.readline().decode()
                if line.startswith("id: "):
                    ids.append(int(line[4:]))
            self.assertLess(time.monotonic() - begin, 12)  # no heartbeat has pushed them out
            self.assertEqual(ids, sorted(ids))
        self.assertEqual(self.call("POST", f"/v1/runs/{run_id}/cancel").status, 200)

    def test_bodies(self):
        pieces = iter([json.dumps(small_case()).encode()])
        chunked = self.call("POST", "/v1/validate", pieces, Transfer_Encoding="chunked")
        self.assertEqual(chunked.status, 200)  # nginx reads it whole and tells its length
        large = self.call("POST", "/v1/validate", b" " * (4 << 20) + b"xx")
        self.assert_problem(large, 413)

    def test_many_changes_are_slowed_down(self):
        with self.connection() as connection:
            statuses, deadline = [], time.monotonic() + 60
            while 429 not in statuses:  # sooner or later, as long as the machine does more than the 10 a second
                self.assertLess(time.monotonic(), deadline)
                connection.request("POST", "/v1/runs/0/cancel", headers={"X-API-Key": self.key})
                response = connection.getresponse()
                body = response.read()
                statuses.append(response.status)
        self.assertEqual(set(statuses), {404, 429})
        self.assertGreater(len(statuses), 40)
        self.assertEqual(json.loads(body)["status"], 429)
        self.assertTrue(int(response.headers["Retry-After"]) > 0)
        self.assertEqual(self.call("GET", "/v1/runs").status, 200)  # looking is not slowed down
        time.sleep(2)  # for the other tests

    def test_a_stranger_needs_a_key(self):
        self.assert_problem(self.call("GET", "/v1/runs", X_API_Key="none"), 401)

    def slowest_of(self, count):
        slowest = 0
        for _ in range(count):
            begin = time.monotonic()
            self.assertEqual(self.call("GET", "/healthz").status, 200)
            slowest = max(slowest, time.monotonic() - begin)
        return slowest

    def test_slow_clients_do_not_reach_the_service(self):
        alone = self.slowest_of(20)  # what the machine itself makes of it just now
        slow = []
        for k in range(40):
            sock = self.nginx.connect()
            sock.sendall(b"POST /v1/runs HTTP/1.1\r\nHost: lab.example\r\nContent-Type: application/json\r\n"
                         + (b"Content-Length: 1000\r\n\r\n{" if k % 2 else b""))
            slow.append(sock)
        slowest = min(self.slowest_of(20) for _ in range(3))  # other programs may take the machine now and then
        for sock in slow:
            sock.close()
        print(f"/healthz beside 40 slow clients: at most {slowest * 1000:.0f} ms, without them {alone * 1000:.0f} ms", flush=True)
        self.assertLess(slowest, max(0.1, 2 * alone))

    def test_z_a_service_that_is_down(self):
        """The last one: it stays down."""
        self.server.stop()
        answer = self.call("GET", "/v1/runs")
        self.assert_problem(answer, 503)
        self.assertTrue(int(answer.headers["Retry-After"]) > 0)


if __name__ == "__main__":
    main()
