"""The ladder of a case as a run of its own kind, and cells chosen by an error or a time, over HTTP and by command.

usage: tradeoff_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import csv
import io
import json
import os
import xml.etree.ElementTree

from server_test import ServerTest, endless_case, main, quicksand, small_case


def short_case():
    case = small_case()
    case["stages"][0]["duration"] = 0.02
    case["output"]["frame_interval"] = 0.02
    case["output"]["series_interval"] = 0.005
    return case


class TradeoffTest(ServerTest):
    options = ("--workers", "1")

    def submitted(self, case, query="&budget=5"):
        answer = self.server.call("POST", "/v1/runs?kind=tradeoff" + query, case)
        self.assertEqual(answer.status, 201, answer.body)
        return answer.json()

    def test_is_submitted_followed_and_downloaded(self):
        run = self.submitted(short_case())
        self.assertEqual((run["kind"], run["budget_s"]), ("tradeoff", 5))
        self.assertGreater(run["estimated_s"], 0)
        self.assertLessEqual(run["estimated_s"], 5.5)
        run = self.server.wait_for(run["id"], "succeeded", "failed")
        self.assertEqual(run["status"], "succeeded", run["failure"])
        self.assertIn(" of ", run["progress"]["stage"])
        self.assertGreater(run["progress"]["fraction"], 0.5)
        path = f"/v1/runs/{run['id']}/results"
        names = [result["name"] for result in self.server.get(path).json()["results"]]
        self.assertEqual(sorted(names), ["run.json", "tradeoff.csv", "tradeoff.png", "tradeoff.svg"])
        table = self.server.get(path + "/tradeoff.csv")
        rows = list(csv.DictReader(io.StringIO(table.body.decode())))
        self.assertEqual(rows[0]["factor"], "as given")
        self.assertEqual({row["note"] for row in rows if row["note"].startswith("ref")}, {"reference"})
        self.assertGreaterEqual(sum(bool(row["error"]) for row in rows), 5)
        report = self.server.get(path + "/run.json").json()
        self.assertEqual((report["kind"], report["status"]), ("tradeoff", "succeeded"))
        self.assertEqual([rung["setting"] for rung in report["rungs"]], [row["setting"] for row in rows])
        picture = self.server.get(path + "/tradeoff.png")
        self.assertEqual(picture.headers["Content-Type"], "image/png")
        self.assertEqual(picture.body[:8], b"\x89PNG\r\n\x1a\n")
        xml.etree.ElementTree.fromstring(self.server.get(path + "/tradeoff.svg").body)
        self.assertIn(b"1 of ", self.server.get(f"/v1/runs/{run['id']}/log").body)
        self.assertEqual(self.server.get(f"/v1/runs/{run['id']}/series").status, 404)

    def test_leaves_what_it_has_when_it_is_cancelled(self):
        run = self.submitted(endless_case(), "")
        self.assertEqual(run["budget_s"], 600)
        self.server.wait_for(run["id"], "running")
        self.cancel(run["id"])
        names = [r["name"] for r in self.server.get(f"/v1/runs/{run['id']}/results").json()["results"]]
        self.assertIn("tradeoff.csv", names)

    def test_refuses_what_makes_no_sense(self):
        for query in ("?kind=ladder", "?budget=5", "?kind=run&budget=5", "?kind=tradeoff&budget=0",
                      "?kind=tradeoff&budget=soon"):
            self.assert_problem(self.server.call("POST", "/v1/runs" + query, short_case()), 400)

    def test_the_same_key_tells_kinds_apart(self):
        headers = {"Idempotency-Key": "ladder"}
        run = self.server.call("POST", "/v1/runs", short_case(), headers).json()
        self.assertEqual(run["kind"], "run")
        other = self.server.call("POST", "/v1/runs?kind=tradeoff", short_case(), headers)
        self.assert_problem(other, 422)

    def test_the_command_line_does_the_same(self):
        path = os.path.join(self.folder, "short.json")
        with open(path, "w") as file:
            json.dump(short_case(), file)
        sent = quicksand("submit", path, "--url", self.server.url, "--tradeoff", "--budget", "5", "--wait")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        self.assertIn("factor,setting,error", sent.stdout)
        out = os.path.join(self.folder, "ladder")
        local = quicksand("tradeoff", path, "--budget", "5", "--out", out)
        self.assertEqual(local.returncode, 0, local.stderr)
        self.assertEqual(sorted(os.listdir(out)), ["run.json", "tradeoff.csv", "tradeoff.png", "tradeoff.svg"])
        refused = quicksand("submit", path, "--url", self.server.url, "--budget", "5")
        self.assertEqual(refused.returncode, 2)


class ChosenCellsTest(ServerTest):
    options = ("--workers", "1")

    def test_the_plan_says_which_and_why(self):
        case = small_case()
        case["numerics"] = {"budget_seconds": 1000}
        plan = self.server.call("POST", "/v1/validate", case).json()
        self.assertLess(plan["cell_size"], 0.005)
        self.assertTrue(plan["reasons"][-1].startswith("Chosen: cells of"), plan["reasons"])
        errors = [preset["expected_error"] for preset in plan["presets"] if preset["fault"] is None]
        self.assertEqual(errors, sorted(errors, reverse=True))
        self.assertGreaterEqual(len(errors), 2)

    def test_the_run_uses_them(self):
        case = small_case()
        case["stages"][0]["duration"] = 0.02
        case["numerics"] = {"target_error": 0.05}
        run_id = self.finished(case)
        report = self.server.get(f"/v1/runs/{run_id}/results/run.json").json()
        self.assertGreater(report["plan"]["cell_size"], 0.005)
        self.assertLessEqual(report["plan"]["expected_error"], 0.05)

    def test_what_cannot_be_is_refused_with_the_bound(self):
        case = small_case()
        for key, value in (("target_error", 1e-6), ("budget_seconds", 1e-6)):
            case["numerics"] = {key: value}
            answer = self.server.call("POST", "/v1/runs", case)
            self.assert_problem(answer, 422)
            fault = answer.json()["errors"][0]
            self.assertEqual(fault["pointer"], "/numerics/" + key)
            self.assertIn("give", fault["detail"])

    def test_a_preset_by_command_replaces_them(self):
        case = small_case()
        case["numerics"] = {"target_error": 0.05}
        path = os.path.join(self.folder, "target.json")
        with open(path, "w") as file:
            json.dump(case, file)
        sent = quicksand("submit", path, "--url", self.server.url, "--preset", "standard", "--wait")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        stored = self.server.get(f"/v1/runs/{sent.stdout.split()[0]}/case").json()
        self.assertEqual(stored["numerics"], {"preset": "standard"})


if __name__ == "__main__":
    main()
