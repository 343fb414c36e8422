"""API keys, their roles and whose runs are whose; pages of other sites.

usage: access_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import glob
import os
import socket
import subprocess
import urllib.request

from server_test import EXECUTABLE, ServerTest, endless_case, main, make_key, quicksand, small_case


class KeysTest(ServerTest):
    """A service on every address of this machine, with keys of two users, a reader and an admin."""

    options = ("--host", "0.0.0.0", "--workers", "1")

    @classmethod
    def setUpClass(cls):
        cls.prepare()
        cls.keys = {name: make_key(cls.state, name, role) for name, role in
                    (("anna", "submit"), ("ben", "submit"), ("watch", "read"), ("root", "admin"))}
        cls.server.start()

    def call(self, who, method, path, body=None, **headers):
        return self.server.call(method, path, body, {"Authorization": "Bearer " + self.keys[who], **headers})

    def run_of(self, who, case, **headers):
        answer = self.call(who, "POST", "/v1/runs", case, **headers)
        self.assertEqual(answer.status, 201, answer.body)
        return answer.json()["id"]

    def test_nothing_without_a_key(self):
        for headers in ({}, {"X-API-Key": "qs_00000000_00"}, {"Authorization": "Basic abc"}, {"X-API-Key": "x"},
                        {"X-API-Key": self.keys["anna"][:-1] + "g"}, {"X-API-Key": self.keys["anna"] + "0"}):
            for method, path in (("GET", "/v1/runs"), ("POST", "/v1/runs"), ("GET", "/v1/service-info"), ("GET", "/metrics")):
                answer = self.server.call(method, path, {} if method == "POST" else None, headers)
                self.assert_problem(answer, 401)
                self.assertIn("Bearer", answer.headers["WWW-Authenticate"])
        self.assertEqual(self.server.get("/healthz").status, 200)
        self.assertEqual(self.server.get("/readyz").status, 200)

    def test_a_body_without_a_key_is_not_read(self):
        head = b"POST /v1/runs HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: 4000000\r\n\r\n"
        self.assertEqual(self.server.raw(head, timeout=3)[0], 401)

    def test_both_headers_carry_a_key(self):
        for headers in ({"X-API-Key": self.keys["anna"]}, {"Authorization": "bearer " + self.keys["anna"]}):
            self.assertEqual(self.server.call("GET", "/v1/runs", headers=headers).status, 200)

    def test_runs_belong_to_their_key(self):
        mine = self.run_of("anna", small_case())
        self.assertEqual(self.call("anna", "GET", f"/v1/runs/{mine}").json()["owner"], "anna")
        for part in ("", "/case", "/log", "/events", "/results", "/series", "/frames/0", "/results/run.json"):
            self.assert_problem(self.call("ben", "GET", f"/v1/runs/{mine}{part}"), 404)
        self.assert_problem(self.call("ben", "POST", f"/v1/runs/{mine}/cancel"), 404)
        self.assert_problem(self.call("ben", "DELETE", f"/v1/runs/{mine}"), 404)
        for who, sees in (("anna", True), ("ben", False), ("watch", True), ("root", True)):
            runs = [run["id"] for run in self.call(who, "GET", "/v1/runs").json()["runs"]]
            self.assertEqual(mine in runs, sees, who)

    def test_idempotency_keys_are_each_users_own(self):
        ids = {self.run_of(who, small_case(), **{"Idempotency-Key": "night"}) for who in ("anna", "ben", "anna")}
        self.assertEqual(len(ids), 2)

    def test_roles(self):
        mine = self.run_of("anna", endless_case())
        self.assert_problem(self.call("watch", "POST", "/v1/runs", small_case()), 403)
        self.assert_problem(self.call("watch", "POST", f"/v1/runs/{mine}/cancel"), 403)
        self.assert_problem(self.call("anna", "GET", "/metrics"), 403)
        self.assertEqual(self.call("watch", "GET", "/metrics").status, 200)
        self.assertEqual(self.call("root", "POST", f"/v1/runs/{mine}/cancel").status, 200)

    def test_a_revoked_key_ends_at_once(self):
        key = make_key(self.state, "guest", "submit")
        headers = {"X-API-Key": key}
        self.assertEqual(self.server.call("GET", "/v1/runs", headers=headers).status, 200)
        key_id = key.split("_")[1]
        self.assertEqual(quicksand("keys", "--state", self.state, "revoke", key_id).returncode, 0)
        self.assert_problem(self.server.call("GET", "/v1/runs", headers=headers), 401)
        listed = quicksand("keys", "--state", self.state, "list").stdout
        self.assertRegex(listed, rf"(?m)^{key_id}  submit .* guest  revoked ")
        self.assertEqual(quicksand("keys", "--state", self.state, "revoke", "nobody").returncode, 1)

    def test_no_secret_is_stored_or_listed(self):
        listed = quicksand("keys", "--state", self.state, "list").stdout
        stored = b""
        for path in glob.glob(self.state + "/quicksand.db*"):
            with open(path, "rb") as file:
                stored += file.read()
        for key in self.keys.values():
            self.assertIn(key.split("_")[1], listed)
            self.assertNotIn(key.split("_")[2], listed)
            self.assertNotIn(key.split("_")[2].encode(), stored)

    def test_the_command_line_has_its_key_from_the_environment(self):
        url = {"QUICKSAND_URL": f"http://127.0.0.1:{self.server.address.port}"}
        asked = quicksand("status", env={**os.environ, **url, "QUICKSAND_KEY": self.keys["anna"]})
        self.assertEqual(asked.returncode, 0, asked.stderr)
        refused = quicksand("status", env={**os.environ, **url})
        self.assertEqual(refused.returncode, 1)
        self.assertIn("API key", refused.stderr)

    def test_the_state_is_for_its_user_alone(self):
        for name in ("quicksand.db", "lock", "server.json", "runs"):
            self.assertEqual(os.stat(os.path.join(self.state, name)).st_mode & 0o077, 0, name)


class FirstKeyTest(ServerTest):
    """From a service for everybody on this machine to one with keys."""

    def test_the_first_key_closes_the_service(self):
        self.assertEqual(self.server.get("/v1/runs").status, 200)
        run_id = self.finished(small_case())
        key = make_key(self.state, "root", "admin")
        self.assert_problem(self.server.get("/v1/runs"), 401)
        self.assertEqual(self.server.get(f"/v1/runs/{run_id}", X_API_Key=key).json()["owner"], None)
        quicksand("keys", "--state", self.state, "revoke", key.split("_")[1])
        self.assert_problem(self.server.get("/v1/runs"), 401)  # and revoking the last one does not open it

    def test_other_addresses_need_a_key(self):
        refused = quicksand("serve", "--host", "0.0.0.0", "--port", "0", "--state", self.state + "-2")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("keys create", refused.stderr)


class InheritedSocketTest(ServerTest):
    """Listening sockets that a service manager hands over."""

    @classmethod
    def setUpClass(cls):
        cls.prepare()

    def serve(self, sock):
        """The server's first line. It gets `sock` as descriptor 3, as sd_listen_fds(3) says."""
        def hand_over():
            os.dup2(sock.fileno(), 3)
        run = f"LISTEN_PID=$$ LISTEN_FDS=1 exec {EXECUTABLE} serve --state {self.state}"
        process = subprocess.Popen(["sh", "-c", run], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                   pass_fds=[3], preexec_fn=hand_over)
        self.server.process = process
        return process.stdout.readline()

    def tearDown(self):
        self.server.kill()

    def test_a_port(self):
        with socket.create_server(("127.0.0.1", 0)) as sock:
            port = sock.getsockname()[1]
            self.assertIn(f"http://127.0.0.1:{port}", self.serve(sock))
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz") as answer:
                self.assertEqual(answer.status, 200)

    def test_a_socket_in_the_file_system(self):
        path = os.path.join(self.folder, "socket")
        with socket.socket(socket.AF_UNIX) as sock:
            sock.bind(path)
            sock.listen()
            self.assertIn("http+unix://", self.serve(sock))
            for host, status in ((b"localhost", b"200"), (b"lab.example", b"421")):
                with socket.socket(socket.AF_UNIX) as client:
                    client.connect(path)
                    client.sendall(b"GET /v1/runs HTTP/1.1\r\nHost: " + host + b"\r\n\r\n")
                    self.assertEqual(client.recv(1000).split()[1], status)


class CorsTest(ServerTest):
    """One other site may use the service, no other one."""

    options = ("--set", "cors_origin=https://lab.example")

    def preflight(self, origin, path="/v1/runs"):
        return self.server.call("OPTIONS", path, headers={"Origin": origin, "Access-Control-Request-Method": "POST"})

    def test_the_named_site(self):
        answer = self.preflight("https://lab.example")
        self.assertEqual(answer.status, 204)
        self.assertIn("POST", answer.headers["Access-Control-Allow-Methods"])
        self.assertIn("Authorization", answer.headers["Access-Control-Allow-Headers"])
        for path in ("/v1/runs", "/v1/none"):
            answer = self.server.get(path, Origin="https://lab.example")
            self.assertEqual(answer.headers["Access-Control-Allow-Origin"], "https://lab.example")
            self.assertEqual(answer.headers["Vary"], "Origin")

    def test_others(self):
        for origin in ("https://lab.example.evil", "http://lab.example", "null", ""):
            self.assert_problem(self.preflight(origin), 405)
            self.assertIsNone(self.server.get("/v1/runs", Origin=origin).headers["Access-Control-Allow-Origin"])
        self.assert_problem(self.preflight("https://lab.example", "/none"), 404)


if __name__ == "__main__":
    main()
