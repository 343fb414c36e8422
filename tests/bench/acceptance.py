"""What is asked of speed and memory, each figure as one line: asked, measured, met or not."""
import dataclasses

import heave
import measure

FEWEST_STEPS = 200  # of a whole run: its first good state and first touches of memory count as in a short run, not more


@dataclasses.dataclass
class Verdict:
    line: int
    what: str
    asked: str
    measured: str
    met: bool

    def text(self):
        return f"{self.line}  {self.what}: asked {self.asked} / measured {self.measured} / " + \
            ("met" if self.met else "NOT met")


def millions(value):
    return f"{value / 1e6:.3g} M/s"


@dataclasses.dataclass
class Sizes:
    """What a quick and a full measurement take."""
    plane: list        # points of line 1 in the plane
    space: int         # and in space
    flat: list         # points of line 2
    cells: list        # cells across of line 2
    memory: int        # points of line 3 and of the table of kinds
    heave: dict        # part of the stages by scheme of pressure
    # What is held to a few per cent takes at least so many, as a machine that others share swings by a fifth.
    turns: int         # of line 2
    pairs: int         # of lines 4 and 5


QUICK = Sizes([100000], 100000, [10000, 100000], [32, 64, 128], 100000,
              {"implicit": 1 / 100, "explicit": 1 / 4000}, 3, 3)
FULL = Sizes([100000, 1000000], 1000000, [10000, 100000, 1000000, 4000000], [32, 64, 128, 256, 512, 1024], 1000000,
             {"implicit": 1, "explicit": 1 / 200}, 7, 11)


def step_name(scene, points, threads=1):
    return f"step/{scene}/points:{points}/threads:{threads}"


def run_name(scene, points, threads=1):
    return f"run/{scene}/points:{points}/threads:{threads}"


class Acceptance:
    """Measures what the lines need; lines share what is measured."""

    def __init__(self, programs, measured, sizes, repetitions):
        self.programs, self.measured, self.sizes, self.repetitions = programs, measured, sizes, repetitions
        self.heave_ = None

    def heave(self):
        if self.heave_ is None:
            self.heave_ = heave.measure(self.programs, self.sizes.heave)
        return self.heave_

    def need(self, prefix, repetitions=None):
        if not any(f"{name}/".startswith(prefix) for name in self.measured.rows):
            self.measured.run(prefix, repetitions)

    def whole_runs(self, scene, points):
        """Runs of the executable, on one core and on two in turns → rows run/<scene>/points:<n>/threads:<t>."""
        if run_name(scene, points) in self.measured.rows:
            return
        self.need(f"step/{scene}/points:{points}/")
        steps = max(FEWEST_STEPS, round(self.measured.point_steps / points))
        case = measure.timed_case(self.programs, scene, points, steps)
        frame = self.heave()["implicit"]["steps_per_frame"]
        print(f"quicksand run {scene} with {points} points", flush=True)
        for _ in range(self.repetitions):
            for threads in (1, 2):
                report, _ = measure.whole_run(self.programs, case, threads)
                least = {c: self.measured.median(step_name(scene, points), c) for c in ("least_bytes", "least_flops")}
                self.measured.add(run_name(scene, points, threads), measure.run_figures(report, frame) | least)

    def speed(self, title, scene, points, asked, asked_gain):
        """Line 1 for one scene: point-steps per second of the whole program on one core, and the gain of two."""
        self.whole_runs(scene, points)
        one, two = run_name(scene, points), run_name(scene, points, 2)
        rate = self.measured.median(one, "point_steps_per_s")
        in_cpu_time = 1e9 / self.measured.median(step_name(scene, points), "cpu_ns_per_point_step")
        yield Verdict(1, f"{title}, {points} points, one core", f"≥ {millions(asked)}",
                      f"{millions(rate)} ({self.measured.part_of_limit(one):.1%} of the limit; "
                      f"steps alone, by CPU time {millions(in_cpu_time)})", rate >= asked)
        if asked_gain:
            gain = self.measured.ratio(two, one, "point_steps_per_s")
            yield Verdict(1, f"{title}, {points} points, two cores over one", f"≥ {asked_gain} ×", f"{gain:.2f} ×",
                          gain >= asked_gain)

    def line1(self):
        for points in self.sizes.plane:
            yield from self.speed("two-phase 2D with output", "bed2", points, 12e6, 1.8)
        yield from self.speed("two-phase 3D with output", "bed3", self.sizes.space, 4e6, 1.8)
        for points in self.sizes.plane:
            yield from self.speed("dry 2D with output", "column2", points, 20e6, None)
        yield from self.speed("dry 3D with output", "column3", self.sizes.space, 6e6, None)

    def line2(self):
        for title, scene in (("two-phase", "bed2"), ("dry", "column2")):
            turns = self.measured.in_turns([f"step/{scene}/points:{points}/" for points in self.sizes.flat],
                                           max(self.repetitions, self.sizes.turns))
            names = [step_name(scene, points) for points in self.sizes.flat]
            times = [turns.median(name, "ns_per_point_step") for name in names]
            beside = [turns.ratio(name, names[0], "ns_per_point_step") for name in names]
            spread = max(beside) / min(beside)
            yield Verdict(2, f"{title} 2D, ns per point-step at {' '.join(f'{p:.0e}' for p in self.sizes.flat)} points",
                          "largest/smallest ≤ 1.25", f"{' '.join(f'{t:.0f}' for t in times)}: {spread:.2f} turn by turn",
                          spread <= 1.25)
        for scene in ("bed2", "dam2"):
            counts = []
            for cells in self.sizes.cells:
                self.need(f"pressure/{scene}/cells:{cells}/", repetitions=1)  # their number never varies
                counts.append(self.measured.median(f"pressure/{scene}/cells:{cells}", "pressure_iterations"))
            spread = max(counts) / min(counts)
            yield Verdict(2, f"pressure of {scene}, iterations at {' '.join(f'{c}²' for c in self.sizes.cells)} cells",
                          "largest/smallest ≤ 1.5", f"{' '.join(f'{c:.1f}' for c in counts)}: {spread:.2f}",
                          spread <= 1.5)

    def line3(self):
        for title, scene, asked in (("two-phase", "bed2", 400), ("dry", "column2", 250)):
            points = self.sizes.memory
            self.need(f"step/{scene}/points:{points}/")
            size = self.measured.median(step_name(scene, points), "bytes_per_point")
            yield Verdict(3, f"{title} 2D, resident bytes per point, {points} points", f"≤ {asked}", f"{size:.0f}",
                          size <= asked)

    def line4(self):
        for scene in ("bed2", "column2", "dam2"):
            group = f"room/{scene}/"
            self.need(group, max(self.repetitions, self.sizes.pairs))
            small, large = (next(n for n in self.measured.rows if n.startswith(group) and n.endswith(f"room:{r}"))
                            for r in (1, 10))
            more = self.measured.ratio(large, small, "ns_per_point_step") - 1
            memory = self.measured.ratio(large, small, "bytes_per_point") - 1
            yield Verdict(4, f"{scene}, 100 times the domain, more time per step", "< 5 %",
                          f"{more:.1%} (memory {memory:.1%} more)", more < 0.05)

    def line5(self):
        for title, scene in (("dry", "column2"), ("water only", "dam2")):
            group = f"program/{scene}/"
            self.need(group, max(self.repetitions, self.sizes.pairs))
            run, steps = (next(n for n in self.measured.rows if n.startswith(group) and n.endswith(way))
                          for way in ("/run", "/steps"))
            time = self.measured.ratio(run, steps, "ns_per_point_step") - 1
            memory = self.measured.ratio(run, steps, "peak_bytes_per_point") - 1
            good = self.measured.median(steps, "good_bytes_per_point")
            reduced = self.measured.context["reduced_steps"] == "yes"
            against = "its own instantiation" if reduced else "the bare steps of State<D>, as there is no reduced one"
            yield Verdict(5, f"{title} scene through the program, against {against}",
                          "≤ 3 % slower, the same memory",
                          f"{time:+.1%}, memory {memory:+.1%} (both with a state to go back to, {good:.0f} bytes per point)",
                          reduced and time <= 0.03 and abs(memory) <= 0.01)

    def line6(self):
        both = self.heave()
        gain = both["explicit"]["seconds"] / both["implicit"]["seconds"]

        def side(scheme):
            found = both[scheme]
            errors = ", ".join(f"{name} {value:.1e}" for name, value in found["errors"].items())
            way = "" if found["part"] == 1 else f", from {100 * found['part']:g} %"
            return f"{scheme} {found['seconds']:.0f} s{way} ({errors})"
        yield Verdict(6, "heave, standard, Kw = 2.2 GPa, explicit over implicit wall time", "≥ 15 ×",
                      f"{gain:.1f} ×: {side('implicit')}; {side('explicit')}", gain >= 15)

    def lines(self, chosen):
        for k in chosen:
            for verdict in getattr(self, f"line{k}")():
                print(verdict.text(), flush=True)
                yield verdict
