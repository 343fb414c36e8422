#!/usr/bin/python3
"""Pictures of a run: the points of a result file at several times, with walls and gates.

    cases/plot.py RESULT.vtkhdf --out FILE.png
    cases/plot.py RESULT.vtkhdf --out FILE.png --times 0,2.5,3 --field head --soil porosity
    cases/plot.py RESULT.vtkhdf --out FILE.png --series probe.below,body.sand.rise

Works on a finished result and on the `.part` of a running or killed one. Debian packages: python3-h5py,
python3-matplotlib.
"""
import argparse
import json
import math
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap, Normalize  # noqa: E402
from matplotlib.patches import Circle, Polygon, Rectangle  # noqa: E402

WALL, FIXED, OPEN_GATE, CLOSED_GATE = "#3b3b3b", "#a39d95", "#2e9e5b", "#c0392b"
WATER_MAP = LinearSegmentedColormap.from_list("water", ["#dcecf7", "#8fc1e3", "#3b83bd", "#0f3f78"])
SOIL_MAP = LinearSegmentedColormap.from_list("soil", ["#8a6b3d", "#d9a441", "#f2d16b", "#e4572e", "#8e1b3a"])
COMPONENTS = {3: ["x", "y", "z"], 4: ["xx", "yy", "zz", "xy"], 6: ["xx", "yy", "zz", "xy", "yz", "zx"]}
# unit in the file → unit in the picture, factor
SHOWN_UNIT = {"Pa": ("kPa", 1e-3)}


class Quantity:
    """A field or one component of it ("displacement.y"; vectors without a component: their length)."""

    def __init__(self, file, text):
        self.name, _, component = text.partition(".")
        arrays = file["VTKHDF/PointData"]
        if self.name not in arrays:
            sys.exit(f"no field {self.name!r}; there are {', '.join(sorted(arrays))}")
        data = arrays[self.name]
        width = data.shape[1] if data.ndim == 2 else 1
        if component and component not in COMPONENTS.get(width, []):
            sys.exit(f"{self.name} has no component {component!r}; it has {COMPONENTS.get(width, ['one value'])}")
        if width > 3 and not component:
            sys.exit(f"{self.name} needs a component, e.g. {self.name}.yy")
        self.column = COMPONENTS[width].index(component) if component else None
        unit = text_of(data.attrs.get("unit", ""))
        if self.name == "displacement":
            self.unit, self.factor = "mm", 1e3
            self.smallest_span = 0.1  # mm
        else:
            self.smallest_span = 0.0
            self.unit, self.factor = SHOWN_UNIT.get(unit, (unit, 1.0))
        self.label = text.replace("_", " ").replace(".", " ") + (f" ({self.unit})" if self.unit not in ("", "-", "–") else "")

    def of(self, frame):
        values = frame[self.name][()] * self.factor
        if values.ndim == 1:
            return values
        return values[:, self.column] if self.column is not None else np.linalg.norm(values, axis=1)


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def limits(values, smallest_span):
    """Colour range that a few outliers do not spoil, nor the last digits of what is at rest."""
    values = np.concatenate(values)
    values = values[np.isfinite(values)]
    if not len(values):
        return Normalize(0, 1)
    low, high = np.percentile(values, [0.5, 99.5])
    spare = max(smallest_span, 1e-9 * abs(high), 1e-30) - (high - low)
    if spare > 0:
        low, high = low - spare / 2, high + spare / 2
    return Normalize(low, high)


def choose_frames(file, times, count):
    names = sorted(file["frames"])
    if not names:
        sys.exit("the file holds no frame yet")
    at = np.array([file["frames"][name].attrs["time"] for name in names])
    if times:
        picked = [int(np.argmin(abs(at - t))) for t in times]
    else:
        picked = sorted(set(np.linspace(0, len(names) - 1, min(count, len(names))).round().astype(int)))
    return [file["frames"][names[k]] for k in picked]


def region_patches(region, **style):
    if "box" in region:
        low, high = region["box"]["min"], region["box"]["max"]
        return [Rectangle(low[:2], high[0] - low[0], high[1] - low[1], **style)]
    if "polygon" in region:
        return [Polygon(region["polygon"], closed=True, **style)]
    if "disc" in region:
        return [Circle(region["disc"]["center"][:2], region["disc"]["radius"], **style)]
    parts = region.get("union") or region.get("difference", [])[:1]
    return [patch for part in parts for patch in region_patches(part, **style)]


def draw_segment(axes, line, **style):
    (x0, y0), (x1, y1) = line["from"][:2], line["to"][:2]
    axes.plot([x0, x1], [y0, y1], solid_capstyle="butt", **style)


def draw_house(axes, case, stage):
    """The domain's sides, walls, gates (by the state they have in the stage) and reservoirs."""
    low, high = case["domain"]["min"], case["domain"]["max"]
    corners = {"left": [(0, 1), (0, 3)], "right": [(2, 1), (2, 3)], "bottom": [(0, 1), (2, 1)], "top": [(0, 3), (2, 3)]}
    box = (low[0], low[1], high[0], high[1])
    for side, ((xa, ya), (xb, yb)) in corners.items():
        kind = case["domain"].get("sides", {}).get(side, {}).get("kind", "slip")
        style = {"open": dict(color="#b9b9b9", lw=0.8, ls=":"), "reservoir": dict(color="#3b83bd", lw=1.4)}.get(
            kind, dict(color=WALL, lw=1.4))
        axes.plot([box[xa], box[xb]], [box[ya], box[yb]], clip_on=False, zorder=5, **style)
    for wall in case.get("walls", []):
        for patch in region_patches(wall["block"], color=WALL, lw=0, zorder=4) if "block" in wall else []:
            axes.add_patch(patch)
        if "line" in wall:
            draw_segment(axes, wall["line"], color=WALL, lw=2, zorder=5)
    opened = next((s.get("open_gates", []) for s in case.get("stages", []) if s["name"] == stage), [])
    for gate in case.get("gates", []):
        style = dict(color=OPEN_GATE, ls=(0, (1, 1.2))) if gate["name"] in opened else dict(color=CLOSED_GATE)
        draw_segment(axes, gate["line"], lw=2.4, zorder=6, **style)
    for reservoir in case.get("reservoirs", []):
        draw_segment(axes, reservoir["line"], color="#3b83bd", lw=2, zorder=5)
    margin = 0.02 * max(box[2] - box[0], box[3] - box[1])
    axes.set(xlim=(box[0] - margin, box[2] + margin), ylim=(box[1] - margin, box[3] + margin))


def draw_points(axes, frame, case, spacing, water, soil, norms):
    """Water as tiles below, grains as dots above; one point takes the room it stands for."""
    position, phase, body = frame["position"][()], frame["phase"][()], frame["body"][()]
    box = axes.get_window_extent()
    points_per_metre = box.width / np.diff(axes.get_xlim())[0] * 72 / axes.figure.dpi
    width = max(0.6, spacing * points_per_metre)
    fixed = np.isin(body, [k for k, b in enumerate(case.get("bodies", [])) if b.get("fixed")])
    order = np.argsort(position[:, 2], kind="stable")  # in space: seen along z, the nearest last

    def scatter(which, size, marker, zorder, **colour):
        chosen = order[which[order]]
        values = colour.pop("values", None)
        if values is not None:
            colour["c"] = values[chosen]
        axes.scatter(position[chosen, 0], position[chosen, 1], s=size**2, marker=marker, lw=0, zorder=zorder, **colour)

    if (phase == 1).any():
        scatter(phase == 1, 1.05 * width, "s", 1, values=water.of(frame), cmap=WATER_MAP, norm=norms["water"])
    grains = phase == 0
    scatter(grains & fixed, 0.95 * width, "o", 2, color=FIXED)
    if (grains & ~fixed).any():
        scatter(grains & ~fixed, 0.95 * width, "o", 3, values=soil.of(frame), cmap=SOIL_MAP, norm=norms["soil"])


def point_spacing(case):
    numerics = case.get("numerics", {})
    cell = case["domain"]["cell_size"] * numerics.get("cell_size_factor", 1)
    return cell / numerics.get("points_per_cell", 2)


def panel_grid(count, case):
    """Rows and columns that bring the picture near 16:10 with few panels left empty."""
    low, high = case["domain"]["min"], case["domain"]["max"]
    aspect = (high[0] - low[0]) / (high[1] - low[1])

    def rows(columns):
        return math.ceil(count / columns)

    def cost(columns):
        spare = rows(columns) * columns - count
        return abs(math.log(columns * aspect / rows(columns) / 1.6)) + spare / count

    columns = min(range(1, count + 1), key=cost)
    return rows(columns), columns, aspect


def draw_series(axes, file, name):
    group = file["series"].get(name)
    if group is None:
        sys.exit(f"no series {name!r}; there are {', '.join(sorted(file['series']))}")
    axes.plot(group["time"][()], group["value"][()], color="#0f3f78", lw=1.2)
    axes.set_title(f"{name} ({text_of(group['value'].attrs.get('unit', ''))})", fontsize=8)
    axes.set_xlabel("t (s)", fontsize=8)
    axes.tick_params(labelsize=7)
    axes.grid(alpha=0.3)


def picture(file, frames, case, water, soil, series, title):
    rows, columns, aspect = panel_grid(len(frames), case)
    width = 13.0
    panel = (width - 1.6) / columns  # the colour bars take the rest
    height = rows * (panel / aspect + 0.3) + 0.6 + (2.2 if series else 0)
    figure = plt.figure(figsize=(width, height), dpi=130, layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=[height - 2.2, 2.2]) if series else (figure, None)
    axes = top.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flatten()
    for spare in axes[len(frames):]:
        spare.set_visible(False)
    moving = [k for k, b in enumerate(case.get("bodies", [])) if b["kind"] != "water" and not b.get("fixed")]
    norms = {"water": limits([water.of(f)[f["phase"][()] == 1] for f in frames], water.smallest_span),
             "soil": limits([soil.of(f)[(f["phase"][()] == 0) & np.isin(f["body"][()], moving)] for f in frames],
                            soil.smallest_span)}
    for panel_axes, frame in zip(axes, frames):
        stage = text_of(frame.attrs.get("stage", ""))
        draw_house(panel_axes, case, stage)
        panel_axes.set_aspect("equal")
        panel_axes.set_title(f"t = {frame.attrs['time']:.3g} s" + (f" · {stage}" if stage else ""), fontsize=9)
        panel_axes.tick_params(labelsize=7)
        for spine in panel_axes.spines.values():
            spine.set_visible(False)
    phases = np.unique(np.concatenate([f["phase"][()] for f in frames]))
    for phase, quantity, kind, colours in ((1, water, "water", WATER_MAP), (0, soil, "soil", SOIL_MAP)):
        if phase in phases and not (phase == 0 and not moving):
            bar = top.colorbar(plt.cm.ScalarMappable(norms[kind], colours), ax=list(axes), shrink=0.8, aspect=35, pad=0.01)
            bar.set_label(f"{kind}: {quantity.label}", fontsize=8)
            bar.ax.tick_params(labelsize=7)
    for k, name in enumerate(series):
        draw_series(bottom.add_subplot(1, len(series), k + 1), file, name)
    top.suptitle(title, fontsize=11)
    figure.canvas.draw()  # the panels' sizes are known now
    for panel_axes, frame in zip(axes, frames):
        draw_points(panel_axes, frame, case, point_spacing(case), water, soil, norms)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("result", help="result.vtkhdf, or its .part")
    parser.add_argument("--out", required=True, help="picture to write (.png, .svg, .pdf)")
    parser.add_argument("--times", type=lambda t: [float(x) for x in t.split(",")],
                        help="seconds, comma separated; the nearest frames are shown (default: evenly spread)")
    parser.add_argument("--panels", type=int, default=6, help="number of panels without --times (6)")
    parser.add_argument("--field", default="pore_pressure", help="colour of water: field or field.component")
    parser.add_argument("--soil", default="displacement.y", help="colour of moving soil: field or field.component")
    parser.add_argument("--series", type=lambda t: t.split(","), default=[], help="histories to plot below")
    arguments = parser.parse_args()

    with h5py.File(arguments.result, "r") as file:
        case = json.loads(file["run/case_resolved"][()])
        frames = choose_frames(file, arguments.times, arguments.panels)
        kinds = {body["kind"] for body in case.get("bodies", [])}
        # A phase that is not there needs no field.
        water = Quantity(file, arguments.field if kinds - {"soil"} else arguments.soil)
        soil = Quantity(file, arguments.soil if kinds - {"water"} else arguments.field)
        title = f"{case.get('name', '')} ({case.get('numerics', {}).get('preset', '')})"
        picture(file, frames, case, water, soil, arguments.series, title).savefig(arguments.out)
    print(arguments.out)


if __name__ == "__main__":
    main()
