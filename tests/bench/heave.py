"""The heave case with implicit and with explicit pressure: wall time and error."""
import copy
import json

import h5py
import numpy as np

from measure import TOP, whole_run

GRAVITY_DENSITY = 9.81 * 1000  # N/m³, of the case's water
# m, of the pool's level and the probe "chamber pressure": before the valve opens the water between is still.
LEVEL, PROBE = 0.22, 0.02


def shortened(case, part):
    """All stages shortened to a part of their time; frames and samples only at their ends, ten in the first."""
    case = copy.deepcopy(case)
    for stage in case["stages"]:
        stage["duration"] *= part
    case["output"]["frame_interval"] = sum(stage["duration"] for stage in case["stages"])
    case["output"]["series_interval"] = case["stages"][0]["duration"] / 10
    return case


def with_pressure(case, scheme):
    case = copy.deepcopy(case)
    case["numerics"]["pressure"] = scheme
    return case


def errors(report, folder, still_until):
    """Largest error of the chamber's pressure while all is at rest, of itself; and the ledger's."""
    with h5py.File(f"{folder.name}/out/result.vtkhdf") as file:
        series = file["series/probe.chamber pressure"]
        time, value = series["time"][()], np.ravel(series["value"][()])
    expected = GRAVITY_DENSITY * (LEVEL - PROBE)
    still = time <= still_until * (1 + 1e-9)
    return {"pressure at rest": float(np.abs(value[still] / expected - 1).max()),
            "water volume drift": report["ledger"]["water_volume_drift_max"],
            "momentum residual": report["ledger"]["momentum_residual"]}


def measure(programs, parts):
    """Each scheme over the first part of every stage (1: all of it, with the case's own output), its wall time
    carried on to the whole. `parts`: by scheme."""
    case = json.loads((TOP / "cases/heave/case.json").read_text())
    total = sum(stage["duration"] for stage in case["stages"])
    found = {}
    for scheme, part in parts.items():
        print(f"heave, {scheme} pressure, first {100 * part:g} % of every stage", flush=True)
        run = with_pressure(case if part == 1 else shortened(case, part), scheme)
        report, folder = whole_run(programs, run)
        found[scheme] = {"part": part, "seconds": report["wall_seconds"] * total / report["sim_time"],
                         "steps_per_frame": case["output"]["frame_interval"] * report["steps"] / report["sim_time"],
                         "errors": errors(report, folder, run["stages"][0]["duration"])}
    return found
