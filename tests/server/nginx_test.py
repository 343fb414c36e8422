"""The service behind deploy/nginx.conf as it is shipped; only addresses and certificate are this test's own.

usage: nginx_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import contextlib
import http.client
import json
import os
import signal
import socket
import ssl
import subprocess
import time

from server_test import ServerTest, endless_case, main, make_key, small_case
from service_process import Answer

SHIPPED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../deploy/nginx.conf")


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [sock.getsockname()[1] for sock in sockets]
    for sock in sockets:
        sock.close()
    return ports


class NginxTest(ServerTest):
    options = ("--workers", "1")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.key = make_key(cls.state, "anna", "admin")
        cls.plain, cls.port = free_ports(2)
        cls.web = os.path.join(cls.folder, "nginx")
        os.makedirs(cls.web)
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=lab.example",
                        "-addext", "subjectAltName=DNS:lab.example", "-keyout", cls.web + "/key", "-out", cls.web + "/cert"],
                       check=True, capture_output=True)
        cls.configure()
        cls.nginx = subprocess.Popen(["nginx", "-p", cls.web, "-c", "main.conf", "-e", "error.log"])
        deadline = time.monotonic() + 10
        while True:
            try:
                socket.create_connection(("127.0.0.1", cls.port)).close()
                break
            except ConnectionRefusedError:
                assert time.monotonic() < deadline and cls.nginx.poll() is None, "nginx does not start"
                time.sleep(0.05)

    @classmethod
    def configure(cls):
        with open(SHIPPED) as file:
            text = file.read()
        for shipped, here in (("server 127.0.0.1:8080;", f"server 127.0.0.1:{cls.server.address.port};"),
                              ("listen 80;", f"listen 127.0.0.1:{cls.plain};"), ("listen [::]:80;", ""),
                              ("listen 443 ssl http2;", f"listen 127.0.0.1:{cls.port} ssl http2;"),
                              ("listen [::]:443 ssl http2;", ""),
                              ("/etc/ssl/certs/lab.example.pem", cls.web + "/cert"),
                              ("/etc/ssl/private/lab.example.key", cls.web + "/key")):
            assert text.count(shipped) == 1, shipped
            text = text.replace(shipped, here)
        with open(cls.web + "/site.conf", "w") as file:
            file.write(text)
        temporary = "".join(f"{kind}_temp_path {cls.web}/{kind};" for kind in
                            ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        with open(cls.web + "/main.conf", "w") as file:
            file.write(f"daemon off; worker_processes 1; pid {cls.web}/pid; events {{}} "
                       f"http {{ access_log off; {temporary} include site.conf; }}")

    @classmethod
    def tearDownClass(cls):
        cls.nginx.send_signal(signal.SIGTERM)
        cls.nginx.wait(timeout=10)
        super().tearDownClass()

    @contextlib.contextmanager
    def connection(self):
        """To lab.example, its certificate checked, by TLS to nginx."""
        context = ssl.create_default_context(cafile=self.web + "/cert")
        connection = http.client.HTTPSConnection("lab.example", self.port, timeout=30, context=context)
        connection.sock = context.wrap_socket(socket.create_connection(("127.0.0.1", self.port), timeout=30),
                                              server_hostname="lab.example")
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
        connection = http.client.HTTPConnection("127.0.0.1", self.plain)
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
            self.assertLess(time.monotonic() - begin, 5)
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
            statuses = []
            for _ in range(70):
                connection.request("POST", "/v1/runs/0/cancel", headers={"X-API-Key": self.key})
                response = connection.getresponse()
                body = response.read()
                statuses.append(response.status)
        self.assertEqual(set(statuses), {404, 429})
        self.assertEqual(json.loads(body)["status"], 429)
        self.assertTrue(int(response.headers["Retry-After"]) > 0)
        self.assertEqual(self.call("GET", "/v1/runs").status, 200)  # looking is not slowed down
        time.sleep(2)  # for the other tests

    def test_a_stranger_needs_a_key(self):
        self.assert_problem(self.call("GET", "/v1/runs", X_API_Key="none"), 401)

    def test_slow_clients_do_not_reach_the_service(self):
        context = ssl.create_default_context(cafile=self.web + "/cert")
        slow = []
        for k in range(40):
            sock = context.wrap_socket(socket.create_connection(("127.0.0.1", self.port)), server_hostname="lab.example")
            sock.sendall(b"POST /v1/runs HTTP/1.1\r\nHost: lab.example\r\nContent-Type: application/json\r\n"
                         + (b"Content-Length: 1000\r\n\r\n{" if k % 2 else b""))
            slow.append(sock)
        slowest = 0
        for _ in range(20):
            begin = time.monotonic()
            self.assertEqual(self.call("GET", "/healthz").status, 200)
            slowest = max(slowest, time.monotonic() - begin)
        for sock in slow:
            sock.close()
        print(f"/healthz beside 40 slow clients: at most {slowest * 1000:.0f} ms", flush=True)
        self.assertLess(slowest, 0.1)

    def test_z_a_service_that_is_down(self):
        """The last one: it stays down."""
        self.server.stop()
        answer = self.call("GET", "/v1/runs")
        self.assert_problem(answer, 503)
        self.assertTrue(int(answer.headers["Retry-After"]) > 0)


if __name__ == "__main__":
    main()
