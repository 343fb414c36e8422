"""nginx with deploy/nginx.conf as it is shipped; only addresses, certificate and folders are replaced."""

import os
import signal
import socket
import ssl
import subprocess
import time

SHIPPED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../deploy/nginx.conf")


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [sock.getsockname()[1] for sock in sockets]
    for sock in sockets:
        sock.close()
    return ports


class NginxProcess:
    """In front of a service at `upstream`; `port` for TLS, `plain` without; `alone`: in a session of its own."""

    def __init__(self, folder, upstream, alone=False):
        self.folder, self.upstream, self.alone, self.process = folder, upstream, alone, None
        os.makedirs(folder)

    def start(self):
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=lab.example",
                        "-addext", "subjectAltName=DNS:lab.example", "-keyout", self.folder + "/key",
                        "-out", self.folder + "/cert"], check=True, capture_output=True)
        self.context = ssl.create_default_context(cafile=self.folder + "/cert")
        for _ in range(5):
            self.plain, self.port = free_ports(2)
            self.configure()
            if self.listens():
                return self
        raise AssertionError("nginx does not start")

    def listens(self):
        """False when somebody else took a port meanwhile: any connection on this machine may."""
        self.process = subprocess.Popen(["nginx", "-p", self.folder, "-c", "main.conf", "-e", "error.log"],
                                        stderr=subprocess.DEVNULL, start_new_session=self.alone)
        deadline = time.monotonic() + 30
        while self.process.poll() is None:
            if os.path.exists(self.folder + "/pid"):  # written once it has its ports
                return True
            assert time.monotonic() < deadline, "nginx does not listen"
            time.sleep(0.05)
        return False

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=10)

    def connect(self):
        """A TLS connection to lab.example, its certificate checked."""
        return self.context.wrap_socket(socket.create_connection(("127.0.0.1", self.port), timeout=30),
                                        server_hostname="lab.example")

    def configure(self):
        with open(SHIPPED) as file:
            text = file.read()
        for shipped, here in (("server 127.0.0.1:8080;", f"server 127.0.0.1:{self.upstream};"),
                              ("listen 80;", f"listen 127.0.0.1:{self.plain};"), ("listen [::]:80;", ""),
                              ("listen 443 ssl http2;", f"listen 127.0.0.1:{self.port} ssl http2;"),
                              ("listen [::]:443 ssl http2;", ""),
                              ("/etc/ssl/certs/lab.example.pem", self.folder + "/cert"),
                              ("/etc/ssl/private/lab.example.key", self.folder + "/key")):
            assert text.count(shipped) == 1, shipped
            text = text.replace(shipped, here)
        with open(self.folder + "/site.conf", "w") as file:
            file.write(text)
        temporary = "".join(f"{kind}_temp_path {self.folder}/{kind};" for kind in
                            ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        with open(self.folder + "/main.conf", "w") as file:
            file.write(f"daemon off; worker_processes 1; pid {self.folder}/pid; events {{}} "
                       f"http {{ access_log off; {temporary} include site.conf; }}")
