#!/usr/bin/python3
"""Draws map.png from map.csv: each pair of the main ranges, a mark for each scene by how it ended."""

import csv
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import ranges  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
MAIN = ("permeability", "bulk_modulus", "young_modulus", "porosity", "gravity", "cell_size", "viscosity")
LOOK = {"ok": ("#9bd19b", 2), "told": ("#cfcf55", 4), "refused": ("#4477cc", 6), "diagnosed": ("#eebb22", 6), "open": ("#dd8855", 2),
        "wrong": ("#cc0000", 14)}


def main():
    rows = list(csv.DictReader((HERE / "map.csv").open()))
    size = len(MAIN) - 1
    figure, axes = plt.subplots(size, size, figsize=(18, 18))
    for i in range(size):
        for j in range(size):
            a, b, panel = MAIN[j], MAIN[i + 1], axes[i][j]
            if j > i:
                panel.axis("off")
                continue
            for end, (color, mark) in LOOK.items():
                at = [(float(r[a]), float(r[b])) for r in rows if r["end"] == end and r[a] and r[b]]
                panel.scatter([x for x, _ in at], [y for _, y in at], s=mark, c=color, label=end, linewidths=0)
            for name, scale in ((a, panel.set_xscale), (b, panel.set_yscale)):
                if ranges.RANGES[name][2]:
                    scale("log")
            panel.set_xlabel(a), panel.set_ylabel(b)
    axes[0][0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(HERE / "map.png", dpi=60)


main()
