"""What deploy/ ships fits the executable.

usage: deploy_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import os
import re
import shutil
import subprocess
import tempfile
import unittest

from server_test import EXECUTABLE, main, quicksand

DEPLOY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../deploy")


def shipped(name):
    with open(os.path.join(DEPLOY, name)) as file:
        return file.read()


class DeployTest(unittest.TestCase):
    def test_the_configuration_is_what_the_executable_prints(self):
        printed = quicksand("serve", "--config", os.path.join(DEPLOY, "quicksand.conf"), "--print-config")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertEqual(printed.stdout, shipped("quicksand.conf"), "regenerate it with --print-config")

    def test_its_values_are_the_defaults(self):
        default = quicksand("serve", "--cases", "/usr/share/quicksand/cases", "--state", "/var/lib/quicksand", "--print-config")
        self.assertEqual(default.stdout, shipped("quicksand.conf"))

    def test_a_wrong_configuration_is_told_by_line(self):
        with tempfile.NamedTemporaryFile("w", suffix=".conf") as file:
            file.write("workers = 0\ncolour = blue\n")
            file.flush()
            refused = quicksand("serve", "--config", file.name, "--set", "port=x", "--print-config")
        self.assertEqual(refused.returncode, 2)
        for text in ("line 1: workers = 0", "1 to 64", "line 2:", "colour", "command line: port = x"):
            self.assertIn(text, refused.stderr)

    def test_nginx_takes_as_large_a_body_as_the_service(self):
        body = re.search(r"max_body_bytes = (\d+)M", shipped("quicksand.conf"))[1]
        self.assertIn(f"client_max_body_size {body}m;", shipped("nginx.conf"))

    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is not here")
    def test_the_unit_is_valid_and_tight(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "quicksand.service")
            with open(path, "w") as file:  # the executable is not installed here
                file.write(shipped("quicksand.service").replace("/usr/bin/quicksand", EXECUTABLE))
            verified = subprocess.run(["systemd-analyze", "verify", path], capture_output=True, text=True)
            self.assertEqual((verified.returncode, verified.stderr), (0, ""))
            rated = subprocess.run(["systemd-analyze", "security", "--offline=true", "--threshold=15", path],
                                   capture_output=True, text=True)
            self.assertEqual(rated.returncode, 0, rated.stdout[-200:])  # exposure at most 1.5 of 10


if __name__ == "__main__":
    main()
