"""Numbers of the drawn scenes: each quantity's range (also the axes of the map), drawn log-uniformly and at its corners."""

import math

# quantity: (least, most, logarithmic). The table; `head` in metres of water over the scene's floor.
RANGES = {
    "permeability": (1e-14, 10, True),
    "bulk_modulus": (1e4, 1e11, True),
    "young_modulus": (1e2, 1e11, True),
    "poisson_ratio": (0, 0.499, False),
    "friction_angle": (0, 60, False),
    "dilation_angle": (-10, 60, False),
    "cohesion": (1, 1e8, True),
    "porosity": (0.02, 0.95, False),
    "grain_density": (500, 2e4, True),
    "viscosity": (1e-6, 1e4, True),
    "gravity": (1e-3, 981, True),
    "cell_size": (1e-6, 1e5, True),
    "head": (1e-2, 1e4, True),
}
CORNER = 0.12  # share of draws that are an end of the range


def draw(rng, name, low=None, high=None):
    """A number of the range, or of the part between `low` and `high`."""
    least, most, logarithmic = RANGES[name]
    least = least if low is None else low
    most = most if high is None else high
    if rng.random() < CORNER:
        return rng.choice((least, most))
    if logarithmic:
        value = math.exp(rng.uniform(math.log(least), math.log(most)))
    else:
        value = rng.uniform(least, most)
    return min(max(float(f"{value:.4g}"), least), most)  # short, so that a case can be read


def model(rng, scale):
    """A constitutive law; `scale` is the stress at the scene's floor, Pa, for what is relative to it."""
    law = rng.choice(("linear_elastic", "mohr_coulomb", "mohr_coulomb", "modified_cam_clay"))
    if law == "modified_cam_clay":
        swelling = 10 ** rng.uniform(-3, -1)
        return {"law": law, "poisson_ratio": float(f"{rng.uniform(0.05, 0.45):.3g}"),
                "compression_slope": float(f"{swelling * 10 ** rng.uniform(0.1, 1.2):.4g}"),
                "swelling_slope": float(f"{swelling:.4g}"),
                "critical_state_slope": float(f"{rng.uniform(0.5, 1.8):.3g}"),
                "over_consolidation_ratio": float(f"{10 ** rng.uniform(0, 2):.3g}")}
    made = {"law": law, "young_modulus": draw(rng, "young_modulus"), "poisson_ratio": draw(rng, "poisson_ratio")}
    if law == "linear_elastic":
        return made
    friction = draw(rng, "friction_angle")
    made["friction_angle"] = friction
    made["dilation_angle"] = rng.choice((0, friction, draw(rng, "dilation_angle", -10, max(friction, -9))))
    if rng.random() < 0.6 or friction == 0:
        made["cohesion"] = draw(rng, "cohesion")
        if rng.random() < 0.25:
            made["residual_cohesion"] = made["cohesion"] * rng.choice((0, 0.1, 0.5))
            made["softening_strain"] = float(f"{10 ** rng.uniform(-4, 1):.3g}")
    if rng.random() < 0.3:
        made["tension_cutoff"] = rng.choice((0, float(f"{scale * 10 ** rng.uniform(-3, 1):.4g}")))
        apex = made.get("cohesion", 0) / math.tan(math.radians(friction)) if friction else math.inf
        made["tension_cutoff"] = min(made["tension_cutoff"], 0.99 * apex)
    return made


def soil(rng, scale, water):
    made = {"grain_density": draw(rng, "grain_density"), "porosity": draw(rng, "porosity"),
            "model": model(rng, scale)}
    if water:
        law = rng.choice(("constant", "kozeny_carman", "kozeny_carman", "power", "ergun"))
        made["permeability"] = {"law": law}
        if law == "ergun":
            made["permeability"]["grain_size"] = float(f"{10 ** rng.uniform(-6, -1):.4g}")
        else:
            made["permeability"]["value"] = draw(rng, "permeability")
        if law == "power":
            made["permeability"]["exponent"] = float(f"{rng.uniform(-5, 20):.3g}")
    return made


def water(rng):
    return {"density": float(f"{rng.choice((1000, 10 ** rng.uniform(2, 4.3))):.4g}"),
            "bulk_modulus": "incompressible" if rng.random() < 0.15 else draw(rng, "bulk_modulus"),
            "viscosity": rng.choice((0, 1e-3, draw(rng, "viscosity")))}


def gravity(rng, dimension):
    """Downwards mostly, else none or any direction."""
    size = rng.choice((9.81, 9.81, draw(rng, "gravity")))
    lot = rng.random()
    axes = 3 if dimension == "space" else 2
    if lot < 0.08:
        return [0.0] * axes
    if dimension == "axisymmetric" or lot < 0.85:
        return [0.0, -size] + [0.0] * (axes - 2)
    way = [rng.gauss(0, 1) for _ in range(axes)]
    length = math.sqrt(sum(c * c for c in way))
    return [float(f"{size * c / length:.5g}") for c in way]
