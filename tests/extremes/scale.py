"""Dimensionally similar cases, and the time scales of a case."""

import copy
import math

LENGTHS = ("cell_size", "min", "max", "center", "radius", "from", "to", "head", "at", "polygon", "water_table", "grain_size")
TIMES = ("duration", "ramp", "heads_ramp", "frame_interval", "series_interval", "drift_time", "time_step", "at_least")
STRESSES = ("young_modulus", "cohesion", "tension_cutoff", "residual_cohesion", "uniform_pressure", "uniform_stress",
            "traction", "bulk_modulus")


def similar(case, length, time):
    """The case with lengths and times multiplied; densities stay, so that stresses follow (length/time)²."""
    made = copy.deepcopy(case)
    power = {**dict.fromkeys(LENGTHS, length), **dict.fromkeys(TIMES, time),
             **dict.fromkeys(STRESSES, (length / time) ** 2), "gravity": length / time**2,
             "velocity": length / time, "plate_velocity": length / time, "speed": length / time,
             "rotation_rate": 1 / time, "pic_rate": 1 / time, "viscosity": length**2 / time,
             "heads": length}
    axes = 3 if case["domain"].get("dimension") == "space" else 2
    force = (length / time) ** 2 * length ** (axes - 1)
    if case["domain"].get("dimension") == "axisymmetric":
        force *= length
    power["plate_force"] = force

    def times(value, factor):
        if isinstance(value, list):
            return [times(v, factor) for v in value]
        if isinstance(value, dict):
            return {k: times(v, factor) for k, v in value.items()}
        return value * factor if isinstance(value, (int, float)) and not isinstance(value, bool) else value

    def walk(part):
        for key, value in part.items() if isinstance(part, dict) else enumerate(part):
            if key in power and not (key == "velocity" and not isinstance(value, list)):
                part[key] = times(value, power[key])
            elif isinstance(value, (dict, list)):
                walk(value)

    for soil in made["materials"].get("soils", {}).values():
        if "value" in soil.get("permeability", {}):
            soil["permeability"]["value"] *= time  # drag is ρ g/k with standard gravity, whatever the scene's is
    made.setdefault("gravity", [0.0, -9.81] + [0.0] * (axes - 2))
    numerics = made.setdefault("numerics", {})
    if numerics.get("transfer", "flip") == "flip":
        numerics.setdefault("pic_rate", 5)
    if any(b["kind"] != "soil" for b in made["bodies"]):
        numerics.setdefault("drift_time", 0.05)
        made["materials"].setdefault("water", {}).setdefault("viscosity", 1e-3)
        made["materials"]["water"].setdefault("bulk_modulus", 2.2e9)
    walk(made)
    return made


# Bounds of the case format on what `similar` multiplies.
LIMITS = {"stress": {"young_modulus": (1, 1e13), "bulk_modulus": (1e3, 1e12), "cohesion": (0, 1e12), "traction": (0, 1e12)},
          "rate": {"pic_rate": (0, 1e6), "rotation_rate": (0, 1e6)},
          "time": {"value": (1e-14, 10), "drift_time": (0, 1e6)},
          "speed": {"velocity": (0, 1e3), "plate_velocity": (0, 1e3)},
          "gravity": {"gravity": (0, 1e4)}, "viscosity": {"viscosity": (0, 1e4)},
          "force": {"plate_force": (0, 1e12)}, "interval": {"frame_interval": (0, 1e10), "series_interval": (0, 1e10)},
          "length": {"cell_size": (9e-7, 1.1e5), "grain_size": (1e-7, 1), "max": (0, 1e7), "head": (0, 1e7)}}


def numbers(value):
    for v in value if isinstance(value, list) else [value]:
        if isinstance(v, (int, float)) and not isinstance(v, bool) and v != 0:
            yield abs(v)


def possible(rng, case):
    """Factors of length and time that keep every number of the case within the format, or none."""
    found = []
    axes = 1 if case["domain"].get("dimension") == "plane_strain" else 2

    def walk(part):
        for key, value in part.items() if isinstance(part, dict) else enumerate(part):
            for kind, keys in LIMITS.items():
                if key in keys:
                    found.extend((kind, *keys[key], v) for v in numbers(value))
            if isinstance(value, (dict, list)):
                walk(value)

    walk(case)
    found.append(("rate", 0, 1e6, 5))  # pic_rate's default
    for _ in range(20):
        # Powers of two change no rounding: what differs then is a constant in the engine that should scale.
        length = 2.0 ** round(math.log2(10 ** rng.uniform(-6, 5) / case["domain"]["cell_size"]))
        speed = 2.0 ** round(math.log2(math.sqrt(length)) + rng.uniform(-6, 6))
        factor = {"stress": speed**2, "speed": speed, "gravity": speed**2 / length, "viscosity": speed * length,
                  "length": length, "rate": speed / length, "time": length / speed, "interval": length / speed,
                  "force": speed**2 * length ** axes}
        if all(low <= factor[kind] * v <= high for kind, low, high, v in found):
            return length, length / speed
    return None


def density(case):
    """Of the heaviest body, kg/m³."""
    soils, water = case["materials"].get("soils", {}), case["materials"].get("water", {}).get("density", 1000)
    heaviest = 0
    for body in case["bodies"]:
        soil = soils.get(body.get("soil"))
        dry = (1 - soil["porosity"]) * soil["grain_density"] if soil else 0
        pores = soil["porosity"] if soil else 1
        heaviest = max(heaviest, dry + (pores * water if body["kind"] != "soil" else 0))
    return heaviest


MARGIN = 5  # a strain of a fifth


def stiffen(case):
    """Raises moduli below what weight (over the whole scene: things fall), heads, loads and speeds ask for."""
    low, high = case["domain"]["min"], case["domain"]["max"]
    fall = sum(abs(g) * (b - a) for g, a, b in zip(case["gravity"], low, high))
    rho, g = density(case), math.hypot(*case["gravity"])
    speed = max(math.hypot(*b.get("velocity", [0])) + abs(b.get("rotation_rate", 0)) * max(high) for b in case["bodies"])
    load = 0
    for one in case.get("loads", []):
        load += math.hypot(*one.get("traction", [0]))
        if "plate_force" in one:
            wide = one["plate"]["to"][0] - one["plate"]["from"][0]
            load += math.hypot(*one["plate_force"]) / wide / max(1e-300, high[2] - low[2] if len(high) > 2 else 1)
    given = max([abs(c) for c in case.get("initial", {}).get("uniform_stress", [0])])
    least = MARGIN * (rho * (fall + speed**2) + load + given)
    for soil in case["materials"].get("soils", {}).values():
        if "young_modulus" in soil["model"]:
            soil["model"]["young_modulus"] = max(soil["model"]["young_modulus"], float(f"{least:.4g}"))
    water = case["materials"].get("water", {})
    if isinstance(water.get("bulk_modulus"), (int, float)):
        heads = [r["head"] for r in case.get("reservoirs", [])]
        heads += [h for stage in case.get("stages", []) for h in stage.get("heads", {}).values()]
        head = water["density"] * g * (max(heads, default=0) - low[1])
        pressure = abs(case.get("initial", {}).get("uniform_pressure", 0))
        water["bulk_modulus"] = max(water["bulk_modulus"], float(f"{max(least, MARGIN * head, MARGIN * pressure):.4g}"))


def modulus(model, stress, porosity):
    """Constrained modulus at the start, Pa."""
    nu = model["poisson_ratio"]
    if model["law"] == "modified_cam_clay":
        bulk = stress / ((1 - porosity) * model["swelling_slope"])
        return 3 * bulk * (1 - nu) / (1 + nu)
    return model["young_modulus"] * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


def time_step(case, stress):
    """About the step that the engine will take, s, as far as it is known before; for choosing durations."""
    h = case["domain"]["cell_size"]
    axes = 3 if case["domain"].get("dimension") == "space" else 2
    g = math.hypot(*case.get("gravity", [0.0, -9.81]))
    bounds = []
    wet = any(b["kind"] != "soil" for b in case["bodies"])
    water = case["materials"].get("water", {})
    rho = water.get("density", 1000)
    explicit = case.get("numerics", {}).get("pressure") == "explicit"
    for soil in case["materials"].get("soils", {}).values():
        n, dry = soil["porosity"], (1 - soil["porosity"]) * soil["grain_density"]
        stiff = modulus(soil["model"], stress, n)
        bounds.append(h / math.sqrt(stiff / dry))
        if explicit and isinstance(water.get("bulk_modulus"), (int, float)):
            q = water["bulk_modulus"] / n
            bounds.append(h / math.sqrt((stiff + q) / min(dry, n * rho)) / math.sqrt(2 * axes))
    if wet:
        if g > 0:
            bounds.append(math.sqrt(h / g))
        if water.get("viscosity", 0) > 0:
            bounds.append(h * h * rho / (2 * axes * water["viscosity"]))
        if explicit:
            bounds.append(h / math.sqrt(water["bulk_modulus"] / rho) / math.sqrt(2 * axes))
    for body in case["bodies"]:
        speed = math.hypot(*body.get("velocity", [0, 0]))
        if speed > 0:
            bounds.append(0.5 * h / speed)
    return 0.8 * min(bounds, default=0.1)
