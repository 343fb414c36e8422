"""The families of scenes: what lies where, and what happens. All lengths in cells until `Sketch.case` makes metres of them."""

import random

import ranges
import scale


SENSELESS = 0.02  # share of scenes whose moduli may be far below the weight and impact that they bear


class Sketch:
    """A scene on nx × ny (× nz) cells."""

    def __init__(self, rng, least=2, most=7, dimension=None):
        self.rng = rng
        self.lot = random.Random(rng.getstate()[1][0]).random()
        self.dimension = dimension or rng.choices(("plane_strain", "axisymmetric", "space"), (6, 2, 2))[0]
        self.space = self.dimension == "space"
        most = min(most, 4) if self.space else most
        self.nx, self.ny = rng.randint(least, most), rng.randint(max(3, least), most + 2)
        self.nz = rng.choice((1, 2, 3)) if self.space else 1
        self.h = float(f"{10 ** rng.uniform(-2.5, 1):.4g}")
        self.gravity = ranges.gravity(rng, self.dimension)
        self.bodies, self.soils, self.more, self.stages = [], {}, {}, []
        self.sides, self.water, self.initial = {}, None, {}
        self.axis = rng.choice((0, 0, 1, 3)) if self.dimension == "axisymmetric" else 0  # where the domain begins

    def at(self, x, y, z=0.0):
        return [(x + self.axis) * self.h, y * self.h] + ([z * self.h] if self.space else [])

    def box(self, x0, y0, x1, y1):
        return {"box": {"min": self.at(x0, y0), "max": self.at(x1, y1, self.nz)}}

    def line(self, x0, y0, x1, y1):
        return {"from": self.at(x0, y0), "to": self.at(x1, y1, self.nz)}

    def stress(self):
        """About that of the weight at the floor, Pa."""
        return max(1e4 * abs(self.gravity[1]) / 10 * self.ny * self.h, 1e-3)

    def wet(self):
        if self.water is None:
            self.water = ranges.water(self.rng)
        return self.water

    def soil(self, name="sand", **changes):
        self.soils[name] = {"changes": changes}
        return name

    def add(self, name, kind, region, soil=None, **more):
        if kind != "soil":
            self.wet()
        body = {"name": name, "kind": kind, "region": region, **more}
        if kind != "water":
            body["soil"] = soil or self.soil()
        self.bodies.append(body)

    def velocity(self, speed=None):
        """In any direction: some cells per fall of a cell."""
        g = max(sum(c * c for c in self.gravity) ** 0.5, 0.01)
        size = (g * self.h) ** 0.5 * 10 ** self.rng.uniform(-1, 1) if speed is None else speed
        size = min(size, 500)
        way = [self.rng.choice((-1, 0, 1)) if self.dimension != "axisymmetric" else 0, self.rng.choice((-1, -1, 1))]
        return [c * float(f"{size:.3g}") for c in way] + ([0.0] if self.space else [])

    def case(self, name):
        wet = self.water is not None
        soils = {}
        for key, what in self.soils.items():
            soils[key] = ranges.soil(self.rng, self.stress(), wet)
            soils[key]["model"].update(what["changes"].pop("model", {}))
            soils[key].update(what["changes"])
            if not wet:
                soils[key].pop("permeability", None)
        tilted = any(c != 0 for k, c in enumerate(self.gravity) if k != 1)
        weightless = self.gravity[1] == 0
        if soils and "stress" not in self.initial and (tilted or weightless):
            p = -self.stress()
            clay = any(s["model"]["law"] == "modified_cam_clay" for s in soils.values())
            if clay or self.rng.random() < 0.5:
                self.initial |= {"stress": "uniform", "uniform_stress": [p, p, p, 0.0] + ([0.0, 0.0] if self.space else [])}
            else:
                self.initial |= {"stress": "zero"}
        materials = {"soils": soils} | ({"water": self.water} if wet else {})
        made = {"schema": "quicksand.case/1", "name": name,
                "domain": {"dimension": self.dimension, "min": self.at(0, 0),
                           "max": self.at(self.nx, self.ny, self.nz), "cell_size": self.h},
                "gravity": self.gravity, "materials": materials, "bodies": self.bodies, **self.more}
        if self.sides:
            made["domain"]["sides"] = {k: {"kind": v} for k, v in self.sides.items()}
        if self.initial:
            made["initial"] = self.initial
        if self.lot >= SENSELESS:
            scale.stiffen(made)
        self.numerics(made, wet)
        self.times(made)
        return made

    def numerics(self, made, wet):
        rng, chosen = self.rng, made.setdefault("numerics", {})
        chosen.setdefault("points_per_cell", rng.choice((1, 2, 2, 2, 3)))
        if rng.random() < 0.3:
            chosen["kernel"] = "linear"
        if rng.random() < 0.3:
            chosen["transfer"] = "apic"
        elif rng.random() < 0.2:
            chosen["pic_rate"] = rng.choice((0, 1, 100, 1e6))
        moving = any(b["kind"] != "water" and not b.get("fixed") for b in made["bodies"])
        if moving and chosen.get("kernel") == "linear" and self.lot >= SENSELESS:
            chosen["points_per_cell"] = max(chosen["points_per_cell"], 2)  # one is refused
        if wet and made["materials"]["water"]["bulk_modulus"] != "incompressible" and rng.random() < 0.2:
            chosen["pressure"] = "explicit"
        elif wet and rng.random() < 0.2:
            chosen["pressure_tolerance"] = rng.choice((1e-12, 1e-9, 1e-3))
        if wet and rng.random() < 0.2:
            chosen["drift_time"] = rng.choice((0, 1e-6, 1, 1e6))
        if rng.random() < 0.2 and "time_step" not in chosen:
            chosen["time_step_factor"] = rng.choice((0.1, 0.5, 1))

    def times(self, made):
        """Durations of about 150 steps in all, unless the family has its own."""
        rng = self.rng
        step = scale.time_step(made, self.stress()) * made["numerics"].get("time_step_factor", 0.8) / 0.8
        step = made["numerics"].get("time_step", step)
        stages = self.stages or [{}]
        whole = step * rng.choice((1, 60, 150, 150, 300))
        made["stages"] = []
        for k, stage in enumerate(stages):
            stage = {"name": f"stage {k}", "duration": whole / len(stages), **stage}
            if rng.random() < 0.15:
                stage["damping"] = rng.choice((0.05, 0.7, 0.95))
            if self.soils and rng.random() < 0.15:
                stage["quasi_static"] = any(b["kind"] != "water" and not b.get("fixed") for b in self.bodies)
                stage["duration"] *= 10 ** rng.uniform(0, 3)
            made["stages"].append(stage)
        if any(s.get("quasi_static") for s in made["stages"]):
            made["numerics"]["quasi_static_transits"] = rng.choice((5, 20, 200))
        for load in made.get("loads", []):
            load["ramp"] = rng.choice((0, 0.3, 1)) * made["stages"][0]["duration"]
        for stage in made["stages"]:
            if "heads" in stage and rng.random() < 0.3:
                stage["heads_ramp"] = 0.5 * stage["duration"]
        total = sum(s["duration"] for s in made["stages"])
        every = total / (10 if rng.random() < 0.9 else 2000)
        made["output"] = {"frame_interval": max(every, total / 1e5), "series_interval": total / 20}


def pond(s):
    """Saturated ground under water, dry ground beside air, or ground in and above its water."""
    bed = s.rng.randint(1, s.ny - 1)
    kind = s.rng.choice(("saturated_soil", "saturated_soil", "soil"))
    s.add("bed", kind, s.box(0, 0, s.nx, bed))
    if kind == "saturated_soil" and s.rng.random() < 0.7:
        s.add("pond", "water", s.box(0, bed, s.nx, bed + s.rng.choice((0.5, 1, s.ny - bed))))


def layers(s):
    """Contrasts of 10¹⁰ in permeability and 10⁶ in stiffness."""
    s.wet()
    count = s.rng.randint(2, min(4, s.ny))
    stiff = s.rng.uniform(2, 5)
    for k in range(count):
        y0, y1 = s.ny * k // count, s.ny * (k + 1) // count
        soil = s.soil(f"layer{k}", permeability={"value": 10 ** s.rng.uniform(-11, -1)},
                      model={"law": "linear_elastic", "young_modulus": 10 ** (stiff + s.rng.uniform(0, 6)),
                             "poisson_ratio": 0.3})
        for key in ("friction_angle",):
            s.soils[soil].setdefault("only", key)
        s.add(f"layer {k}", "saturated_soil", s.box(0, y0, s.nx, y1), soil)


def loaded(s):
    """A column one or more cells wide under a load or a plate."""
    s.nx = s.rng.choice((1, 1, 2, 4))
    bed = s.ny - s.rng.choice((1, 2))
    s.add("bed", s.rng.choice(("soil", "saturated_soil")), s.box(0, 0, s.nx, bed))
    size = float(f"{s.stress() * 10 ** s.rng.uniform(-3, 0.5):.4g}")
    zero = [0.0] if s.space else []
    lot = s.rng.random()
    if lot < 0.5:
        load = {"kind": "traction", "traction": [0.0, -size] + zero}
    else:
        load = {"kind": "plate", "plate": s.line(0, bed, s.nx, bed), "rough": s.rng.random() < 0.5}
        if lot < 0.75:
            load["plate_force"] = [0.0, -size * s.nx * s.h * (s.nz * s.h if s.space else 1)] + zero
        else:
            load["plate_velocity"] = [0.0, -0.01 * s.h / 1.0] + zero
            s.more["_plate"] = True
    s.more["loads"] = [{"name": "load", "body": "bed", **load}]


def falling(s):
    """A block of soil or water in the air, perhaps over a pool, perhaps turning."""
    pool = s.rng.choice((0, 0, 1))
    if pool:
        s.add("pool", "water", s.box(0, 0, s.nx, pool))
    kind = s.rng.choice(("soil", "saturated_soil", "water"))
    more = {"velocity": s.velocity()} if s.rng.random() < 0.5 else {}
    if s.dimension != "axisymmetric" and s.rng.random() < 0.2:
        more["rotation_rate"] = float(f"{s.rng.gauss(0, 1) * (max(abs(s.gravity[1]), 0.1) / s.h) ** 0.5:.3g}")
    low = pool + s.rng.choice((0.5, 1, 1.25))
    width = s.rng.choice((1, s.nx / 2, s.nx))
    s.add("block", kind, s.box(0, low, width, s.rng.uniform(low + 0.6, s.ny)), **more)


def breaking(s):
    """A column of water or soil that collapses over a floor, round a block, out of an open side."""
    s.nx = max(s.nx, 3)
    s.add("column", s.rng.choice(("water", "soil", "saturated_soil")), s.box(0, 0, 1, s.ny - 1))
    if s.rng.random() < 0.3:
        s.add("film", "water", s.box(1, 0, s.nx, s.rng.choice((0.2, 0.5, 1))))
    elif s.rng.random() < 0.4:
        s.more["walls"] = [{"name": "block", "block": s.box(2, 0, 3, 1), "no_slip": s.rng.random() < 0.5}]
    if s.rng.random() < 0.5:
        s.sides["right"] = s.rng.choice(("open", "no_slip", "symmetry"))
    if s.rng.random() < 0.2:
        s.sides["bottom"] = s.rng.choice(("open", "no_slip"))


def chamber(s):
    """Full of water or saturated soil to the lid: no free surface. Or with air shut in, under walls."""
    lot = s.rng.random()
    if lot < 0.35:
        s.add("all", s.rng.choice(("water", "saturated_soil")), s.box(0, 0, s.nx, s.ny))
    elif lot < 0.7:
        bed = s.rng.randint(1, s.ny - 1)
        s.add("bed", "saturated_soil", s.box(0, 0, s.nx, bed))
        s.add("rest", "water", s.box(0, bed, s.nx, s.ny))
    else:  # air under a roof, water over it
        s.nx, s.ny = max(s.nx, 3), max(s.ny, 4)
        s.more["walls"] = [{"name": "roof", "line": s.line(1, 2, 2, 2)}, {"name": "wall", "line": s.line(1, 1, 1, 2)},
                           {"name": "other", "line": s.line(2, 1, 2, 2)}]
        s.add("all", "water", {"difference": [s.box(0, 0, s.nx, s.ny - 1), s.box(1, 1, 2, 2)]})
    if s.rng.random() < 0.3:
        s.initial |= {"pressure": s.rng.choice(("zero", "uniform"))}
        if s.initial["pressure"] == "uniform":
            s.initial["uniform_pressure"] = float(f"{s.stress() * s.rng.choice((0.1, 1, 10)):.4g}")


def reservoirs(s):
    """Flow through ground or under water from a head, turned round or stepped in one instant."""
    bed = s.rng.randint(1, s.ny - 1)
    fall = max(abs(s.gravity[1]), 0.1)
    s.gravity = [0.0, -fall] + ([0.0] if s.space else [])
    if s.rng.random() < 0.8:
        s.add("bed", "saturated_soil", s.box(0, 0, s.nx, bed), fixed=s.rng.random() < 0.5)
    else:
        s.add("bed", "water", s.box(0, 0, s.nx, bed))
    extreme = s.rng.random() < 0.25
    head = lambda: float(f"{ranges.draw(s.rng, 'head') if extreme else bed * s.h * s.rng.uniform(0.3, 1.6):.4g}")
    sides = [("left", s.line(0, 0, 0, bed)), ("right", s.line(s.nx, 0, s.nx, bed))]
    if s.axis == 0 and s.dimension == "axisymmetric":
        sides[0] = ("floor", s.line(0, 0, s.nx, 0))
    first = bed * s.h
    s.more["reservoirs"] = [{"name": n, "line": l, "head": first} for n, l in sides]
    s.stages = [{"heads": {sides[k % 2][0]: head()}} for k in range(s.rng.choice((1, 2, 4)))]


def gates(s):
    """Opened and shut in turn, every few steps or every step."""
    s.nx = max(s.nx, 2)
    at = s.rng.randint(1, s.nx - 1)
    s.add("left", s.rng.choice(("water", "saturated_soil", "soil")), s.box(0, 0, at, s.ny - 1))
    if s.rng.random() < 0.4:
        s.add("right", "water", s.box(at, 0, s.nx, 1))
    low = s.rng.choice((0, 1))
    s.more["gates"] = [{"name": "gate", "line": s.line(at, low, at, s.ny)}]
    if low:
        s.more["walls"] = [{"name": "sill", "line": s.line(at, 0, at, low)}]
    count = s.rng.choice((2, 4, 60))
    s.stages = [{"open_gates": ["gate"]} if k % 2 else {} for k in range(count)]


def removal(s):
    """Bodies taken away, the hole filling again."""
    low = s.rng.randint(1, s.ny - 1)
    kind = s.rng.choice(("soil", "saturated_soil"))
    s.nx = max(s.nx, 2)
    s.add("ground", kind, s.box(0, 0, s.nx, low))
    s.add("cut", kind, s.box(0, low, s.nx - 1, s.ny - 0.5), s.bodies[0]["soil"])
    s.add("beside", s.rng.choice(("water", kind)), s.box(s.nx - 1, low, s.nx, s.ny - 0.5), *(
        [s.bodies[0]["soil"]] if False else []))
    if s.bodies[-1]["kind"] == "water":
        s.bodies[-1].pop("soil", None)
    s.stages = [{}, {"remove_bodies": ["cut"]}, {}]
    if s.rng.random() < 0.3:
        s.stages = [{"remove_bodies": ["cut"]}, {"remove_bodies": ["beside"]}]


def jet(s):
    """Water that strikes a wall, ground or a pool."""
    s.nx, s.ny = max(s.nx, 3), max(s.ny, 4)
    under = s.rng.choice((None, "soil", "saturated_soil", "water"))
    if under:
        s.add("under", under, s.box(0, 0, s.nx, 1))
    s.add("jet", "water", s.box(1, 2, s.nx - 1, 3), velocity=s.velocity())
    if s.rng.random() < 0.5:
        s.sides["top"] = "open"


def slivers(s):
    """Bodies thinner than a point's spacing in places: polygons, discs, films."""
    kind = s.rng.choice(("soil", "saturated_soil", "water"))
    if s.rng.random() < 0.5:
        thin = s.rng.choice((0.3, 0.6, 1.1))
        corners = [s.at(0, 0)[:2], s.at(s.nx, 0)[:2], s.at(s.nx, thin)[:2], s.at(0, s.ny - 1)[:2]]
        s.add("wedge", kind, {"polygon": corners})
    else:
        r = min(s.nx, s.ny) / 2 * s.rng.uniform(0.7, 1)
        s.add("disc", kind, {"disc": {"center": s.at(s.nx / 2, s.ny / 2)[:2], "radius": r * s.h}})


def on_faces(s):
    """Flight without weight in steps of a sixteenth of a cell: points come to lie exactly on faces and corners."""
    s.dimension, s.space, s.axis = "plane_strain", False, 0
    s.gravity, s.h = [0.0, 0.0], 2.0 ** s.rng.randint(-6, 3)
    kind = s.rng.choice(("soil", "water", "saturated_soil"))
    s.nx = max(s.nx, 4)
    speed = 2.0 ** s.rng.randint(-3, 3)
    s.add("block", kind, s.box(0, 1, 2, s.ny), velocity=[speed, s.rng.choice((0.0, -speed))])
    if kind != "water":
        s.soils["sand"]["changes"] = {"model": {"law": "linear_elastic", "young_modulus": 1.0, "poisson_ratio": 0.2},
                                      "only": True}
        s.initial = {"stress": "zero"}
    if kind != "soil":
        s.water = {"density": 1000, "bulk_modulus": "incompressible", "viscosity": 0}
    s.more["numerics"] = {"points_per_cell": 2, "time_step": s.h / speed / 16}
    s.sides["right"] = s.rng.choice(("slip", "open", "no_slip"))


def still(s):
    """A tank at rest: hydrostatic."""
    s.gravity = [0.0, -max(abs(s.gravity[1]), 1e-3)] + ([0.0] if s.space else [])
    top = s.rng.choice((s.ny - 1, s.ny - 0.5))
    bed = s.rng.randint(0, int(top) - 1)
    if bed:
        s.add("bed", "saturated_soil", s.box(0, 0, s.nx, bed), fixed=True)  # grains may float
    s.add("tank", "water", s.box(0, bed, s.nx, top))
    s.more["_form"] = "hydrostatic"


def fall(s):
    """Free fall of a block that touches nothing."""
    s.gravity = [0.0, -max(abs(s.gravity[1]), 1e-3)] + ([0.0] if s.space else [])
    s.ny = max(s.ny, 6) + 5  # kernels reach 1½ cells
    s.add("block", s.rng.choice(("soil", "water", "saturated_soil")), s.box(0, s.ny - 4, s.nx, s.ny - 2))
    if s.water is not None:
        s.initial = {"pressure": "zero"}  # hydrostatic pressure would push it up
    if "soil" in s.bodies[0]:
        s.initial |= {"stress": "zero"}
        s.soils["sand"]["changes"] = {"model": {"law": "linear_elastic", "young_modulus": ranges.draw(s.rng, "young_modulus"),
                                                "poisson_ratio": 0.3}, "only": True}
    s.more["_form"] = "fall"


FAMILIES = (pond, pond, layers, loaded, loaded, falling, falling, breaking, breaking, chamber, reservoirs, reservoirs, gates,
            removal, jet, slivers, on_faces, still, fall)
