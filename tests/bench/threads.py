#!/usr/bin/env python3
"""What more threads give a run, by its number of points: the figures behind `points_per_thread` of the service.

usage: threads.py QUICKSAND [--threads 1,2] [--points 500,1000,…] [--seconds S] [--rounds N]

A wet column under water in finer and finer cells, a fixed number of steps each; the number of threads alternates and
the fastest of N rounds counts, so that what else the machine does weighs little.
"""

import argparse
import json
import os
import subprocess
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))


def case_of(points):
    """The small column of the service's tests, 2.4 m² / 1000 with four points a cell, so that its cells follow."""
    with open(os.path.join(HERE, "../server/small_case.json")) as file:
        case = json.load(file)
    across = max(4, round((points / 4 / 1.5) ** 0.5 / 4) * 4)
    case["domain"] = {"max": [0.04, 0.08], "cell_size": 0.04 / across}
    case["output"] = {"frame_interval": 1000}
    case["stages"][0]["duration"] = 1000
    return case


def seconds_per_step(options, case, threads, steps, folder):
    case["numerics"] = {"max_steps": steps}
    path = os.path.join(folder, "case.json")
    with open(path, "w") as file:
        json.dump(case, file)
    subprocess.run([options.quicksand, "run", path, "--out", folder + "/out", "--overwrite", "--threads", str(threads)],
                   capture_output=True)  # ends with "max_steps"
    with open(folder + "/out/run.json") as file:
        report = json.load(file)
    assert report["steps"] == steps, report["status"]
    return sum(phase["seconds"] for phase in report["phases"]) / steps, report["point_steps"] / steps


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("quicksand")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--points", default="400,1000,2000,4000,8000,16000,32000,100000")
    parser.add_argument("--seconds", type=float, default=2, help="about, for each measurement")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    threads = [int(word) for word in options.threads.split(",")]
    print("| points | ms/step on 1 thread | " + " | ".join(f"{n} threads" for n in threads[1:]) + " |")
    print("|---|---|" + "---|" * len(threads[1:]))
    with tempfile.TemporaryDirectory() as folder:
        for wanted in map(int, options.points.split(",")):
            case = case_of(wanted)
            once, points = seconds_per_step(options, case, threads[0], 20, folder)
            steps = max(20, int(options.seconds / once))
            best = {}
            for _ in range(options.rounds):
                for n in threads:
                    measured = seconds_per_step(options, case, n, steps, folder)[0]
                    best[n] = min(best.get(n, measured), measured)
            print(f"| {points:.0f} | {best[threads[0]] * 1000:.3g} | "
                  + " | ".join(f"{best[threads[0]] / best[n]:.2f}×" for n in threads[1:]) + " |", flush=True)


if __name__ == "__main__":
    main()
