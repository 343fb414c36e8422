"""What the tests of the service share. Their command line: TEST.py QUICKSAND SMALL_CASE [unittest options]."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

from service_process import ServiceProcess

EXECUTABLE, SMALL_CASE = sys.argv[1:3]
RESULT_NAMES = ["result.vtkhdf", "result.xdmf", "run.json"]


def small_case():
    with open(SMALL_CASE) as file:
        return json.load(file)


def endless_case():
    """Computes for as long as a test may need."""
    case = small_case()
    case["stages"][0]["duration"] = 1000
    case["output"]["frame_interval"] = 0.05
    case["numerics"] = {"time_step": 1e-4}
    return case


def quicksand(*arguments, **options):
    return subprocess.run([EXECUTABLE, *arguments], capture_output=True, text=True, timeout=120, **options)


def make_key(state, name, role):
    made = quicksand("keys", "--state", state, "create", name, "--role", role)
    assert made.returncode == 0, made.stderr
    return made.stdout.strip()


class ServerTest(unittest.TestCase):
    """One server for all tests of a class."""

    options = ()

    @classmethod
    def setUpClass(cls):
        cls.prepare()
        cls.server.start()

    @classmethod
    def prepare(cls):
        """Everything but the start."""
        cls.folder = tempfile.mkdtemp(prefix="quicksand-walk-")
        cls.state = os.path.join(cls.folder, "state")
        cls.server = ServiceProcess(EXECUTABLE, cls.state, cls.options)

    @classmethod
    def tearDownClass(cls):
        if cls.server.process.poll() is None:
            cls.server.kill()
        shutil.rmtree(cls.folder)

    def submit(self, case, path="/v1/runs", **headers):
        answer = self.server.call("POST", path, case, headers)
        self.assertEqual(answer.status, 201, answer.body)
        return answer.json()["id"]

    def finished(self, case):
        run_id = self.submit(case)
        run = self.server.wait_for(run_id, "succeeded", "failed", "canceled")
        self.assertEqual(run["status"], "succeeded", run["failure"])
        return run_id

    def cancel(self, run_id):
        self.assertEqual(self.server.call("POST", f"/v1/runs/{run_id}/cancel").status, 200)
        return self.server.wait_for(run_id, "canceled")

    def assert_problem(self, answer, status):
        self.assertEqual(answer.status, status, answer.body)
        self.assertEqual(answer.headers["Content-Type"], "application/problem+json")
        self.assertEqual(answer.json()["status"], status)


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


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
