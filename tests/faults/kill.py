"""kill -9 at random moments of mixed runs: no run lost, none shown complete that is not, every result opens, and
what goes on from a checkpoint has the frames of a run that was never disturbed, bit for bit.

usage: kill.py QUICKSAND SMALL_CASE [--kills N] [--seed S]
"""

import argparse
import copy
import hashlib
import json
import os
import random
import sys
import tempfile
import time

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../server"))

from service_process import ServiceProcess  # noqa: E402  (the folder is added above)

ENDED = ("succeeded", "failed", "canceled")


def mixed_cases(case):
    """Short, long, and one that writes all the time."""
    short, long, writing = (copy.deepcopy(case) for _ in range(3))
    long["stages"][0]["duration"] = 1.0
    writing["stages"][0]["duration"] = 0.2
    writing["output"]["frame_interval"] = 0.0005
    for name, one in (("short", short), ("long", long), ("writing", writing)):
        one["name"] = name
    return [short, long, writing]


def frames_sum(path):
    """One sum over every field of every frame."""
    total = hashlib.sha256()
    with h5py.File(path) as file:
        for name, frame in file["frames"].items():
            total.update(f"{name} {frame.attrs['time']!r}".encode())
            for field in sorted(frame):
                total.update(field.encode() + frame[field][()].tobytes())
    return total.hexdigest()


class KillTest:
    def __init__(self, options, folder):
        self.options, self.rng = options, random.Random(options.seed)
        self.server = ServiceProcess(options.quicksand, folder + "/state",
                                     ["--workers", "2", "--log-level", "warning", "--set", "checkpoint_s=1"])
        self.state = self.server.state
        with open(options.small_case) as file:
            self.cases = mixed_cases(json.load(file))
        self.submitted = {}  # id → name, of every run that the service said it has
        self.counts = {"succeeded": 0, "kills while a run computed": 0, "kills with a checkpoint": 0, "resumed": 0}

    def result(self, run_id, name="result.vtkhdf"):
        return os.path.join(self.state, "runs", run_id, name)

    def undisturbed(self):
        """Sum of the frames of each case when nothing happens."""
        sums = {}
        self.server.start()
        for case in self.cases:
            run_id = self.server.call("POST", "/v1/runs", case).json()["id"]
            run = self.server.wait_for(run_id, *ENDED, seconds=300)
            assert run["status"] == "succeeded", run
            sums[case["name"]] = frames_sum(self.result(run_id))
        return sums

    def fill_up(self):
        """A few runs are always there to be killed."""
        runs = self.server.get("/v1/service-info").json()["runs"]
        for _ in range(4 - runs["queued"] - runs["running"]):
            case = self.rng.choice(self.cases)
            answer = self.server.call("POST", "/v1/runs", case)
            assert answer.status == 201, answer.body
            self.submitted[answer.json()["id"]] = case["name"]

    def kill_and_look(self):
        self.fill_up()
        time.sleep(self.rng.uniform(0, 1.5))
        running = self.server.get("/v1/runs?status=running").json()["runs"]
        self.counts["kills while a run computed"] += len(running) > 0
        self.server.kill()
        self.open_what_is_there(running)
        self.counts["kills with a checkpoint"] += any(os.path.exists(self.result(run["id"], "checkpoint"))
                                                      for run in running)
        self.server.start()

    def open_what_is_there(self, running):
        """With the server dead: what it had told of frames can be read, complete or not."""
        for run in running:
            path = self.result(run["id"])
            if os.path.exists(path):
                frames_sum(path)
            elif run["progress"] and run["progress"]["frames"] > 0:
                path += ".part"
                frames_sum(path)
                with h5py.File(path) as file:
                    assert len(file["frames"]) >= run["progress"]["frames"], run["id"]

    def check_ended(self, sums):
        for run_id, name in list(self.submitted.items()):
            answer = self.server.get(f"/v1/runs/{run_id}")
            assert answer.status == 200, f"run {run_id} is lost"
            run = answer.json()
            if run["status"] not in ENDED:
                continue
            del self.submitted[run_id]
            with open(self.result(run_id, "run.log")) as log:
                self.counts["resumed"] += "resumed at" in log.read()
            assert run["status"] == "succeeded", run
            self.counts["succeeded"] += 1
            for result in self.server.get(f"/v1/runs/{run_id}/results").json()["results"]:
                with open(self.result(run_id, result["name"]), "rb") as file:
                    assert hashlib.sha256(file.read()).hexdigest() == result["sha256"], run_id
            assert frames_sum(self.result(run_id)) == sums[name], f"run {run_id} ({name}) has other frames"

    def run(self):
        sums = self.undisturbed()
        for _ in range(self.options.kills):
            self.kill_and_look()
            self.check_ended(sums)
        deadline = time.monotonic() + 300
        while self.submitted and time.monotonic() < deadline:
            self.check_ended(sums)
            time.sleep(0.1)
        assert not self.submitted, f"never ended: {self.submitted}"
        self.server.stop()
        print(f"{self.options.kills} kills: " + ", ".join(f"{name} {count}" for name, count in self.counts.items())
              + "; none lost, frames bit-identical")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("quicksand")
    parser.add_argument("small_case")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="quicksand-kill-") as folder:
        test = KillTest(options, folder)
        try:
            test.run()
        finally:
            if test.server.process.poll() is None:
                test.server.kill()


if __name__ == "__main__":
    main()
