"""What was measured as CSV and as Markdown."""
import csv

from acceptance import step_name

BEGIN, END = "<!-- bench: written by tests/bench/run -->", "<!-- end of bench -->"
KINDS = (("two-phase, 2D", "bed2"), ("dry, 2D", "column2"), ("water only, 2D", "dam2"), ("two-phase, 3D", "bed3"),
         ("dry, 3D", "column3"), ("water only, 3D", "dam3"))


def write_csv(measured, verdicts, file):
    """One row per benchmark, medians of its counters; then one row per line of acceptance."""
    counters = sorted({c for row in measured.rows.values() for c in row})
    with file.open("w", newline="") as stream:
        out = csv.writer(stream)
        out.writerow(["benchmark", "part of limit"] + counters)
        for name, row in measured.rows.items():
            part = measured.part_of_limit(name)
            out.writerow([name, "" if part is None else f"{part:.4g}"] +
                         [f"{measured.median(name, c):.6g}" if c in row else "" for c in counters])
        out.writerow([])
        out.writerow(["line", "what", "asked", "measured", "met"])
        for v in verdicts:
            out.writerow([v.line, v.what, v.asked, v.measured, "yes" if v.met else "no"])


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def machine_text(measured):
    rows = [[{"triad": "STREAM triad", "fma": "fused multiply-add"}[kind]] +
            [f"{measured.machine(kind, t) / 1e9:.1f} {unit}" for t in (1, 2)]
            for kind, unit in (("triad", "GB/s"), ("fma", "GF/s"))]
    return table(["machine", "one core", "two"], rows)


def speed_text(measured, group):
    """Steps alone (group "step/") or whole runs ("run/"): speed, and the parts that the time goes to."""
    names = [n for n in measured.rows if n.startswith(group)]
    if not names:
        return ""
    phases = [c.removeprefix("s_per_step ") for c in measured.rows[names[0]] if c.startswith("s_per_step ")]
    rows = []
    for name in names:
        _, scene, points, threads = name.split("/")
        m = lambda counter: measured.median(name, counter)  # noqa: E731
        seconds = [m(f"s_per_step {p}") for p in phases]
        cpu = f"{m('cpu_ns_per_point_step'):.0f}" if "cpu_ns_per_point_step" in measured.rows[name] else "–"
        rows.append([scene, f"{m('points'):.0f}", threads.split(":")[1], f"{m('point_steps_per_s') / 1e6:.3g}",
                     f"{m('ns_per_point_step'):.0f}", cpu, f"{measured.part_of_limit(name):.1%}",
                     f"{m('pressure_iterations'):.1f}", *(f"{s / sum(seconds):.1%}" for s in seconds)])
    return table([{"step/": "steps", "run/": "whole runs"}[group], "points", "threads", "M point-steps/s",
                  "ns per point-step", "CPU ns", "of the limit", "pressure iterations", *phases], rows)


def kinds_text(measured, points_by_dimension):
    """What each kind of scene allocates, bytes per point."""
    parts, rows = [], []
    for title, scene in KINDS:
        name = step_name(scene, points_by_dimension[int(scene[-1])])
        if name not in measured.rows:
            continue
        of = {c[6:]: measured.median(name, c) / measured.median(name, "points") for c in measured.rows[name]
              if c.startswith("bytes ")}
        parts = parts or sorted(of)
        all_bytes = measured.median(name, "bytes_per_point")
        rest = all_bytes - sum(of.values())
        rows.append([title] + [f"{of[p]:.0f}" if of[p] else "–" for p in parts] +
                    [f"{rest:.0f}", f"{all_bytes:.0f}", f"{measured.median(name, 'ns_per_point_step'):.0f}"])
    return table(["bytes per point", *parts, "all else", "resident", "ns per point-step"], rows) if rows else ""


def pressure_text(measured):
    rows = []
    for name in (n for n in measured.rows if n.startswith("pressure/")):
        _, scene, cells = name.split("/")
        n = cells.split(":")[1]
        m = lambda counter: measured.median(name, counter)  # noqa: E731
        part = measured.part_of_limit(name)
        rows.append([scene, f"{n}²", f"{m('unknowns'):.0f}", f"{m('pressure_iterations'):.1f}",
                     f"{1e9 * m('s_per_iteration') / m('unknowns'):.1f}", "" if part is None else f"{part:.0%}"])
    rows.sort(key=lambda r: (r[0], int(r[1][:-1])))
    return table(["scene", "cells", "unknowns", "iterations", "ns per unknown and iteration", "of the limit"],
                 rows) if rows else ""


def verdicts_text(verdicts):
    return table(["line", "what", "asked", "measured", ""],
                 [[str(v.line), v.what, v.asked, v.measured, "met" if v.met else "**not met**"] for v in verdicts])


def all_text(measured, verdicts, points_by_dimension, how):
    parts = [how + "\n", machine_text(measured), verdicts_text(verdicts), speed_text(measured, "run/"),
             speed_text(measured, "step/"), kinds_text(measured, points_by_dimension),
             pressure_text(measured)]
    return "\n".join(p for p in parts if p)


def put_between_marks(file, text):
    old = file.read_text()
    head, rest = old.split(BEGIN, 1)
    _, tail = rest.split(END, 1)
    file.write_text(head + BEGIN + "\n\n" + text + "\n" + END + tail)
