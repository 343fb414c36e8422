"""Downloads in parts, and those who mean no good, by raw socket."""

import hashlib
import json
import os
import socket
import subprocess
import time

from server_test import ServerTest, main, quicksand, small_case


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
        log, deadline = "", time.monotonic() + 5  # the line is written once the answer is sent
        while "run=forged" not in log and time.monotonic() < deadline:
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


if __name__ == "__main__":
    main()
