#!/usr/bin/env python3
"""Draws scene number K of a seed: a case, what is expected of it, and the numbers by which the map places it.

    draw.py --seed 1 --only 17        prints the case (quicksand run takes it)
"""

import argparse
import json
import math
import random

import ranges
import scale
import scenes


def tidy(case):
    """What the families leave to be put right once the whole case is known."""
    expected = {"form": case.pop("_form", ""), "twin": None}
    plate = case.pop("_plate", False)
    for soil in case["materials"].get("soils", {}).values():
        model = soil["model"]
        soil.pop("only", None)
        if model["law"] == "linear_elastic":
            soil["model"] = {k: model[k] for k in ("law", "young_modulus", "poisson_ratio")}
        if "permeability" in soil and "law" not in soil["permeability"]:
            soil["permeability"]["law"] = "kozeny_carman"
    case["initial"] = {k: v for k, v in case.get("initial", {}).items()
                       if not (k == "pressure" or k == "uniform_pressure") or "water" in case["materials"]}
    if not case["initial"]:
        case.pop("initial")
    if plate:
        speed = 0.02 * case["domain"]["max"][1] / sum(s["duration"] for s in case["stages"])
        case["loads"][0]["plate_velocity"][1] = -min(speed, 900)
    for stage in case["stages"]:
        if stage.get("quasi_static") is False:
            stage.pop("quasi_static")
    if not any(s.get("quasi_static") for s in case["stages"]):
        case["numerics"].pop("quasi_static_transits", None)
    if expected["form"]:
        for stage in case["stages"]:
            stage.pop("damping", None), stage.pop("quasi_static", None)
        case["numerics"].pop("quasi_static_transits", None)
    return expected


def draw(seed, number):
    rng = random.Random(f"{seed}/{number}")
    family = rng.choice(scenes.FAMILIES)
    sketch = scenes.Sketch(rng)
    family(sketch)
    case = sketch.case(f"extremes {seed}/{number} {family.__name__}")
    expected = tidy(case)
    expected["family"] = family.__name__
    expected["threads"] = rng.random() < 0.1
    # Other scales: the same scene in micrometres or in cells of 100 km.
    other_scale = scale.possible(rng, case) if rng.random() < 0.25 else None
    if other_scale:
        length, time = other_scale
        other = scale.similar(case, length, time)
        if rng.random() < 0.6:
            expected["twin"] = {"case": other, "length": length, "time": time}
        else:
            case = other
    return {"id": f"{seed}/{number}", "case": case, "expected": expected, "place": place(case)}


def place(case):
    """Where the map puts the scene: the first soil's numbers."""
    soils = list(case["materials"].get("soils", {}).values())
    soil = soils[0] if soils else {}
    model, water = soil.get("model", {}), case["materials"].get("water", {})
    stiff = water.get("bulk_modulus", 2.2e9)
    heads = [r["head"] for r in case.get("reservoirs", [])]
    for stage in case["stages"]:
        heads += stage.get("heads", {}).values()
    found = {"permeability": soil.get("permeability", {}).get("value"), "young_modulus": model.get("young_modulus"),
             "bulk_modulus": (1e12 if stiff == "incompressible" else stiff) if water else None,
             "poisson_ratio": model.get("poisson_ratio"), "friction_angle": model.get("friction_angle"),
             "cohesion": model.get("cohesion"), "porosity": soil.get("porosity"),
             "grain_density": soil.get("grain_density"), "viscosity": water.get("viscosity"),
             "gravity": math.hypot(*case["gravity"]), "cell_size": case["domain"]["cell_size"],
             "head": max(heads, default=None)}
    return {k: v for k, v in found.items() if v is not None}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, required=True)
    parser.add_argument("--whole", action="store_true", help="with what is expected of it")
    parser.add_argument("--twin", action="store_true", help="the similar case beside it")
    chosen = parser.parse_args()
    drawn = draw(chosen.seed, chosen.only)
    shown = drawn if chosen.whole else drawn["expected"]["twin"]["case"] if chosen.twin else drawn["case"]
    print(json.dumps(shown, indent=1))


if __name__ == "__main__":
    main()
