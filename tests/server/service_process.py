"""A quicksand server process and plain HTTP towards it, for the tests of the service."""

import contextlib
import http.client
import json
import os
import signal
import socket
import subprocess
import time
import urllib.parse


class Answer:
    """Status, headers and body of one response."""

    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body)


class ServiceProcess:
    """`quicksand serve` in a state folder; `start` returns when it answers."""

    def __init__(self, executable, state, options=()):
        self.executable, self.state, self.options = executable, state, list(options)
        self.process = None
        self.url = None
        self.log_folder = os.path.dirname(state)
        self.environment = {}  # besides this process's own
        self.equal = ["--set", "niceness=0"]  # a test that waits for a run would wait for the tests beside it
        self.alone = False  # in a session of its own, as services are; the kernel shares processors out between sessions

    def start(self):
        log = open(os.path.join(self.log_folder, "server.log"), "a")
        self.process = subprocess.Popen(
            [self.executable, "serve", "--port", "auto", "--state", self.state, *self.equal, *self.options],
            stdout=subprocess.PIPE, stderr=log, text=True, env={**os.environ, **self.environment},
            start_new_session=self.alone)
        log.close()
        line = self.process.stdout.readline()
        assert " serves http" in line, f"no address on the first line: {line!r}"
        self.url = line.split()[2]
        self.address = urllib.parse.urlsplit(self.url)
        return self

    def kill(self):
        """kill -9: no chance to tidy up."""
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def stop(self):
        """Seconds that an orderly stop took."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(timeout=30)
        self.process.stdout.close()
        assert status == 0, f"exit status {status}"
        return time.monotonic() - begin

    def call(self, method, path, body=None, headers=None, timeout=60):
        connection = http.client.HTTPConnection(self.address.hostname, self.address.port, timeout=timeout)
        headers = dict(headers or {})
        if body is not None:
            headers.setdefault("Content-Type", "application/json")
            if not isinstance(body, (str, bytes)):
                body = json.dumps(body)
        connection.request(method, path, body, headers)
        response = connection.getresponse()
        answer = Answer(response.status, response.headers, response.read())
        connection.close()
        return answer

    def get(self, path, **headers):
        return self.call("GET", path, headers={k.replace("_", "-"): v for k, v in headers.items()})

    @contextlib.contextmanager
    def open(self, path, headers=None, timeout=60):
        """The response as a stream; closed at the end of the block, read or not."""
        connection = http.client.HTTPConnection(self.address.hostname, self.address.port, timeout=timeout)
        connection.request("GET", path, headers=headers or {})
        response = connection.getresponse()
        try:
            yield response
        finally:
            response.close()
            connection.close()

    def raw(self, request, timeout=20):
        """Sends bytes as they are; the whole answer as (status, header text, body), status 0 for none."""
        with socket.create_connection((self.address.hostname, self.address.port), timeout=timeout) as sock:
            data = b""
            try:
                sock.sendall(request)
            except (BrokenPipeError, ConnectionResetError):
                pass  # refused while still sending
            try:
                while piece := sock.recv(1 << 16):
                    data += piece
            except ConnectionResetError:
                pass
        head, _, body = data.partition(b"\r\n\r\n")
        status = int(head.split()[1]) if head.startswith(b"HTTP/") else 0
        return status, head.decode("latin-1"), body

    def wait_for(self, run_id, *states, seconds=180):
        """The run once it is in one of `states`."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            run = self.get(f"/v1/runs/{run_id}").json()
            if run["status"] in states:
                return run
            time.sleep(0.02)
        raise AssertionError(f"run is {run['status']}, not {states}, after {seconds} s")
