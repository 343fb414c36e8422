"""Runs the benchmarks and whole runs, and keeps what they measured."""
import collections
import json
import pathlib
import statistics
import subprocess
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]


def build(folder):
    subprocess.run(["cmake", "-S", TOP, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DBUILD_TESTING=ON"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", folder, "--target", "bench", "quicksand"], check=True)


class Measured:
    """Counters of benchmarks by name, one value per repetition; repetitions of one call are pairs."""

    def __init__(self, programs, repetitions, point_steps):
        self.programs, self.repetitions, self.point_steps = programs, repetitions, point_steps
        self.rows = collections.OrderedDict()
        self.context = {}

    def run(self, pattern, repetitions=None):
        """Runs the benchmarks whose names begin with the pattern in a process of their own, in turns."""
        print(f"bench {pattern}", flush=True)
        done = subprocess.run([self.programs / "bench", f"--point-steps={self.point_steps}",
                               f"--benchmark_filter=^{pattern}", "--benchmark_format=json",
                               f"--benchmark_repetitions={repetitions or self.repetitions}",
                               "--benchmark_enable_random_interleaving=true"],
                              check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        result = json.loads(done.stdout)
        self.context = result["context"]
        fresh = collections.defaultdict(lambda: collections.defaultdict(list))
        for one in sorted((b for b in result["benchmarks"] if b["run_type"] == "iteration"),
                          key=lambda b: b["repetition_index"]):
            if one.get("error_occurred"):
                raise RuntimeError(f"{one['name']}: {one['error_message']}")
            for counter, value in one.items():
                if isinstance(value, float):
                    fresh[self.plain(one["run_name"])][counter].append(value)
        for name in sorted(fresh):
            self.rows[name] = fresh[name]

    def in_turns(self, patterns, turns):
        """The benchmarks of every pattern once in each turn, as another Measured: what is compared is then measured
        side by side, whatever the machine's speed does between turns. Rows that are not known yet are taken over."""
        side_by_side = Measured(self.programs, turns, self.point_steps)
        for _ in range(turns):
            for pattern in patterns:
                one = Measured(self.programs, 1, self.point_steps)
                one.run(pattern)
                for name, row in one.rows.items():
                    side_by_side.add(name, {counter: value for counter, [value] in row.items()})
        self.rows = side_by_side.rows | self.rows
        return side_by_side

    def add(self, name, figures):
        """One more repetition of something that is measured elsewhere."""
        row = self.rows.setdefault(name, collections.defaultdict(list))
        for counter, value in figures.items():
            row[counter].append(value)

    @staticmethod
    def plain(name):
        """A benchmark's name without what Google Benchmark adds."""
        return "/".join(part for part in name.split("/") if not part.startswith(("iterations:", "repeats:"))
                        and part not in ("real_time", "manual_time"))

    def median(self, name, counter):
        return statistics.median(self.rows[name][counter])

    def ratio(self, name, other, counter):
        """Median over pairs of one benchmark's counter over another's."""
        pairs = zip(self.rows[name][counter], self.rows[other][counter], strict=True)
        return statistics.median(a / b for a, b in pairs)

    def machine(self, kind, threads):
        """Bytes or operations per second: the best repetition, as STREAM counts."""
        counter = {"triad": "bytes_per_s", "fma": "flops_per_s"}[kind]
        return max(self.rows[f"machine/{kind}/threads:{threads}"][counter])

    def limit(self, name):
        """Point-steps per second (iterations per second of the pressure) that memory or arithmetic would allow."""
        threads = 2 if name.endswith("threads:2") else 1
        bounds = [self.machine("triad", threads) / self.median(name, "least_bytes")]
        if "least_flops" in self.rows[name]:
            bounds.append(self.machine("fma", threads) / self.median(name, "least_flops"))
        return min(bounds)

    def part_of_limit(self, name):
        """None where no least work is counted."""
        if "least_bytes" not in self.rows[name]:
            return None
        if "s_per_iteration" in self.rows[name]:
            took = self.median(name, "s_per_iteration")
            return 1 / (took * self.limit(name)) if took > 0 else None
        return self.median(name, "point_steps_per_s") / self.limit(name)


def whole_run(programs, case, threads=1):
    """run.json of a case (a dict) through the executable, and its result file's folder (kept while held)."""
    folder = tempfile.TemporaryDirectory(prefix="quicksand-bench-")
    path = pathlib.Path(folder.name)
    (path / "case.json").write_text(json.dumps(case))
    done = subprocess.run([programs / "quicksand", "run", path / "case.json", "--out", path / "out", "--threads",
                           str(threads)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise RuntimeError(f"{case['name']}: {done.stderr[-500:]}")
    return json.loads((path / "out" / "run.json").read_text()), folder


def output_seconds(report):
    return sum(phase["seconds"] for phase in report["phases"] if phase["name"] == "output")


def timed_case(programs, scene, points, steps):
    """A benchmark scene as a case of so many steps, with a frame and ten samples at their end."""
    case = json.loads(subprocess.run([programs / "bench", f"--print-case={scene}:{points}"], check=True,
                                     capture_output=True, text=True).stdout)
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        file.write(json.dumps(case))
        file.flush()
        plan = json.loads(subprocess.run([programs / "quicksand", "check", file.name], check=True,
                                         capture_output=True, text=True).stdout)
    duration = steps * plan["time_step"]
    case["stages"][0]["duration"] = duration
    case["output"].update(frame_interval=duration, series_interval=duration / 10)
    return case


def run_figures(report, steps_per_frame):
    """Counters of a whole run that writes a frame every so many steps, with some five samples between two. "rest" is
    what a step takes outside its phases: the ledger, watches, the choice of the next step."""
    steps, points = report["steps"], report["point_steps"] / report["steps"]
    per_step = {phase["name"]: phase["seconds"] / steps for phase in report["phases"] if phase["name"] != "output"}
    per_step["rest"] = (report["wall_seconds"] - output_seconds(report)) / steps - sum(per_step.values())
    per_step["output"] = output_seconds(report) / report["frames"] / steps_per_frame
    whole = sum(per_step.values())
    return {"points": points, "point_steps_per_s": points / whole, "ns_per_point_step": 1e9 * whole / points,
            "pressure_iterations": report["pressure_iterations_mean"],
            **{f"s_per_step {name}": seconds for name, seconds in per_step.items()}}
