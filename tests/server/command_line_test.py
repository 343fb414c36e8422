"""The walk through the command line."""

import copy
import json
import os
import re
import signal
import subprocess
import time

from server_test import (EXECUTABLE, RESULT_NAMES, SMALL_CASE, ServerTest, assert_same_frames, endless_case, main,
                         quicksand, small_case)


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

    def test_a_stopped_run_can_be_resumed(self):
        case = small_case()
        case["stages"][0]["duration"] = 2.0
        path, out = os.path.join(self.folder, "long.json"), os.path.join(self.folder, "stopped")
        with open(path, "w") as file:
            json.dump(case, file)
        running = subprocess.Popen([EXECUTABLE, "run", path, "--out", out], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(0.4)
        running.send_signal(signal.SIGTERM)
        said = running.communicate(timeout=10)[0].decode()
        self.assertEqual(running.returncode, 1)
        self.assertIn("suspended", said)
        self.assertIn("--resume", said)
        self.assertEqual(quicksand("run", path, "--out", out).returncode, 3)  # it would replace that run
        other = quicksand("run", SMALL_CASE, "--out", out, "--resume")
        self.assertEqual(other.returncode, 2)
        self.assertIn("another case", other.stderr)
        done = quicksand("run", path, "--out", out, "--resume")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(os.listdir(out)), RESULT_NAMES)
        again = os.path.join(self.folder, "straight")
        self.assertEqual(quicksand("run", path, "--out", again).returncode, 0)
        assert_same_frames(self, *(os.path.join(folder, "result.vtkhdf") for folder in (out, again)))
        none = quicksand("run", path, "--out", again, "--resume")  # it has ended
        self.assertEqual(none.returncode, 2)
        self.assertIn("no checkpoint", none.stderr)

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
